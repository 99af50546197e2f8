#!/usr/bin/env bash
# Builds what is released, in target/package: an archive with program, companion, manual pages, completions,
# desktop entry, icons and licences, and a Debian package of the same files. Needs cargo-about and cargo-deb.
#   assets/package/release.sh                          the full program
#   assets/package/release.sh --no-default-features    without the window: the archive only
set -euo pipefail
cd "$(dirname "$0")/../.."

for tool in cargo-about cargo-deb; do
    if ! command -v "$tool" > /dev/null; then
        echo "$tool is missing: cargo install --locked cargo-deb; cargo install --locked cargo-about --features cli" >&2
        exit 1
    fi
done

features=("$@")
target=$(rustc -vV | sed -n 's/^host: //p')
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
name=weekender-v$version-$target
[ ${#features[@]} -eq 0 ] || name=$name-headless
package=target/package
root=$package/$name

rm -rf "$package/texts" "$package/companion" "$root"
mkdir -p "$root"

cargo build --release --locked "${features[@]}"
cargo run --release --locked "${features[@]}" --example package -- "$package/texts"
cargo about generate --locked --offline --fail --target "$target" "${features[@]}" \
    --config assets/package/about.toml --output-file "$package/texts/LICENSES-OF-LIBRARIES.txt" assets/package/about.hbs

assets/package/cross.sh web
cargo run --release --locked "${features[@]}" -p companion -- --out "$package/companion"
cp -r target/release/weekender "$package/companion" README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE "$root"
cp -r "$package/texts/." "$root"
if [ ${#features[@]} -eq 0 ]; then
    cp -r assets/package/icons assets/package/weekender.desktop assets/package/weekender.metainfo.xml "$root"
    cargo deb --no-build --locked --output "$package/weekender_${version}_$(dpkg --print-architecture).deb"
fi
# The same files give the same archive.
tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$(git log -1 --format=%ct 2> /dev/null || echo 0)" \
    -C "$package" -czf "$package/$name.tar.gz" "$name"
(cd "$package" && sha256sum ./*.tar.gz ./*.deb 2> /dev/null > SHA256SUMS || true)
ls -l "$package"
