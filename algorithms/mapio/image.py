"""Image files to grey pixels; judged by content, and not decoded before their size is known."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np
from PIL import BmpImagePlugin, Image, ImageFile, PngImagePlugin

from algorithms.errors import InputFileError, MapMergeError
from algorithms.gridmap import MAX_CELLS, check_size
from algorithms.mapio.netpbm import CONVERT, HEAD, is_netpbm, read_header, read_netpbm
from algorithms.mapio.shading import GreyArray

# An uncompressed image with alpha at the largest size, and 1 MB for what stands before the pixels.
MAX_IMAGE_BYTES = 4 * MAX_CELLS + 1_000_000
MODES_READ = ("1", "L", "LA", "P", "PA", "RGB", "RGBA")


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
    try:
        stream.seek(0, 2)
        n_bytes = stream.tell()
        if n_bytes > MAX_IMAGE_BYTES:
            raise InputFileError(
                source,
                f"has {n_bytes / 1e6:,.0f} MB; at most {MAX_IMAGE_BYTES / 1e6:,.0f} are read",
                "crop the map, or make it coarser",
            )
        stream.seek(0)
        head = stream.read(HEAD)
        if is_netpbm(head):
            header = read_header(source, head)
            _check_header(source, header.width, header.height, bits=8 if header.maxval <= 255 else 16)
            stream.seek(header.n_bytes)
            return read_netpbm(source, stream, header), None
        stream.seek(0)
        return _decode(source, stream, head)
    except MapMergeError:
        raise
    except Exception as error:  # decoders raise nearly anything on a damaged file
        cause = (str(error) or type(error).__name__).splitlines()[0]
        raise InputFileError(
            source, f"cannot be decoded ({cause})", "the file is damaged; save or copy it anew"
        ) from error


def _decode(source: str, stream: BinaryIO, head: bytes) -> tuple[GreyArray, GreyArray | None]:
    """An image by its decoder. The class is called by name, not through Image.open: so no other
    format can be meant, and the bound on the size is ours.
    """
    bits = 8
    image: ImageFile.ImageFile
    if head.startswith(b"\x89PNG\r\n\x1a\n"):
        bits = head[24] if len(head) > 24 else 8  # Pillow would quietly keep the upper 8 of 16
        image = PngImagePlugin.PngImageFile(stream)
    elif head.startswith(b"BM"):
        image = BmpImagePlugin.BmpImageFile(stream)
    else:
        found = "is empty" if not head else "is not a PGM, PPM, PBM, PNG or BMP image"
        raise InputFileError(source, found, f"{CONVERT}; what its name ends in does not count")
    _check_header(source, image.width, image.height, bits)
    if image.mode not in MODES_READ:
        raise InputFileError(source, f"has pixels of the kind {image.mode}", CONVERT)
    image.load()
    flat: Image.Image = image
    if "transparency" in image.info or image.mode == "PA":
        flat = image.convert("RGBA")
    alpha = np.asarray(flat.getchannel("A")) if flat.mode in ("LA", "RGBA") else None
    return np.asarray(flat.convert("L")), alpha


def _check_header(source: str, width: int, height: int, bits: int) -> None:
    """Raise where the image that a header announces is not worth decoding."""
    if width <= 0 or height <= 0:
        raise InputFileError(source, f"has {width} x {height} pixels", "give an image with pixels")
    if bits > 8:
        raise InputFileError(source, f"has {bits} bits for each grey or colour of a pixel", CONVERT)
    check_size(width, height, source)
