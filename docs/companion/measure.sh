#!/bin/sh
# Measures what the companion shows, in one run on one machine, and notes the date in measured.toml. A graphics
# card is not needed, but a processor with AVX-512 is, because sentences quote rows of that level. Takes less than
# ten minutes on two cores; close other programs first. TRY=1 tries it in a minute, with numbers that mean nothing.
# Usage: cargo build --release --bins --example mappings && docs/companion/measure.sh
set -eu
program=${1:-target/release/weekender}
mappings=$(dirname "$program")/examples/mappings
texts=docs/companion
out=$texts/measured
report=$(mktemp -d)
trap 'rm -r "$report"' EXIT
bench="--runs 3 --run-limit 1" errors="--seeds 4 --time-limit 4" gpu="samples=64 runs=5" cpu="samples=128 runs=9"
if [ -n "${TRY:-}" ]; then
    bench="--runs 1 --run-limit .05" errors="--seeds 2 --time-limit .2 --reference-samples 64"
    gpu="samples=64 runs=1" cpu="samples=64 runs=1"
fi
# The options are words of their own.
# shellcheck disable=SC2086
{
    "$program" bench $bench --json "$report"/speed.json
    "$program" report --out "$report" --backends cpu,scalar,c89 $errors
    "$mappings" gpu $gpu > "$report"/mappings.json
    "$mappings" cpu $cpu > "$report"/refill.json
}
for name in speed mappings refill; do mv "$report/$name.json" "$out"; done
mv "$report"/report.json $out/error.json
sed -i "s/^date = .*/date = \"$(date +%F)\"/" $texts/measured.toml
# A new run has its own system and compiler.
sed -i -e "s/^system = .*/system = \"$(uname -srm)\"/" \
    -e "s/^compiler = .*/compiler = \"$(cc --version | head -n 1), -std=c89 -O2\"/" $texts/measured.toml
