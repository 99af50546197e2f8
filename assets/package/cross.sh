#!/usr/bin/env bash
# Builds the program for other systems, from Debian or Ubuntu on x86-64, into target/cross.
#   assets/package/cross.sh windows    a zip for Windows
#   assets/package/cross.sh arm        an archive for 64-bit ARM Linux, without the window
#   assets/package/cross.sh macos      a bundle for macOS: all but the program, which is type-checked only, because
#                                      linking needs Apple's libraries
#   assets/package/cross.sh web        check.js: the program for browsers in a script, for the companion
#   assets/package/cross.sh check      type-checks Windows and macOS; build-windows and build-arm make the programs alone
# On a Mac, `macos` builds the program, too. Where rustup cannot add a target, its standard library is built from
# Debian's sources. The archives need cargo-about.
set -euo pipefail
cd "$(dirname "$0")/../.."
self=$PWD/assets/package/cross.sh

target=${CARGO_TARGET_DIR:-target}/cross
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
windows=x86_64-pc-windows-gnu
arm=aarch64-unknown-linux-gnu
mac=aarch64-apple-darwin
web=wasm32-wasip1
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc

need() { # need PROGRAM PACKAGE...
    command -v "$1" > /dev/null && return
    echo "$1 is missing: apt-get install -y ${*:2}" >&2
    exit 1
}

# cargo_for TARGET COMMAND ARGUMENTS...
cargo_for() {
    if rustup target add "$1" > /dev/null 2>&1; then
        cargo "$2" --locked --target "$1" --target-dir "$target" "${@:3}"
    else
        need /usr/bin/cargo rustc-web cargo-web rust-web-src
        PATH=/usr/bin:$PATH RUSTC_BOOTSTRAP=1 cargo "$2" --locked --target "$1" --target-dir "$target" \
            -Zbuild-std=std,panic_unwind "${@:3}"
    fi
}

# texts FOLDER TARGET ARGUMENTS...: what every archive has
texts() {
    mkdir -p "$1"
    "$self" web
    cargo run --release --locked -p companion -- --out "$target/companion"
    cp -r "$target/companion" README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE "$1"
    cargo about generate --locked --offline --fail --target "$2" "${@:3}" --config assets/package/about.toml \
        --output-file "$1/LICENSES-OF-LIBRARIES.txt" assets/package/about.hbs
}

for what in "${@:-check}"; do
    case $what in
    check)
        need x86_64-w64-mingw32-windres binutils-mingw-w64-x86-64
        cargo_for "$windows" check
        cargo_for "$mac" check
        ;;
    build-windows)
        need x86_64-w64-mingw32-gcc mingw-w64
        cargo_for "$windows" build --release
        ;;
    build-arm)
        need aarch64-linux-gnu-gcc gcc-aarch64-linux-gnu libc6-dev-arm64-cross
        cargo_for "$arm" build --release --no-default-features
        ;;
    windows)
        need zip zip
        "$self" build-windows
        name=weekender-v$version-$windows
        rm -rf "${target:?}/$name" "$target/$name.zip"
        texts "$target/$name" "$windows"
        cp "$target/$windows/release/weekender.exe" "$target/$name"
        (cd "$target" && zip -qrX "$name.zip" "$name")
        ;;
    arm)
        "$self" build-arm
        name=weekender-v$version-$arm-headless
        rm -rf "${target:?}/$name"
        texts "$target/$name" "$arm" --no-default-features
        cp "$target/$arm/release/weekender" "$target/$name"
        tar --sort=name --owner=0 --group=0 --numeric-owner -C "$target" -czf "$target/$name.tar.gz" "$name"
        ;;
    web)
        # Flags for this processor would replace these, and the linker cannot optimise what is built incrementally.
        unset RUSTFLAGS
        export CARGO_INCREMENTAL=0
        export CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS='-C target-feature=+simd128'
        build=(build --locked --target $web --target-dir "$target" --profile web --no-default-features --bin weekender)
        if rustup target add $web > /dev/null 2>&1; then
            cargo "${build[@]}"
        else
            need wasm-ld lld
            need /usr/bin/cargo rustc-web cargo-web rust-web-src wasi-libc
            mkdir -p "$target"
            # The functions that Debian's C library lacks.
            PATH=/usr/bin:$PATH rustc --target $web --edition 2024 --crate-type rlib --emit obj -C panic=abort \
                -o "$target/wasi.o" assets/package/wasi.rs
            libc=/usr/lib/wasm32-wasi
            CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS+=" -C linker=wasm-ld -C linker-flavor=wasm-ld -C link-self-contained=no"
            CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS+=" -C link-arg=$libc/crt1-command.o -C link-arg=$(realpath "$target")/wasi.o -L $libc"
            PATH=/usr/bin:$PATH RUSTC_BOOTSTRAP=1 cargo "${build[@]}" -Zbuild-std=std,panic_abort
        fi
        {
            echo 'globalThis.weekenderProgram = { host:'
            cat assets/web/program.js
            printf ', module: "'
            gzip -9nc "$target/$web/web/weekender.wasm" | base64 | tr -d '\n'
            echo '" };'
        } > "$target/check.js.$$"
        mv "$target/check.js.$$" "$target/check.js"
        ls -l "$target/check.js"
        ;;
    macos)
        bundle=$target/Weekender.app/Contents
        rm -rf "$target/Weekender.app"
        texts "$bundle/Resources" "$mac"
        mkdir -p "$bundle/MacOS"
        cp assets/package/icons/weekender.icns "$bundle/Resources"
        sed "s/VERSION/$version/" assets/package/Info.plist > "$bundle/Info.plist"
        if [ "$(uname)" = Darwin ]; then
            cargo_for "$mac" build --release
            cp "$target/$mac/release/weekender" "$bundle/MacOS"
        else
            cargo_for "$mac" check
            echo "$bundle/MacOS lacks the program: on a Mac, run this again" >&2
        fi
        ;;
    *)
        echo "$what is not known: windows, arm, web, macos or check" >&2
        exit 2
        ;;
    esac
done
