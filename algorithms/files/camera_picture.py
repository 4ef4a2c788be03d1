"""Pictures of a camera, to and from pixels in colour; judged by content, and small enough before decoding."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import BmpImagePlugin, Image, ImageFile, JpegImagePlugin, PngImagePlugin, WebPImagePlugin

from algorithms.common.errors import InputFileError, SettingError
from algorithms.files.images.image_decoder import BMP, PNG, announced_size, check_runs, decoding
from algorithms.files.images.netpbm import HEAD, TEXTS, Header, cut_off, is_netpbm, read_header, read_samples
from algorithms.files.images.picture_headers import (
    JPEG,
    bare_jpeg,
    bare_png,
    is_webp,
    orientation,
    scans_of,
    webp_size,
)
from algorithms.files.map_file import read_bytes
from algorithms.sensors.camera import LEAST_SIDE, MOST_PIXELS, check_image_size

PictureArray = NDArray[np.uint8]

PICTURE_SUFFIXES = (".jpg", ".jpeg", ".png", ".bmp", ".webp", ".ppm", ".pgm", ".pnm")
MOST_BYTES = 6 * MOST_PIXELS + 1_000_000  # all of its pixels with 16 bits for each colour, and what is before
MOST_SCANS = 24  # of a JPEG; 10 are usual, 18 with four colours, and each goes over all pixels
SMALLER = "give a smaller picture"
KINDS = "a JPEG, PNG, BMP, WebP, PPM or PGM image"
SAVE = "save it as JPEG or PNG; what its name ends in does not count"
STILL = "give a single picture of it, as JPEG or PNG"
MODES_OF_16_BITS = ("I;16", "I;16B", "I;16L", "I")
MODES_READ = ("1", "L", "LA", "P", "PA", "RGB", "RGBA", "CMYK", *MODES_OF_16_BITS)


def read_picture(path: Path | str) -> PictureArray:
    """Read a picture; ``picture_from_bytes`` says what comes of it. Raises InputFileError."""
    path = Path(path)
    data = read_bytes(path, "a camera's picture", MOST_BYTES, "file", f"give {KINDS}")
    return picture_from_bytes(str(path), data)


def is_picture(data: bytes) -> bool:
    """Whether a file begins as one of the images that are read; it may be damaged behind that."""
    return data.startswith((JPEG, PNG, BMP)) or is_webp(data) or is_netpbm(data[:HEAD])


def picture_from_bytes(name: str, data: bytes) -> PictureArray:
    """The pixels of a JPEG, PNG, BMP, WebP, PPM or PGM image, upright as its EXIF says.

    Grey becomes three equal colours, of 16 bits the upper 8 are taken, and what is transparent lies on white.

    name    : of the file, as the user knows it
    returns : (H, W, 3) uint8 red, green, blue; row 0 at the top
    raises  : InputFileError
    """
    with decoding(name, SMALLER):
        if not data:
            raise InputFileError(name, "is empty", f"give {KINDS}")
        if len(data) > MOST_BYTES:
            raise InputFileError(name, f"has more than {MOST_BYTES / 1e6:,.0f} MB", SMALLER)
        if is_netpbm(data[:HEAD]):
            return _netpbm(name, data)
        image, exif = _opened(name, data)
        _check_size(name, image.width, image.height)
        if getattr(image, "is_animated", False):
            raise InputFileError(name, "is animated", STILL)
        if image.mode not in MODES_READ:
            raise InputFileError(name, f"has pixels of the kind {image.mode}", SAVE)
        check_runs(name, image)
        image.load()
        return _upright(_colours(image), orientation(exif or image.info.get("exif", b"")))


def _opened(name: str, data: bytes) -> tuple[ImageFile.ImageFile, bytes]:
    """An image that is not decoded yet, by its decoder, and the EXIF of a JPEG. The class is called by name,
    not through Image.open: so no other format can be meant.
    """
    announced = webp_size(data[:30]) if is_webp(data) else announced_size(data[:HEAD])
    if announced is not None:
        _check_size(name, *announced)
    if data.startswith(JPEG):
        bare, exif = bare_jpeg(data)
        if scans_of(bare) > MOST_SCANS:
            raise InputFileError(name, f"is a JPEG of {scans_of(bare):,} scans", SAVE)
        return JpegImagePlugin.JpegImageFile(io.BytesIO(bare)), exif
    if data.startswith(PNG):
        return PngImagePlugin.PngImageFile(io.BytesIO(bare_png(data))), b""
    if data.startswith(BMP):
        return BmpImagePlugin.BmpImageFile(io.BytesIO(data)), b""
    if is_webp(data):
        if announced is None:
            raise InputFileError(name, "is a WebP without a size", "it is damaged; save or copy it anew")
        return WebPImagePlugin.WebPImageFile(io.BytesIO(data)), b""
    raise InputFileError(name, f"is not {KINDS}", SAVE)


def _check_size(name: str, width: int, height: int) -> None:
    """Raise InputFileError for a picture in which nothing could be found, or that is too large."""
    try:
        check_image_size(width, height, "it")
    except SettingError as error:
        found = f"has {width} × {height} pixels"
        remedy = f"give an image of at least {LEAST_SIDE} pixels a side and at most {MOST_PIXELS:,} in all"
        raise InputFileError(name, found, remedy) from error


def _colours(image: Image.Image) -> PictureArray:
    if image.mode in MODES_OF_16_BITS:
        grey = (np.asarray(image).astype(np.int32).clip(0, 65535) >> 8).astype(np.uint8)
        return np.stack([grey] * 3, axis=2)
    if "transparency" in image.info or image.mode in ("LA", "PA", "RGBA"):
        clear = image if image.mode == "RGBA" else image.convert("RGBA")
        image = Image.new("RGB", image.size, "white")
        image.paste(clear.convert("RGB"), mask=clear.getchannel("A"))
    return np.asarray(image.convert("RGB"))


def _upright(pixels: PictureArray, lies: int) -> PictureArray:
    """Pixels turned and mirrored as EXIF's orientation, 1 … 8, asks for."""
    if lies >= 5:
        pixels = pixels.transpose(1, 0, 2)
    if lies in (3, 4, 7, 8):
        pixels = pixels[::-1]
    if lies in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    return np.ascontiguousarray(pixels)


