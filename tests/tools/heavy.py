"""Files of up to 1 MB that take a reader's time or memory: each is read or refused within what is promised.

`python tests/tools/heavy.py` says what each takes: in a process of its own, for memory is counted by process.
"""

from __future__ import annotations

import argparse
import struct
import sys
import time
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from imagefiles import (
    COLOUR,
    COLOUR_ALPHA,
    SIGNATURE,
    black_png,
    bmp,
    chunk,
    ihdr,
    png,
    repeated_scans,
    segment,
)
from mapfiles import encoded
from PIL import Image
from readers import MOST_MEMORY, MOST_SECONDS, READERS, SHAPES, peak_memory, reads

MB = 1_000_000
MOST_SECONDS_LARGE = 5.0  # of an image of more than 25 million cells
SIDE, LARGE_SIDE = 5_000, 10_000

SCAN = b"angle_min: 0\nangle_increment: 8.9e-5\n"
TABLE = b"image,scan,observer_x,observer_y,observer_yaw,observed_x,observed_y\n"
CLEAR = chunk(b"tRNS", bytes(6))  # black is transparent
PACKED = zlib.compress(bytes(900_000))  # 900 bytes


def _dot(before: bytes) -> bytes:
    return png(ihdr(1, 1), bytes(2), before)


def _in_many_parts() -> bytes:
    packed = zlib.compress(bytes(SIDE * (SIDE + 1)))
    parts = b"".join(chunk(b"IDAT", packed[k : k + 1]) for k in range(len(packed)))
    return SIGNATURE + ihdr(SIDE, SIDE) + parts + chunk(b"IEND")


def _short_rows(width: int, height: int) -> bytes:
    """A BMP of run lengths in which every row ends behind its first pixel."""
    return bmp(width, height, b"\1\0\0\0" * height, bits=8, compression=1)


def _colours(kind: str, **options: object) -> bytes:
    """The largest picture that is read, in blocks of colour."""
    blocks = np.random.default_rng(1).integers(0, 256, (125, 125, 3), np.uint8)
    return encoded(Image.fromarray(blocks).resize((4_000, 4_000), 0), kind, **options)


def _exif_of_many_tags() -> bytes:
    """A JPEG whose EXIF Pillow would unpack to 50 GB."""
    tags = b"".join(struct.pack("<HHII", k, 7, 800_000, 0) for k in range(65_000))
    exif = b"II*\0\x08\0\0\0" + struct.pack("<H", 65_000) + tags
    parts = (segment(0xE1, b"Exif\0\0" + exif[at : at + 65_000]) for at in range(0, len(exif), 65_000))
    jpeg = encoded(Image.new("RGB", (64, 64)), "JPEG")
    return jpeg[:2] + b"".join(parts) + jpeg[2:]


