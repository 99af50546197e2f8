#!/bin/sh
# Measures what the companion shows, in one run on one machine; a graphics card is not needed. Takes about ten minutes.
# Close other programs first. Then set machine and date in measured.toml.
# Usage: docs/companion/measure.sh [PROGRAM]
set -e
program=${1:-target/release/weekender}
out=docs/companion/measured
report=$(mktemp -d)
"$program" bench --runs 3 --run-limit 1 --json $out/speed.json
"$program" report --out "$report" --backends cpu,scalar,c89 --seeds 4 --time-limit 4
cp "$report"/report.json $out/error.json
rm -r "$report"
cargo run --release --example mappings -- gpu samples=64 runs=5 > $out/mappings.json
cargo run --release --example mappings -- cpu samples=128 runs=9 > $out/refill.json
