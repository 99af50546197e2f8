#!/usr/bin/env bash
# Renders the icon with Weekender itself, and writes its sizes to icons/. Needs ImageMagick.
#   assets/package/icon.sh target/release/weekender
set -euo pipefail
program=$(realpath "${1:?the program to render with}")
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$program" --batch --scene icon.toml --device cpu --out "$work/picture.png"
# Rounded corners.
convert -size 512x512 xc:black -fill white -draw "roundrectangle 0,0 511,511 112,112" "$work/mask.png"
convert "$work/picture.png" "$work/mask.png" -alpha off -compose CopyOpacity -composite "$work/icon.png"
for side in 16 32 48 64 128 256 512; do
    convert "$work/icon.png" -filter Lanczos -resize "${side}x$side" -strip \
        -define png:exclude-chunks=date,time "icons/$side.png"
done
convert icons/{256,64,48,32,16}.png icons/weekender.ico
# For macOS, which needs Debian's icnsutils here.
png2icns icons/weekender.icns icons/{512,256,128,48,32,16}.png
