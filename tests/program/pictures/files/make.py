"""Makes the pictures of this directory with other programs: OpenEXR 3.5.3, OpenImageIO 3.2.2, Pillow 13 (from PyPI) and
netpbm 11.1. Run it here, with a `weekender` in PATH: `python3 make.py`."""

import struct
import subprocess
import numpy as np
import OpenEXR
import OpenImageIO as oiio
from PIL import Image

W, H = 24, 16
x, y = np.meshgrid(np.arange(W), np.arange(H))
RGB = np.stack([x / 30 + 0.1, y / 20 + 0.07, (x * y % 7) / 9 + 0.03], axis=-1).astype(np.float32)
NAMES = ["R", "G", "B"]


def exr(name, parts, **header):
    made = []
    for part, channels in parts:
        own = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage, **header}
        if part:
            own["name"] = part
        made.append(OpenEXR.Part(own, channels, part or ""))
    OpenEXR.File(made).write(name)


def named(rgb, names):
    return {name: np.ascontiguousarray(rgb[..., i]) for i, name in enumerate(names)}


half = RGB.astype(np.float16)
exr("float.exr", [("", named(RGB, NAMES))])
exr("half.exr", [("", named(half, NAMES))])
exr("blender.exr", [("", named(RGB, ["ViewLayer.Combined." + n for n in "RGB"]) |
                     named(RGB, ["ViewLayer.Normal." + n for n in "XYZ"]))])
exr("dot.exr", [("", named(RGB, [".R", ".G", ".B"]))])
exr("lower.exr", [("", named(RGB, ["r", "g", "b"]))])
exr("grey.exr", [("", {"Y": np.ascontiguousarray(RGB[..., 0])})])
exr("parts.exr", [("albedo", named(RGB * 0.5, NAMES)), ("beauty", named(RGB, NAMES))])
exr("depth.exr", [("", {"Z": np.ascontiguousarray(RGB[..., 0])})])
exr("alpha.exr", [("", named(RGB, NAMES) | {"A": np.where(x < 4, 0.5, 1).astype(np.float32)})])
exr("aces.exr", [("", named(RGB, NAMES))],
    chromaticities=(0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767))
exr("dwa.exr", [("", named(half, NAMES))], compression=OpenEXR.DWAA_COMPRESSION)
exr("htj2k.exr", [("", named(half, NAMES))], compression=OpenEXR.HTJ2K256_COMPRESSION)

# Crop, overscan and shift: the display window is the picture.
def windowed(name, data, left, top, width=W, height=H):
    spec = oiio.ImageSpec(data.shape[1], data.shape[0], 3, "float")
    spec.x, spec.y = left, top
    spec.full_x, spec.full_y, spec.full_width, spec.full_height = 0, 0, width, height
    buf = oiio.ImageBuf(spec)
    buf.set_pixels(spec.roi, np.ascontiguousarray(data))
    buf.write(name)


windowed("crop.exr", RGB[4:12, 6:18], 6, 4)
windowed("overscan.exr", np.pad(RGB, ((2, 2), (3, 3), (0, 0)), constant_values=9), -3, -2)
windowed("shifted.exr", RGB, 8, 0)

# A header that was copied from a file of another compression: its number of chunks is that of ZIPS.
data = bytearray(open("half.exr", "rb").read())
name = b"chunkCount\0int\0"
if name in data:
    struct.pack_into("<i", data, data.index(name) + len(name) + 4, H)
else:
    # The attribute is put first, which moves the table of offsets and the chunks.
    attribute = name + struct.pack("<ii", 4, H)
    data[8:8] = attribute
    at = 8
    while data[at]:
        kind_end = data.index(0, data.index(0, at) + 1)
        at = kind_end + 5 + struct.unpack_from("<i", data, kind_end + 1)[0]
    struct.pack_into("<Q", data, at + 1, struct.unpack_from("<Q", data, at + 1)[0] + len(attribute))
open("stale.exr", "wb").write(data)

# A film, saved again by another program.
subprocess.run(["weekender", "--batch", "--device", "reference", "--progress", "off", "--size", "24x16", "--samples", "4",
                "--out", "film.exr"], check=True, stdout=subprocess.DEVNULL)
film = oiio.ImageBuf("film.exr")
film.write("film-same.exr")
oiio.ImageBufAlgo.channels(film, ("R", "G", "B")).write("film-rgb.exr")
small = oiio.ImageBufAlgo.channels(film, ("R", "G", "B"))
small.set_write_format("half")
small.specmod().attribute("compression", "zip")
small.write("film-half.exr")

# Integers: 16 and 8 bits as the book writes them.
deep = np.minimum(RGB * 65536, 65535).astype(np.uint16)
byte = (deep >> 8).astype(np.uint8)
Image.fromarray(byte).save("bytes.png")
Image.fromarray(np.dstack([byte, np.where(x < 3, 128, 255).astype(np.uint8)])).save("alpha.png")
for ending in ["bmp", "gif", "jpg", "tga", "tif"]:
    Image.fromarray(byte).save("bytes." + ending)
open("deep.ppm", "wb").write(b"P6\n%d %d\n65535\n" % (W, H) + deep.astype(">u2").tobytes())
for most in [15, 100, 254, 1023]:
    text = subprocess.run(["pamdepth", str(most), "deep.ppm"], check=True, capture_output=True).stdout
    text = subprocess.run(["pnmtoplainpnm"], input=text, check=True, capture_output=True).stdout
    open(f"p3-{most}.ppm", "wb").write(text)
plain = subprocess.run(["pnmtoplainpnm", "deep.ppm"], check=True, capture_output=True).stdout
open("p3-65535.ppm", "wb").write(plain)
pfm = subprocess.run(["pamtopfm", "-endian=little", "-scale=1.0", "deep.ppm"], check=True, capture_output=True).stdout
open("netpbm.pfm", "wb").write(pfm)
big = subprocess.run(["pamtopfm", "-endian=big", "-scale=1.0", "deep.ppm"], check=True, capture_output=True).stdout
open("netpbm-big.pfm", "wb").write(big)
twice = subprocess.run(["pamtopfm", "-endian=little", "-scale=2.0", "deep.ppm"], check=True, capture_output=True).stdout
open("netpbm-scale-2.pfm", "wb").write(twice)
