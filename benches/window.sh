#!/usr/bin/env bash
# Measures how long the window's frames take, and how long it takes from a change until its picture is drawn, while
# 1280x720 pixels are traced: nine seconds of watching, then a drag that orbits. Needs Xvfb and xdotool, and accepts the
# flags of the window:
#
#     benches/window.sh [--device gpu] [--draw-with gl]
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --quiet

work=$(mktemp -d)
display=:$((90 + RANDOM % 400))
Xvfb "$display" -noreset -screen 0 1280x800x24 > /dev/null 2>&1 &
server=$!
trap 'kill $server 2> /dev/null; rm -rf "$work"' EXIT
export DISPLAY=$display XDG_DATA_HOME=$work XDG_STATE_HOME=$work XDG_CACHE_HOME=$work
sleep 1

log=$work/frames.csv
"${CARGO_TARGET_DIR:-target}/release/weekender" --stage hollow-glass --size 1280x720 --noise-target 1e-6 \
    --frame-log "$log" "$@" &
window=$!
sleep 9
xdotool windowfocus "$(xdotool search --pid $window | tail -1)" mousemove 640 400 mousedown 1
for step in $(seq 60); do
    xdotool mousemove_relative -- $((step / 15 % 2 * 8 - 4)) 1
    sleep 0.07
done
xdotool mouseup 1
sleep 1
xdotool key ctrl+q
wait $window

# Prints the median and the 95th percentile of a column of numbers.
spread() {
    sort -n | awk -v name="$1" '{ v[NR] = $1 } END {
        if (NR) printf "%-42s %6.1f %6.1f ms (%d)\n", name, v[int(0.5 * NR) + 1], v[int(0.95 * NR) + 1], NR }'
}
# The drag lasts from the first change until the picture of the last one.
drag=$(awk -F, '$1 == "latency" { if (!n++) begin = $2 - $3; end = $2 } END { print begin, end }' "$log")
frames() { awk -F, -v from="$1" -v to="$2" -v column="$3" '$1 == "frame" && $2 > from && $2 < to { print $column }' "$log"; }
# shellcheck disable=SC2086
{
    echo "                                           median    95 %"
    frames 3000 ${drag% *} 4 | spread "work of a frame, watching"
    frames $drag 4 | spread "work of a frame, dragging"
    frames $drag 3 | spread "from frame to frame, dragging"
    awk -F, '$1 == "latency" { print $3 }' "$log" | spread "from a change to its picture"
}
