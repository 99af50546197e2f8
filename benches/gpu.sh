#!/usr/bin/env bash
# Measures the GPU backend on this machine and prints tables for docs/benchmarks.md.
# On a software adapter, pictures are small and the figures only serve for comparisons.
# Usage: benches/gpu.sh [adapter]
# The environment variables RUNS, FIELD (number of spheres in the large field) and SIZE ("WIDTH HEIGHT" of all
# pictures) override the defaults.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release --quiet --example gpu_bench
bench=${CARGO_TARGET_DIR:-target}/release/examples/gpu_bench
adapter=(${1:+"adapter=$1"})

echo "date: $(date -u +%Y-%m-%d)"
echo "adapter: $("$bench" adapter "${adapter[@]}" 2> /dev/null)"
if "$bench" adapter "${adapter[@]}" 2> /dev/null | grep -q software; then
    three="200 112" book="200 112" field="200 112" three_spp=16 book_spp=4 field_spp=2 runs=3
else
    three="800 450" book="1200 675" field="1200 675" three_spp=200 book_spp=500 field_spp=100 runs=30
fi

runs=${RUNS:-$runs} three=${SIZE:-$three} book=${SIZE:-$book} field_size=${SIZE:-$field} field=field:${FIELD:-100000}

header() {
    printf '\n%s\n\n' "$1"
    echo "| scene, width, height, samples, depth, runs | median ms | Mpaths/s | Mrays/s | min ms | dispatches | ms in dispatches |"
    echo "|---|---|---|---|---|---|---|"
}
trace() { "$bench" trace "$@" "${adapter[@]}" 2> /dev/null; }

header "Scenes (tracing only)"
# shellcheck disable=SC2086
{
    trace three-spheres $three $three_spp 24 $runs
    trace book $book $book_spp 50 $runs
    trace $field $field_size $field_spp 24 $runs

    header "The general kernel, for comparison with the specialised ones above"
    trace three-spheres $three $three_spp 24 $runs general
    trace book $book $book_spp 50 $runs general

    header "Samples per dispatch"
    for samples in 1 2 4 8 16 64 200; do
        [ "$samples" -le "$three_spp" ] && trace three-spheres $three $three_spp 24 $runs samples=$samples
    done

    header "Target time of a dispatch"
    for target in 2 8 50 200; do
        trace three-spheres $three $three_spp 24 $runs target_ms=$target
    done
}

printf '\nSize and build time of the hierarchy, on one core\n\n'
echo "| scene | bytes per sphere | build ms |"
echo "|---|---|---|"
"$bench" hierarchy book "$field"

printf '\nSize of the kernel in operations\n\n| scene | general | specialised | features |\n|---|---|---|---|\n'
"$bench" size touching-spheres metals three-spheres close-up book

printf '\nPasses, with films that are read at once and films that stay on the device\n\n'
echo "| scene, width, height, samples, depth, passes | ms per pass, read at once | ms per pass, film stays | reads, read at once | reads, film stays | ms to add one film, host |"
echo "|---|---|---|---|---|---|"
# shellcheck disable=SC2086
"$bench" passes three-spheres $three 2 24 32 "${adapter[@]}" 2> /dev/null

printf '\nTime from a change to its first picture\n\n| scene, width, height, depth | ms | of which ms to prepare |\n|---|---|---|\n'
# shellcheck disable=SC2086
for scene in three-spheres book; do "$bench" first $scene $three 24 "${adapter[@]}" 2> /dev/null; done

printf '\nOperations per iteration of the path loop\n\n| scene | float | integer | special | total |\n|---|---|---|---|---|\n'
"$bench" work touching-spheres metals three-spheres close-up
