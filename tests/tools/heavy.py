"""Files of up to 1 MB that take a reader's time or memory: each is read or refused within what is promised.

`python tests/tools/heavy.py` says what each takes: in a process of its own, for memory is counted by process.
"""

from __future__ import annotations

import argparse
import sys
import time
import zlib
from collections.abc import Callable
from pathlib import Path

from imagefiles import COLOUR, SIGNATURE, black_png, bmp, chunk, ihdr, png
from readers import MOST_MEMORY, MOST_SECONDS, READERS, SHAPES, peak_memory, reads

MB = 1_000_000
MOST_SECONDS_LARGE = 5.0  # of an image of more than 25 million cells
SIDE, LARGE_SIDE = 5_000, 10_000

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
