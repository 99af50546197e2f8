#!/usr/bin/env bash
# Uses the window for a long time as a restless person would, and prints its memory every minute: random keys and drags,
# stages, own scenes, saved and opened files. Fails if the window ends, or leaves a report of a crash. Needs Xvfb, openbox
# and xdotool, and accepts the flags of the window:
#
#     MINUTES=120 benches/hours.sh [--device cpu]
set -euo pipefail
cd "$(dirname "$0")/.."
program=${PROGRAM:-}
if [[ -z $program ]]; then
    cargo build --release --quiet
    program=${CARGO_TARGET_DIR:-target}/release/weekender
fi

work=$(mktemp -d)
display=:$((90 + RANDOM % 400))
Xvfb "$display" -noreset -screen 0 1280x800x24 > /dev/null 2>&1 &
server=$!
export DISPLAY=$display HOME=$work XDG_DATA_HOME=$work XDG_STATE_HOME=$work XDG_CACHE_HOME=$work
sleep 1
openbox > /dev/null 2>&1 &
trap 'kill $server 2> /dev/null; rm -rf "$work"' EXIT
# Whatever opens a browser or a folder does nothing.
mkdir "$work/bin"
ln -s /bin/true "$work/bin/xdg-open"
PATH=$work/bin:$PATH "$program" --size 640x360 "$@" 2> "$work/messages" &
window=$!
sleep 5
xdotool windowfocus "$(xdotool search --onlyvisible --pid $window | tail -1)"

keys=(space r g h c j x v k n p t i l Tab f 1 2 3 4 5 6 7 8 9 0 plus minus Home period comma bracketleft bracketright
    Page_Up Page_Down Page_Down Page_Down Insert Delete ctrl+d ctrl+c ctrl+v ctrl+z ctrl+z ctrl+shift+z ctrl+n ctrl+b
    shift+p shift+c shift+n shift+r ctrl+1 ctrl+2 ctrl+3 ctrl+4 ctrl+5 F5 F6 F11 F1 Escape Escape Escape Return
    Up Down Left Right w a s d q e)
# Some kept pictures. What has the focus may be the button that keeps more.
for _ in 1 2 3; do xdotool key m; sleep 2; done

any() { echo $((RANDOM % $1)); }

# Opens a dialog with these keys and enters a path.
enter() {
    xdotool key --delay 40 Escape Escape "$1"
    sleep 0.5
    xdotool key ctrl+a type --delay 4 "$2"
    xdotool key Return
    sleep 0.5
    xdotool key Return
}

end=$((SECONDS + 60 * ${MINUTES:-120}))
next=$SECONDS
count=0
begin=$SECONDS
while ((SECONDS < end)); do
    case $(any 40) in
        0) enter ctrl+s "$work/$(any 6).png" ;;
        1) enter ctrl+e "$work/$(any 6).exr" ;;
        2) enter ctrl+o "$work/$(any 6).exr" ;;
        3) enter ctrl+o "$work/$(any 6).png" ;;
        [4-9])
            xdotool mousemove $((300 + $(any 600))) $((150 + $(any 400))) mousedown $((1 + 2 * $(any 2)))
            for _ in 1 2 3 4 5; do xdotool mousemove_relative -- $(($(any 60) - 30)) $(($(any 60) - 30)); done
            xdotool mouseup 1 mouseup 3
            ;;
        1[0-3]) xdotool mousemove $(any 1280) $((30 + $(any 770))) click $((1 + $(any 5))) ;;
        *) xdotool key "${keys[RANDOM % ${#keys[@]}]}" ;;
    esac
    count=$((count + 1))
    sleep 0.1
    if ! kill -0 $window 2> /dev/null; then
        echo "the window ended after $count events"
        cat "$work/messages"
        exit 1
    fi
    if ((SECONDS >= next)); then
        resident=$(awk '/^VmRSS/ { print int($2 / 1024) }' /proc/$window/status)
        echo "$(((SECONDS - begin) / 60)) min, $count events, $resident MiB"
        next=$((SECONDS + 60))
    fi
done
xdotool key --delay 200 Escape Escape Escape ctrl+q
for _ in $(seq 100); do
    kill -0 $window 2> /dev/null || break
    sleep 0.2
done
kill $window 2> /dev/null && echo "did not end by itself: a question may be open"
wait $window || true
cat "$work/messages"
reports=$(find "$work" -name '*crash*' -o -name '*panic*')
[[ -z $reports ]] || { cat $reports; exit 1; }
