"""Image files to grey pixels; judged by content, and not decoded before their size is known."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO

import numpy as np
from PIL import BmpImagePlugin, Image, ImageFile, PngImagePlugin

from algorithms.common.errors import InputFileError, MapMergeError
from algorithms.files.images.netpbm import CONVERT, HEAD, is_netpbm, read_header, read_netpbm
from algorithms.files.images.thresholds import GreyArray
from algorithms.maps.grid_map import MAX_CELLS, check_size

# An uncompressed image with alpha at the largest size, and 1 MB for what stands before the pixels.
MAX_IMAGE_BYTES = 4 * MAX_CELLS + 1_000_000
SMALLER = "crop the map, or make it coarser"
PNG, BMP = b"\x89PNG\r\n\x1a\n", b"BM"
OS2 = b"\x0c"  # length of the oldest header of a BMP, with sides of two bytes
# Pillow fills a BMP of run lengths byte by byte: 13 s for 100 million.
MAX_RUN_CELLS = 4_000_000
RUN_LENGTHS = (1, 2)  # kinds of compression: of 8 bits and of 4
# All that Pillow 13 opens a PNG or BMP of 8 bits to. It is not pinned, and of another kind it would make
# grey without a word, cut off at 255.
MODES_READ = ("1", "L", "LA", "P", "RGB", "RGBA")


def read_pixels(source: str, stream: BinaryIO) -> tuple[GreyArray, GreyArray | None]:
    """Decode a PGM, PPM, PBM, PNG or BMP image.

    At the most 12 bytes per pixel are held (PNG in colour with a transparent one), 1 for a binary PGM; for
    one that is written as text 60, and 4 million grey pixels are then the most.

    source  : name of the file as the user knows it
    stream  : the file, at its start; seekable
    returns : grey (H, W) uint8, row 0 at the top, colours by their luma; and alpha (H, W) uint8, or
              None where the image has none
    raises  : InputFileError, TooLargeError
    """
    with decoding(source, SMALLER):
        stream.seek(0, 2)
        n_bytes = stream.tell()
        if n_bytes > MAX_IMAGE_BYTES:
            found = f"has {n_bytes / 1e6:,.0f} MB; at most {MAX_IMAGE_BYTES / 1e6:,.0f} are read"
            raise InputFileError(source, found, SMALLER)
        stream.seek(0)
        head = stream.read(HEAD)
        if is_netpbm(head):
            header = read_header(source, head)
            _check_header(source, header.width, header.height, bits=8 if header.maxval <= 255 else 16)
            stream.seek(header.n_bytes)
            return read_netpbm(source, stream, header), None
        stream.seek(0)
        return _decode(source, stream, head)


@contextmanager
def decoding(source: str, smaller: str) -> Iterator[None]:
    """Within it, whatever a decoder raises becomes an InputFileError.

    smaller : what to do where memory does not suffice
    """
    try:
        yield
    except MapMergeError:
        raise
    except MemoryError as error:
        raise InputFileError(source, "needs more memory than there is", smaller) from error
    except Exception as error:  # decoders raise nearly anything on a damaged file
        cause = (str(error) or type(error).__name__).splitlines()[0]
        remedy = "the file is damaged; save or copy it anew"
        raise InputFileError(source, f"cannot be decoded ({cause})", remedy) from error


def _decode(source: str, stream: BinaryIO, head: bytes) -> tuple[GreyArray, GreyArray | None]:
    """An image by its decoder. The class is called by name, not through Image.open: so no other
    format can be meant, and the bound on the size is ours.
    """
    image: ImageFile.ImageFile
    announced = announced_size(head)
    if announced is not None:  # of no pixels, to Pillow it would be an image of an unknown kind
        _check_pixels(source, *announced)
    if head.startswith(PNG):
        image = PngImagePlugin.PngImageFile(stream)
        # Of 16 bits Pillow would quietly keep the upper 8. Its own word for them counts, for of several
        # headers it goes by the last.
        bits = 16 if any("16" in str(tile[3]) for tile in image.tile) else 8
    elif head.startswith(BMP):
        image = BmpImagePlugin.BmpImageFile(stream)
        bits = 8
    else:
        found = "is empty" if not head else "is not a PGM, PPM, PBM, PNG or BMP image"
        raise InputFileError(source, found, f"{CONVERT}; what its name ends in does not count")
    _check_header(source, image.width, image.height, bits)
    if image.mode not in MODES_READ:
        raise InputFileError(source, f"has pixels of the kind {image.mode}", CONVERT)
    check_runs(source, image)
    image.load()
    flat: Image.Image = image
    if "transparency" in image.info:
        flat = image.convert("RGBA")
    alpha = np.asarray(flat.getchannel("A")) if flat.mode in ("LA", "RGBA") else None
    return np.asarray(flat.convert("L")), alpha


def announced_size(head: bytes) -> tuple[int, int] | None:
    """Width and height in pixels, as the header of a PNG or BMP says; None where it does not."""
    sides, at = (">II", 16) if head.startswith(PNG) else ("<HH" if head[14:15] == OS2 else "<ii", 18)
    if not head.startswith((PNG, BMP)) or len(head) < at + struct.calcsize(sides):
        return None
    width, height = struct.unpack_from(sides, head, at)
    return width, abs(height)  # of a BMP it is negative where the top row is the first


def check_runs(source: str, image: ImageFile.ImageFile) -> None:
    """Raise InputFileError for a BMP of run lengths that would take too long."""
    if image.info.get("compression") in RUN_LENGTHS and image.width * image.height > MAX_RUN_CELLS:
        found = f"is a BMP of run lengths with {image.width} x {image.height} pixels"
        raise InputFileError(source, f"{found}; at most {MAX_RUN_CELLS:,} are read", CONVERT)


def _check_pixels(source: str, width: int, height: int) -> None:
    if width <= 0 or height <= 0:
        raise InputFileError(source, f"has {width} x {height} pixels", "give an image with pixels")


def _check_header(source: str, width: int, height: int, bits: int) -> None:
    """Raise where the image that a header announces is not worth decoding."""
    _check_pixels(source, width, height)
    if bits > 8:
        raise InputFileError(source, f"has {bits} bits for each grey or colour of a pixel", CONVERT)
    check_size(width, height, source)
