#!/usr/bin/env bash
# Measures the GPU backend on this machine and prints tables for docs/benchmarks.md.
# On a software adapter the sizes are small and the figures good for comparisons only.
# Usage: benches/gpu.sh [adapter]
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

header() {
    printf '\n%s\n\n' "$1"
    echo "| scene, width, height, samples, depth, runs | median ms | M paths/s | M rays/s | least ms | dispatches | ms in dispatches |"
    echo "|---|---|---|---|---|---|---|"
}
trace() { "$bench" trace "$@" "${adapter[@]}" 2> /dev/null; }

header "Scenes, tracing alone"
# shellcheck disable=SC2086
{
    trace three-spheres $three $three_spp 24 $runs
    trace book $book $book_spp 50 $runs
    trace field:100000 $field $field_spp 24 $runs

    header "General kernel, to compare with the specialised above"
    trace three-spheres $three $three_spp 24 $runs general
    trace book $book $book_spp 50 $runs general

    header "Samples of a dispatch"
    for samples in 1 2 4 8 16 64 200; do
        [ "$samples" -le "$three_spp" ] && trace three-spheres $three $three_spp 24 $runs samples=$samples
    done

    header "Time that a dispatch aims for"
    for target in 2 8 50 200; do
        trace three-spheres $three $three_spp 24 $runs target_ms=$target
    done
}

printf '\nOperations of the kernel\n\n| scene | general | specialised | what is in it |\n|---|---|---|---|\n'
"$bench" size touching-spheres metals three-spheres close-up book