def _netpbm(name: str, data: bytes) -> PictureArray:
    header = read_header(name, data[:HEAD])
    _check_size(name, header.width, header.height)
    stream = io.BytesIO(data)
    stream.seek(header.n_bytes)
    if header.maxval > 255 and header.kind not in TEXTS:
        pixels = _of_16_bits(name, stream.read(), header)
    elif header.maxval > 255:
        raise InputFileError(name, "has 16 bits for each pixel, written as text", SAVE)
    else:
        pixels = read_samples(name, stream, header)
    return np.ascontiguousarray(pixels if pixels.ndim == 3 else np.stack([pixels] * 3, axis=2))


def _of_16_bits(name: str, body: bytes, header: Header) -> PictureArray:
    """(H, W) or (H, W, 3) of a PGM or PPM with two bytes for each grey or colour, the higher one first."""
    if header.maxval > 65535:
        raise InputFileError(name, f"says that its white is {header.maxval}, of more than 16 bits", SAVE)
    shape = (header.height, header.width, 3)[: 3 if header.kind == 6 else 2]
    count = int(np.prod(shape))
    if len(body) < 2 * count:
        raise cut_off(name, header, len(body) // (2 * (count // (header.height * header.width))))
    grey = (np.minimum(np.arange(65536) / header.maxval, 1) * 255 + 0.5).astype(np.uint8)
    return np.asarray(grey[np.frombuffer(body, dtype=">u2", count=count)]).reshape(shape)


def picture_to_jpeg(rgb: PictureArray, quality: int = 88) -> bytes:
    """A JPEG of (H, W, 3) uint8 red, green, blue. quality : 1 … 95"""
    return _encoded(rgb, "JPEG", quality=quality)


def picture_to_png(rgb: PictureArray) -> bytes:
    """A PNG of (H, W, 3) uint8 red, green, blue; it reads back as it was."""
    return _encoded(rgb, "PNG")


def _encoded(rgb: PictureArray, kind: str, **options: int) -> bytes:
    stream = io.BytesIO()
    Image.fromarray(rgb).save(stream, kind, **options)
    return stream.getvalue()
