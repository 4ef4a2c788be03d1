"""Image files to grey pixels; judged by content, and not decoded before their size is known."""

from __future__ import annotations

import re
from typing import BinaryIO

import numpy as np
from PIL import BmpImagePlugin, Image, ImageFile, PngImagePlugin, PpmImagePlugin

from algorithms.errors import InputFileError, MapMergeError
from algorithms.gridmap import MAX_CELLS, check_size
from algorithms.mapio.shading import GreyArray

# An uncompressed image with alpha at the largest size, and 1 MB for what stands before the pixels.
MAX_IMAGE_BYTES = 4 * MAX_CELLS + 1_000_000
MAX_TEXT_BYTES = 16_000_000  # of a netpbm image written as text: 2000 x 2000 pixels
MODES_READ = ("1", "L", "LA", "P", "PA", "RGB", "RGBA")
CONVERT = "save it as an 8-bit PGM or PNG"

_BREAK = rb"(?:\s|#[^\n\r]*[\n\r])+"
_NETPBM = re.compile(
    rb"P([2356])" + _BREAK + rb"(\d{1,9})" + _BREAK + rb"(\d{1,9})" + _BREAK + rb"(\d{1,9})\s"
)


def read_pixels(source: str, stream: BinaryIO) -> tuple[GreyArray, GreyArray | None]:
    """Decode a PGM, PPM, PBM, PNG or BMP image.

    At the most 9 bytes per pixel are held (PNG with colour and alpha), 1 for a binary PGM; for one that
    is written as text 60, and 4 million pixels are then the most.

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
        head = stream.read(4096)
        netpbm = _NETPBM.match(head)
        if netpbm:
            kind, width, height, maxval = (int(group) for group in netpbm.groups())
            _check_header(source, width, height, bits=8 if maxval <= 255 else 16)
            stream.seek(netpbm.end())
            return _read_netpbm(source, stream, kind, width, height, maxval), None
        stream.seek(0)
        return _decode(source, stream, head)
    except MapMergeError:
        raise
    except Exception as error:  # decoders raise nearly anything on a damaged file
        cause = (str(error) or type(error).__name__).splitlines()[0]
        raise InputFileError(
            source, f"cannot be decoded ({cause})", "the file is damaged; save or copy it anew"
        ) from error


def _read_netpbm(source: str, stream: BinaryIO, kind: int, width: int, height: int, maxval: int) -> GreyArray:
    """The pixels of a PGM or PPM, which is what nearly every map is. Pillow would take a minute for a
    large one whose maxval is not 255, or that is written as text.
    """
    if maxval == 0:
        raise InputFileError(source, "says that its white is 0", CONVERT)
    colours = 3 if kind in (3, 6) else 1
    count = width * height * colours
    body = _text_samples(source, stream, maxval, count) if kind in (2, 3) else stream.read(count)
    if len(body) < count:
        raise InputFileError(
            source,
            f"is cut off: {width} x {height} pixels are announced, {len(body) // colours} are there",
            "copy it anew",
        )
    if maxval != 255:
        stretched = np.minimum(np.floor(np.arange(256) * (255 / maxval) + 0.5), 255)
        body = body.translate(stretched.astype(np.uint8).tobytes())
    samples = np.frombuffer(body, dtype=np.uint8)
    if colours == 1:
        return samples.reshape(height, width)
    return np.asarray(Image.fromarray(samples.reshape(height, width, 3)).convert("L"))


def _text_samples(source: str, stream: BinaryIO, maxval: int, count: int) -> bytes:
    """The first ``count`` samples of a netpbm file that is written as text, or as many as there are."""
    text = stream.read(MAX_TEXT_BYTES + 1)
    if len(text) > MAX_TEXT_BYTES:
        raise InputFileError(
            source, f"has more than {MAX_TEXT_BYTES / 1e6:,.0f} MB of pixels written as text", CONVERT
        )
    words = re.sub(rb"#[^\n\r]*", b" ", text).split(maxsplit=count)[:count]
    if any(len(word) > 3 or not word.isdigit() for word in set(words)):
        raise InputFileError(source, "holds something else than numbers among its pixels", CONVERT)
    samples = np.array(words, dtype="S3").astype(np.int16)
    if samples.size and samples.max() > maxval:
        raise InputFileError(
            source, f"has a pixel of {samples.max()}, and says that its white is {maxval}", CONVERT
        )
    return samples.astype(np.uint8).tobytes()


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
    elif re.match(rb"P[1-6]\s", head):
        image = PpmImagePlugin.PpmImageFile(stream)
    else:
        found = "is empty" if not head else "is not a PGM, PPM, PNG or BMP image"
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
