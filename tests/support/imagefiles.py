"""PNG, BMP and JPEG files put together by hand: what Pillow does not write, or never that large or bad."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator

import numpy as np
from PIL import Image

SIGNATURE = b"\x89PNG\r\n\x1a\n"
GREY, COLOUR, PALETTE, GREY_ALPHA, COLOUR_ALPHA = 0, 2, 3, 4, 6  # what a PNG calls its kinds of pixels
CHANNELS = {GREY: 1, COLOUR: 3, PALETTE: 1, GREY_ALPHA: 2, COLOUR_ALPHA: 4}
# Of each of Adam7's passes: first column and row, and the step from one to the next.
PASSES = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))


def chunk(kind: bytes, body: bytes = b"") -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def ihdr(width: int, height: int, bits: int = 8, colour: int = GREY, interlaced: bool = False) -> bytes:
    """The chunk that says how large an image is."""
    return chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, interlaced))


def png(head: bytes, rows: bytes, before: bytes = b"") -> bytes:
    """A PNG of its first chunk, its rows, each behind the number of its filter, and chunks between."""
    return SIGNATURE + head + before + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND")


def interlaced_png(pixels: np.ndarray) -> bytes:
    """An Adam7 PNG of 8 bits. pixels : (H, W) or (H, W, channels) uint8"""
    height, width = pixels.shape[:2]
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    colour = {1: GREY, 2: GREY_ALPHA, 3: COLOUR, 4: COLOUR_ALPHA}[channels]
    rows = bytearray()
    for left, top, across, down in PASSES:
        part = pixels[top::down, left::across]
        for row in part if part.size else ():
            rows += b"\0" + row.tobytes()
    return png(ihdr(width, height, 8, colour, interlaced=True), bytes(rows))


def black_png(side: int, colour: int, bits: int = 8, interlaced: bool = False, before: bytes = b"") -> bytes:
    """A square PNG, all of it 0; made without ever holding its pixels."""
    packed = zlib.compressobj(9)
    body = b"".join(packed.compress(part) for part in _black(side, bits * CHANNELS[colour], interlaced))
    head = ihdr(side, side, bits, colour, interlaced)
    return SIGNATURE + head + before + chunk(b"IDAT", body + packed.flush()) + chunk(b"IEND")


def _black(side: int, bits_per_pixel: int, interlaced: bool) -> Iterator[bytes]:
    for left, top, across, down in PASSES if interlaced else ((0, 0, 1, 1),):
        columns, rows = len(range(left, side, across)), len(range(top, side, down))
        row = bytes(1 + -(-columns * bits_per_pixel // 8))
        for _ in range(rows if columns else 0):
            yield row


def bmp(width: int, height: int, body: bytes, bits: int = 24, compression: int = 0) -> bytes:
    """A BMP; one of 8 bits or less has a palette of greys.

    compression : 0 for none, 1 for run lengths of 8 bits, 2 for those of 4
    """
    palette = b"".join(bytes([k, k, k, 0]) for k in range(2**bits)) if bits <= 8 else b""
    at = 54 + len(palette)
    sizes = struct.pack("<IiiHHIIiiII", 40, width, height, 1, bits, compression, len(body), 0, 0, 0, 0)
    return b"BM" + struct.pack("<IHHI", at + len(body), 0, 0, at) + sizes + palette + body


EXIF = b"Exif\0\0"


def exif(orientation: int, order: str = "<") -> bytes:
    """EXIF that says how a picture lies, 1 … 8, and nothing else. order : of bytes, < or >"""
    tiff = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(f"{order}I", 8)
    return EXIF + tiff + struct.pack(f"{order}HHHIHHI", 1, 0x0112, 3, 1, orientation, 0, 0)


def segment(marker: int, body: bytes) -> bytes:
    """A part of a JPEG."""
    return bytes([0xFF, marker]) + struct.pack(">H", len(body) + 2) + body


def repeated_scans(image: Image.Image, more: int) -> bytes:
    """A progressive JPEG whose last scan is there so many times more."""
    stream = io.BytesIO()
    image.save(stream, "JPEG", progressive=True)
    data = stream.getvalue()
    at = data.rindex(b"\xff\xda")
    return data[:-2] + data[at:-2] * more + data[-2:]
