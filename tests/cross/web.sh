#!/usr/bin/env bash
# The program for browsers with the page's own host in node, compared with the program of this machine.
#   tests/cross/web.sh target/cross/check.js target/release/weekender
set -uo pipefail
script=$(realpath "$1")
host=$(realpath "$2")
here=$(cd "$(dirname "$0")" && pwd)
scenes=$here/../../assets/scenes
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_RUNTIME_DIR=$work

. "$here/report.sh"
web() {
    node "$here/program.mjs" "$script" "$@"
}
same_text() { # same_text NAME FILE FILE
    diff "$2" "$3" > "$work/out" 2>&1
    report "$1" $?
}

cd "$work" || exit 1
case_of version web --version
cp "$scenes/hollow-glass.toml" "$scenes/stress/planet-coast.toml" .
for picture in three-spheres book field:3000 metals close-up touching-spheres hollow-glass.toml planet-coast.toml; do
    film=(--batch --device cpu --scene "$picture" --size 160x90 --samples 16 --progress off)
    name=${picture/:/-}
    case_of "renders $name here" "$host" "${film[@]}" --isa sse4.2 --out host.exr
    for lanes in 1 4; do
        case_of "renders $name, $lanes lanes" web "${film[@]}" --simd "$lanes" --out web.exr
        same_bits "same bits: $name, $lanes lanes" host.exr web.exr
    done
done
web info web.exr > answer 2>&1
case_of 'info' grep -q '16 per pixel' answer
web compare host.exr web.exr > answer 2>&1
case_of 'compare' grep -q 'equal to the bit' answer
for picture in "$here"/../program/check/cases/*.*; do
    name=$(basename "$picture")
    cp "$picture" .
    "$host" check --progress off "$name" > host.out 2>&1
    codes=$?
    web check --progress off "$name" > web.out 2>&1
    codes+=" $?"
    # The figures differ by rounding.
    for who in host web; do grep -v '^seen' $who.out > $who.txt; done
    same_text "verdict on $name" host.txt web.txt
    case_of "exit codes $codes" test "${codes% *}" = "${codes#* }"
done
summary
