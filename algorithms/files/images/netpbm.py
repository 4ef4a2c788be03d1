"""PGM, PPM and PBM images, which is what nearly every map is. Pillow would take from a minute to half an
hour for a large one that is written as text, or whose maxval is not 255.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from PIL import Image

from algorithms.common.errors import InputFileError
from algorithms.files.images.thresholds import GreyArray

CONVERT = "save it as an 8-bit PGM or PNG"
MAX_TEXT_BYTES = 16_000_000  # of an image written as text: 2000 x 2000 pixels
HEAD = 65_536  # bytes in which a header, comments and all, must end

BITS, BITS_AS_TEXT = 4, 1
TEXTS = (1, 2, 3)

_BREAK = rb"(?:\s|#[^\n\r]*[\n\r])+"
_SIZE = rb"(\d{1,9})" + _BREAK + rb"(\d{1,9})"
_BITMAP = re.compile(rb"P([14])" + _BREAK + _SIZE + rb"()\s")  # which says nothing of its white
_GREYMAP = re.compile(rb"P([2356])" + _BREAK + _SIZE + _BREAK + rb"(\d{1,9})\s")
_COMMENTS = re.compile(rb"(?:#[^\n\r]*[\n\r]*)+")  # one after the other are found as one


@dataclass(frozen=True)
class Header:
    """What stands before the pixels.

    kind    : the digit after the P
    maxval  : the sample that is white; 1 where the image is of bits
    n_bytes : length of the header
    """

    kind: int
    width: int
    height: int
    maxval: int
    n_bytes: int


def is_netpbm(head: bytes) -> bool:
    """Whether a file that begins so is one of the six kinds that are read here."""
    return re.match(rb"P[1-6][\s#]", head) is not None


def read_header(source: str, head: bytes) -> Header:
    """The header at the start of the first HEAD bytes of a file; raises InputFileError."""
    found = _BITMAP.match(head) or _GREYMAP.match(head)
    if found is None:
        fault = "cannot be decoded (its width, height and white do not stand at its start)"
        raise InputFileError(source, fault, f"copy it anew, or {CONVERT}")
    kind, width, height, maxval = (int(group or b"1") for group in found.groups())
    return Header(kind, width, height, maxval, found.end())


def read_netpbm(source: str, stream: BinaryIO, header: Header) -> GreyArray:
    """(H, W) uint8 grey, row 0 at the top; ``stream`` stands behind the header. Raises InputFileError."""
    samples = read_samples(source, stream, header)
    return samples if samples.ndim == 2 else np.asarray(Image.fromarray(samples).convert("L"))


def read_samples(source: str, stream: BinaryIO, header: Header) -> GreyArray:
    """(H, W) uint8 grey, or (H, W, 3) of a PPM, of 8 bits at most; else as ``read_netpbm``."""
    width, height, maxval = header.width, header.height, header.maxval
    if maxval == 0:
        raise InputFileError(source, "says that its white is 0", CONVERT)
    if header.kind in (BITS, BITS_AS_TEXT):
        black = _black_pixels(source, stream, header)
        black -= 1  # 1 becomes 0; and 0, which is white here alone, the byte below it: 255
        return black
    colours = 3 if header.kind in (3, 6) else 1
    count = width * height * colours
    body = _samples(source, stream, maxval, count) if header.kind in TEXTS else stream.read(count)
    if len(body) < count:
        raise cut_off(source, header, len(body) // colours)
    if maxval != 255:
        stretched = np.minimum(np.floor(np.arange(256) * (255 / maxval) + 0.5), 255)
        body = body.translate(stretched.astype(np.uint8).tobytes())
    samples = np.frombuffer(body, dtype=np.uint8)
    return samples.reshape((height, width) if colours == 1 else (height, width, 3))


def _black_pixels(source: str, stream: BinaryIO, header: Header) -> GreyArray:
    """(H, W) 1 where a bit says black, else 0; writeable."""
    width, height = header.width, header.height
    if header.kind == BITS:
        stride = -(-width // 8)  # a row begins with a byte of its own
        body = stream.read(stride * height)
        if len(body) < stride * height:
            raise cut_off(source, header, len(body) // stride * width)
        packed = np.frombuffer(body, dtype=np.uint8).reshape(height, stride)
        return np.unpackbits(packed, axis=1, count=width)
    digits = _text(source, stream).translate(None, delete=b" \t\n\r\v\f")[: width * height]
    if digits.translate(None, delete=b"01"):
        raise InputFileError(source, "holds something else than 0 and 1 among its pixels", CONVERT)
    if len(digits) < width * height:
        raise cut_off(source, header, len(digits))
    return np.frombuffer(digits, dtype=np.uint8).reshape(height, width) - ord("0")


def _text(source: str, stream: BinaryIO) -> bytes:
    """The pixels of an image that is written as text, without the comments."""
    text = stream.read(MAX_TEXT_BYTES + 1)
    if len(text) > MAX_TEXT_BYTES:
        found = f"has more than {MAX_TEXT_BYTES / 1e6:,.0f} MB of pixels written as text"
        raise InputFileError(source, found, CONVERT)
    return _COMMENTS.sub(b" ", text)


def _samples(source: str, stream: BinaryIO, maxval: int, count: int) -> bytes:
    """The first ``count`` samples of a text, or as many as there are."""
    words = _text(source, stream).split(maxsplit=count)[:count]
    if any(len(word) > 3 or not word.isdigit() for word in set(words)):
        raise InputFileError(source, "holds something else than numbers among its pixels", CONVERT)
    samples = np.array(words, dtype="S3").astype(np.int16)
    if samples.size and samples.max() > maxval:
        found = f"has a pixel of {samples.max()}, and says that its white is {maxval}"
        raise InputFileError(source, found, CONVERT)
    return samples.astype(np.uint8).tobytes()


def cut_off(source: str, header: Header, pixels: int) -> InputFileError:
    """What is said of a file in which fewer pixels are than its header announces."""
    found = f"is cut off: {header.width} x {header.height} pixels are announced, {pixels} are there"
    return InputFileError(source, found, "copy it anew")
