#!/usr/bin/env bash
# The Windows program under Wine, compared with the Linux program of the same commit.
#   tests/cross/wine.sh weekender.exe target/release/weekender
# With UNIT_TESTS=PROGRAM, that program is run, too: the library's tests for Windows.
# Needs Debian's wine64, mingw-w64, libcap2-bin, xvfb, openbox and xdotool. Root can also fill a disk.
set -uo pipefail
exe=$(realpath "$1")
host=$(realpath "$2")
here=$(cd "$(dirname "$0")" && pwd)
scenes=$here/../../assets/scenes

work=$(mktemp -d)
mkdir -p "$work/run" "$work/full"
export HOME=$work WINEPREFIX=$work/prefix WINEDEBUG=-all XDG_RUNTIME_DIR=$work
started=()
finish() {
    wineserver -k 2> /dev/null
    [ ${#started[@]} -eq 0 ] || kill "${started[@]}" 2> /dev/null
    mountpoint -q "$work/full" && umount "$work/full"
    chmod -R u+w "$work" && rm -rf "$work"
}
trap finish EXIT

Xvfb -displayfd 3 -screen 0 1400x1000x24 3> "$work/display" 2> /dev/null &
started+=($!)
until [ -s "$work/display" ]; do sleep 0.1; done
DISPLAY=:$(cat "$work/display")
export DISPLAY
openbox 2> /dev/null &
started+=($!)
wineboot -i > /dev/null 2>&1
# Wine 8 lacks a library that Rust's random numbers come from.
if [ ! -e "$WINEPREFIX/drive_c/windows/system32/bcryptprimitives.dll" ]; then
    cat > "$work/prng.c" << 'EOF'
#include <windows.h>
#include <ntsecapi.h>
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T size) { return RtlGenRandom(data, (ULONG)size); }
EOF
    x86_64-w64-mingw32-gcc -shared -O -o "$WINEPREFIX/drive_c/windows/system32/bcryptprimitives.dll" "$work/prng.c" -ladvapi32
fi
x86_64-w64-mingw32-gcc -municode -O -o "$work/helper.exe" "$here/helper.c"
cp "$exe" "$work/weekender.exe"

. "$here/report.sh"
[ -z "${UNIT_TESTS:-}" ] || unit_tests wine "$UNIT_TESTS"
cd "$work/run" || exit 1
# The server opens the files. It starts anew with the rights of the programs that follow.
wineserver -k

# Root may write everywhere, unless it gives up that right.
windows() {
    timeout 400 capsh --drop=cap_dac_override,cap_dac_read_search,cap_fowner -- -c 'exec wine "$@"' wine "$@" \
        < /dev/null > "$work/out" 2>&1
}
# case_of NAME CODE TEXT ARGUMENTS...: the program ends with this code and says this
case_of() {
    local name=$1 code=$2 text=$3 got
    shift 3
    windows "$work/weekender.exe" "$@"
    got=$?
    [ "$got" = "$code" ] && grep -qF -- "$text" "$work/out"
    report "$name (exit code $got)" $?
}
exists() { # exists NAME FILE
    [ -s "$2" ]
    report "$1" $?
}
small=(--size 32x18 --device cpu)
tiny=("${small[@]}" --samples 4)
endless=(--size 160x90 --samples 4294967296 --device cpu --progress on)

case_of 'version' 0 x86_64-pc-windows-gnu --version
for picture in three-spheres book field:3000 metals close-up touching-spheres \
    "$scenes/hollow-glass.toml" "$scenes/stress/planet-coast.toml"; do
    name=$(basename "${picture/:/-}" .toml)
    film=(--batch --device cpu --scene "$picture" --size 160x90 --samples 16)
    "$host" "${film[@]}" --out "linux-$name.exr" > "$work/out" 2>&1
    case_of "renders $name" 0 "$name.exr" "${film[@]}" --out "$name.exr"
    same_bits "same bits as Linux: $name" "linux-$name.exr" "$name.exr"
done
for isa in portable sse4.2 avx2; do
    film=(--batch --device cpu --isa "$isa" --size 160x90 --samples 16)
    "$host" "${film[@]}" --out "linux-$isa.exr" > "$work/out" 2>&1
    case_of "renders with $isa" 0 "$isa.exr" "${film[@]}" --out "$isa.exr"
    same_bits "same bits as Linux: $isa" "linux-$isa.exr" "$isa.exr"
done

case_of 'compares' 0 'equal to the bit' compare book.exr linux-book.exr
case_of 'compares what differs' 1 different compare book.exr metals.exr
case_of 'a picture' 0 metal.png --batch --stage metal --device cpu --size 160x90 --samples 64 --out metal.png
case_of 'checks a picture' 0 '' check metal.png --stage metal
case_of 'info' 0 metals info metals.exr
case_of 'a wildcard' 0 metals info 'met*.exr'
# Wine's Direct3D has no compiler, and sometimes breaks when the program ends.
windows "$work/weekender.exe" --batch --device gpu --size 32x18 --samples 4 --out gpu.exr
grep -qF 'dxcompiler.dll' "$work/out"
report 'a GPU that cannot compile' $?
exists 'the CPU continues' gpu.exr
WGPU_BACKEND=noop case_of 'stress' 0 '' stress --filter copies
part=(--batch --device cpu --scene metals --size 64x36)
case_of 'renders a part' 0 part-0.exr "${part[@]}" --sample-range 0..32 --checkpoint part-0.exr --continue
"$host" "${part[@]}" --sample-range 32..64 --checkpoint part-1.exr --continue > "$work/out" 2>&1
case_of "merges with Linux's part" 0 '' merge part-0.exr part-1.exr --samples 64 --out merged.exr
"$host" --batch --device cpu --scene metals --size 64x36 --samples 64 --out whole.exr > "$work/out" 2>&1
same_bits 'the merged film is the whole' merged.exr whole.exr

mkdir 'Köln und Umgebung' "$WINEPREFIX/drive_c/films"
case_of 'umlauts and spaces' 0 'ein Bild.exr' --batch "${tiny[@]}" --out 'Köln und Umgebung/ein Bild.exr'
exists 'that file' 'Köln und Umgebung/ein Bild.exr'
case_of 'a command that is recorded' 0 'ein Bild.exr"' info 'Köln und Umgebung/ein Bild.exr'
command=$(sed -n 's/^command *weekender//p' "$work/out" | tr -d '\r')
printf '@..\\weekender.exe%s\r\n' "$command" > again.bat
windows cmd /c again.bat
exists 'it can be run by cmd' 'ein Bild.exr'
case_of 'a drive' 0 'C:\films\a.exr' --batch "${tiny[@]}" --out 'C:\films\a.exr'
case_of 'both kinds of slashes' 0 '8 per pixel, 4 of them new' --batch "${small[@]}" --samples 8 --resume 'C:\films/a.exr' --out 'C:/films\b.exr'
exists 'that file' "$WINEPREFIX/drive_c/films/b.exr"
mkdir -p "$WINEPREFIX/dosdevices/unc/server/share"
case_of 'a UNC name' 0 '\\server\share\a.exr' --batch "${tiny[@]}" --out '\\server\share\a.exr'
exists 'that file' "$WINEPREFIX/dosdevices/unc/server/share/a.exr"
deep=$(printf 'a-folder-of-a-path-too-long-for-the-old-limit/%.0s' 1 2 3 4 5 6 7)
mkdir -p "$deep"
case_of 'a long path' 0 'a.exr' --batch "${tiny[@]}" --out "${deep}a.exr"
case_of 'a long path again' 0 'a.exr' --batch "${small[@]}" --samples 8 --checkpoint "${deep}a.exr" --continue
exists 'that file' "${deep}a.exr"
for name in aux.png NUL.exr 'C:\films\com1.exr'; do
    case_of "a device's name: $name" 2 'choose another name' --batch "${tiny[@]}" --out "$name"
done
case_of 'a name for a stream' 2 'choose another' --batch "${tiny[@]}" --out 'a.exr:b.exr'
case_of 'a folder that is not there' 2 'create its directory' --batch "${tiny[@]}" --out 'C:\missing\a.exr'

"$host" --scene metals --save-scene lf.toml > "$work/out" 2>&1
sed 's/$/\r/' lf.toml > crlf.toml
case_of 'a scene with CR LF' 0 '' --batch "${tiny[@]}" --scene crlf.toml --out crlf.exr
case_of 'the same with LF' 0 '' --batch "${tiny[@]}" --scene lf.toml --out lf.exr
same_bits 'same bits' crlf.exr lf.exr
printf '[camera]\r\nvfov_degrees = 20\r\nlook_form = [1, 2, 3]\r\n' > wrong.toml
case_of 'a mistake after CR LF is found' 2 'look_form' --batch "${tiny[@]}" --scene wrong.toml

mkdir locked
cp metals.exr locked/a.exr
chmod a-w locked
case_of 'a read-only folder' 2 'choose another place' --batch "${tiny[@]}" --out locked/b.exr
chmod u+w locked
cp metals.exr read-only.exr
chmod a-w read-only.exr
case_of 'a read-only file' 2 'marked read-only' --batch "${tiny[@]}" --out read-only.exr
cp lf.exr held.exr
windows "$work/helper.exe" hold held.exr "$work/weekender.exe" --batch "${tiny[@]}" --out held.exr
[ $? = 2 ] && grep -q 'another program has it open; close it there' "$work/out"
report 'a file that another program has opened' $?
windows "$work/helper.exe" hold held.exr "$work/weekender.exe" info held.exr
report 'it can be read' $?
if mount -t tmpfs -o size=100k tmpfs "$work/full" 2> /dev/null; then
    ln -s "$work/full" "$WINEPREFIX/dosdevices/f:"
    case_of 'a full disk' 1 'free some space' --batch --device cpu --size 640x360 --samples 4 --out 'f:\a.exr'
    rescued=$(grep -o '[A-Z]:\\[^ ]*weekender-[^ ]*\.exr' "$work/out" | head -n 1)
    case_of 'its samples are rescued' 0 '4 per pixel' info "${rescued:-none}"
fi

windows "$work/weekender.exe" --batch "${endless[@]}" --out run.exr &
sleep 4
case_of 'a second run of the same film' 2 'is locked' --batch "${tiny[@]}" --out run.exr
wineserver -k
wait %% 2> /dev/null
case_of 'after it was killed' 0 '' --batch "${tiny[@]}" --out run.exr
[ -z "$(find . -maxdepth 1 -name '.weekender-*')" ]
report 'nothing is left behind' $?

# ends EVENT NUMBER CODE: the program saves its film and ends with this code
ends() {
    windows "$work/helper.exe" event "$2" 4000 "$work/weekender.exe" --batch "${endless[@]}" --out "event-$2.exr"
    [ $? = "$3" ]
    report "$1 ends with $3" $?
    case_of 'and saves the film' 0 'samples' info "event-$2.exr"
}
ends 'Ctrl-C' 0 130
ends 'Ctrl-Break' 1 130
ends 'closing the console' 2 129
ends 'logging off' 5 143
ends 'shutting down' 6 143

windows "$work/weekender.exe" &
title() { xdotool getwindowname "$(xdotool search --name ' – Weekender' 2> /dev/null | tail -n 1)" 2> /dev/null; }
for _ in $(seq 60); do
    [ -z "$(title)" ] || break
    sleep 1
done
sleep 8
first=$(title)
[ -n "$first" ]
report "the window opens: $first" $?
xdotool key Page_Up
sleep 4
[ "$(title)" != "$first" ]
report "its stages can be turned: $(title)" $?
xdotool key alt+F4
wait %%
report 'it closes' $?
kept=$(echo "$WINEPREFIX"/drive_c/users/*/AppData/Local/weekender/edits.json)
exists 'its edits are kept' "$kept"
rm -f "$kept"
windows "$work/helper.exe" event 2 15000 "$work/weekender.exe"
[ $? = 129 ]
report 'it closes with its console' $?
exists 'its edits are kept' "$kept"

summary