# name -> what makes it
HEAVY: dict[str, Callable[[], bytes]] = {
    **{name: (lambda data=data: data) for name, data in SHAPES.items()},
    "P1": lambda: b"P1\n990 990\n" + b"1" * 990**2,
    "P1, comments": lambda: b"P1\n570 570\n" + b"1#\n" * 570**2,
    "P2": lambda: b"P2\n700 700\n255\n" + b"7 " * 700**2,
    "P2, blanks": lambda: b"P2\n500 500\n255\n" + b"1 " * 249_999 + b" " * 499_000 + b"1",
    "P2, comments": lambda: b"P2\n570 570\n255\n" + b"1#\n" * 570**2,
    "P2, one long number": lambda: b"P2\n700 700\n255\n" + b"1" * (MB - 99),
    "P2, cut off": lambda: b"P2\n2000 2000\n255\n" + b"7 " * (MB // 2 - 9),
    "P3": lambda: b"P3\n400 400\n254\n" + b"7 " * (3 * 400**2),
    "P4": lambda: b"P4\n8000 990\n" + bytes(990_000),
    "P5, white is 99": lambda: b"P5\n990 990\n99\n" + bytes(990**2),
    "P6, white is 99": lambda: b"P6\n570 570\n99\n" + bytes(3 * 570**2),
    "PNG, a colour transparent": lambda: black_png(SIDE, COLOUR, before=CLEAR),
    "PNG, interlaced": lambda: black_png(SIDE, COLOUR, interlaced=True, before=CLEAR),
    "PNG, pixels in many parts": _in_many_parts,
    "PNG, many parts": lambda: _dot(chunk(b"tEXt") * (MB // 12 - 9)),
    "PNG, many unknown parts": lambda: _dot(chunk(b"aaAa") * (MB // 12 - 9)),
    "PNG, packed texts": lambda: _dot(chunk(b"zTXt", b"a\0\0" + PACKED) * 1000),
    "PNG, packed texts of the world": lambda: _dot(chunk(b"iTXt", b"a\0\1\0\0\0" + PACKED) * 1000),
    "PNG, packed colour profiles": lambda: _dot(chunk(b"iCCP", b"a\0\0" + PACKED) * 1000),
    "BMP, bits": lambda: bmp(2800, 2800, bytes(352 * 2800), bits=1),
    "BMP, colour": lambda: bmp(570, 570, bytes(1712 * 570)),
    "BMP, short rows": lambda: _short_rows(2_000, 2_000),
    "BMP, short rows, wide": lambda: _short_rows(65_000, 61),
    "BMP, short rows, large": lambda: _short_rows(LARGE_SIDE, LARGE_SIDE),
    "BMP, runs": lambda: bmp(2_000, 2_000, b"\xff\1" * (MB // 2 - 999), bits=8, compression=1),
    "BMP, runs of half bytes": lambda: bmp(
        2_000, 2_000, (b"\xff\x12" * 8 + b"\0\0") * 2_000, bits=4, compression=2
    ),
    "BMP, leaps": lambda: bmp(65_000, 61, b"\0\2\xff\xff" * 200_000, bits=8, compression=1),
    "PNG, the largest picture with alpha": lambda: black_png(4_000, COLOUR_ALPHA, 16, interlaced=True),
    "JPEG, the largest": lambda: _colours("JPEG", quality=20),
    "JPEG, many scans": lambda: repeated_scans(Image.new("RGB", (4_000, 4_000), "red"), 14),
    "JPEG, more scans": lambda: repeated_scans(Image.new("RGB", (4_000, 4_000), "red"), 9_000),
    "JPEG, EXIF of many tags": _exif_of_many_tags,
    "WebP, the largest": lambda: _colours("WEBP", quality=20, method=0),
    "WebP, the largest without loss": lambda: encoded(
        Image.new("RGB", (4_000, 4_000), "red"), "WEBP", lossless=True
    ),
    "PNG, packed colour profiles of a picture": lambda: png(
        ihdr(64, 64), bytes(64 * 65), chunk(b"iCCP", b"a\0\0" + PACKED) * 400
    ),
    "PNG, EXIF": lambda: _dot(chunk(b"eXIf", b"II*\0\x08\0\0\0\xff\xff" + bytes(900_000))),
    "scan": lambda: SCAN + b"ranges:\n" + b"- 1.2\n" * 70_000 + b"intensities:\n" + b"- 1.2\n" * 70_000,
    "scan, lists": lambda: b"ranges:\n" + b"- 1\n" * 100_000 + b"intensities:\n" + b"-\n" * 100_000,
    "scan, many keys": lambda: b"ranges:\n- 1\n" * 80_000,
    "scan, lists that do not end": lambda: b"ranges: [\n" * 99_000,
    "scan, one long number": lambda: SCAN + b"ranges: [" + b"1" * 900_000 + b"]",
    "documents": lambda: b"---\n" * 249_000,
    "documents of a letter": lambda: b"a\n---\n" * 160_000,
    "table, columns": lambda: b"image,scan" + b",a_column" * 20_000,
    "table, cells": lambda: TABLE + b",\n" * 90_000,
    "table, a cell": lambda: TABLE + b'"' + b'""' * 90_000,
    "YAML": lambda: b"- 1\n" * (MB // 4),
    "text": lambda: b"---\ntitle: x\n---\n" + b"{x} [a](b) *c* `d` $e$ " * 40_000,
}
LARGE: dict[str, Callable[[], bytes]] = {
    "large PNG, interlaced": lambda: black_png(LARGE_SIDE, COLOUR, interlaced=True, before=CLEAR),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--slower", type=float, default=1.0, help="times that a reading may take longer; default: %(default)s"
    )
    parser.add_argument("files", nargs="*", type=Path, help="what is read; default: the files known as heavy")
    args = parser.parse_args()
    files = {path.name: path.read_bytes for path in args.files} or {**HEAVY, **LARGE}
    failed = []
    for name, made in files.items():
        data = made()
        if len(data) > MB:
            raise ValueError(f"{name} has {len(data):,} bytes; the promise is about {MB:,}")
        most = args.slower * (MOST_SECONDS_LARGE if name in LARGE else MOST_SECONDS)
        slowest, read = 0.0, False
        for by, (reader, _) in READERS.items():
            if by == "image":  # which is the first half of "map"
                continue
            began = time.thread_time()
            try:
                read |= reads(reader, data, most, MOST_MEMORY)
            except AssertionError as error:
                failed.append(f"{name}, read as {by}: {error}")
            slowest = max(slowest, time.thread_time() - began)
        took = f"{slowest:6.2f} s {peak_memory():6,.0f} MB so far"
        print(f"{len(data):>9,} bytes {took}  {'read   ' if read else 'refused'}  {name}", flush=True)
    print("\n".join(failed) or f"each read or refused within its seconds and {MOST_MEMORY:,} MB")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
