#!/usr/bin/env bash
# The ARM program under qemu, compared with the program of this machine, which needs fused multiply-add (AVX2).
#   tests/cross/arm.sh aarch64/weekender target/release/weekender [STRESS CASES...]
# Needs Debian's qemu-user and libc6-arm64-cross.
set -uo pipefail
arm=(qemu-aarch64 -L /usr/aarch64-linux-gnu "$(realpath "$1")")
host=$(realpath "$2")
stress=("${@:3}")
[ ${#stress[@]} -gt 0 ] || stress=(copies)
scenes=$(cd "$(dirname "$0")/../../assets/scenes" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_RUNTIME_DIR=$work
cd "$work" || exit 1

passed=0 failed=0
report() { # report NAME OUTCOME
    if [ "$2" = 0 ]; then
        passed=$((passed + 1))
        echo "ok     $1"
    else
        failed=$((failed + 1))
        echo "FAILED $1"
        tail -n 12 out | sed 's/^/         /'
    fi
}
case_of() { # case_of NAME COMMAND...
    "${@:2}" > out 2>&1 < /dev/null
    report "$1" $?
}

case_of version "${arm[@]}" --version --verbose
grep instructions out
for picture in three-spheres book field:3000 metals close-up touching-spheres \
    "$scenes/hollow-glass.toml" "$scenes/stress/planet-coast.toml"; do
    film=(--batch --device cpu --scene "$picture" --size 160x90 --samples 16)
    name=$(basename "${picture/:/-}" .toml)
    case_of "renders $name here" "$host" "${film[@]}" --out host.exr
    for lanes in 1 4 8; do
        case_of "renders $name, $lanes lanes" "${arm[@]}" "${film[@]}" --simd "$lanes" --out arm.exr
        "$host" compare host.exr arm.exr > out 2>&1
        grep -q 'equal to the bit' out
        report "same bits: $name, $lanes lanes" $?
    done
done
film=(--batch --device cpu --isa portable --size 160x90 --samples 16)
case_of 'renders without fused multiply-add here' "$host" "${film[@]}" --out host.exr
case_of 'renders without fused multiply-add' "${arm[@]}" "${film[@]}" --out arm.exr
"$host" compare host.exr arm.exr > out 2>&1
grep -q 'equal to the bit' out
report 'same bits' $?
for filter in "${stress[@]}"; do
    case_of "stress $filter" "${arm[@]}" stress --filter "$filter"
    grep 'cases right' out
done
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
