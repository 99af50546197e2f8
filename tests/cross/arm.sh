#!/usr/bin/env bash
# The ARM program under qemu, compared with the program of this machine, which needs fused multiply-add (AVX2).
#   tests/cross/arm.sh aarch64/weekender target/release/weekender [STRESS CASES...]
# With UNIT_TESTS=PROGRAM, that program is run, too: the library's tests for ARM.
# Needs Debian's qemu-user and libc6-arm64-cross.
set -uo pipefail
arm=$(realpath "$1")
host=$(realpath "$2")
stress=("${@:3}")
[ ${#stress[@]} -gt 0 ] || stress=(copies)
here=$(cd "$(dirname "$0")" && pwd)
scenes=$here/../../assets/scenes
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_RUNTIME_DIR=$work

. "$here/report.sh"
emulated() {
    qemu-aarch64 -L /usr/aarch64-linux-gnu "$@"
}

[ -z "${UNIT_TESTS:-}" ] || unit_tests emulated "$UNIT_TESTS"
cd "$work" || exit 1
case_of version emulated "$arm" --version
for picture in three-spheres book field:3000 metals close-up touching-spheres \
    "$scenes/hollow-glass.toml" "$scenes/stress/planet-coast.toml"; do
    film=(--batch --device cpu --scene "$picture" --size 160x90 --samples 16)
    name=$(basename "${picture/:/-}" .toml)
    case_of "renders $name here" "$host" "${film[@]}" --out host.exr
    for lanes in 1 4 8; do
        case_of "renders $name, $lanes lanes" emulated "$arm" "${film[@]}" --simd "$lanes" --out arm.exr
        same_bits "same bits: $name, $lanes lanes" host.exr arm.exr
    done
done
film=(--batch --device cpu --isa portable --size 160x90 --samples 16)
case_of 'renders without fused multiply-add here' "$host" "${film[@]}" --out host.exr
case_of 'renders without fused multiply-add' emulated "$arm" "${film[@]}" --out arm.exr
same_bits 'same bits' host.exr arm.exr
for filter in "${stress[@]}"; do
    case_of "stress $filter" emulated "$arm" stress --filter "$filter"
    grep 'cases right' out
done
summary
