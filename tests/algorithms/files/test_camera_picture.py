"""Pictures of every kind come out as red, green and blue; what cannot be used is refused before decoding."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from imagefiles import (
    COLOUR,
    COLOUR_ALPHA,
    GREY,
    GREY_ALPHA,
    SIGNATURE,
    black_png,
    bmp,
    chunk,
    exif,
    ihdr,
    png,
    repeated_scans,
    segment,
)
from mapfiles import encoded, pgm
from PIL import Image, ImageOps

from algorithms.common.errors import InputFileError
from algorithms.files import camera_picture
from algorithms.files.camera_picture import (
    MOST_BYTES,
    picture_from_bytes,
    picture_to_jpeg,
    picture_to_png,
    read_picture,
)
from algorithms.sensors.camera import LEAST_SIDE

SHAPES = st.tuples(st.integers(LEAST_SIDE, 48), st.integers(LEAST_SIDE, 48))


@st.composite
def pictures(draw: st.DrawFn) -> np.ndarray:
    """(H, W, 3) of any colours."""
    seed = draw(st.integers(0, 2**32 - 1))
    return np.random.default_rng(seed).integers(0, 256, (*draw(SHAPES), 3), dtype=np.uint8)


ROWS, COLUMNS = np.indices((40, 56))
RAMP = np.stack([ROWS * 6, COLUMNS * 4, ROWS + COLUMNS], axis=2).astype(np.uint8)
PICTURE = Image.fromarray(RAMP)
GREY_PICTURE = PICTURE.convert("L")


@given(pictures())
def test_a_png_reads_back_as_it_was_written(rgb):
    np.testing.assert_array_equal(picture_from_bytes("p.png", picture_to_png(rgb)), rgb)


@given(pictures(), st.sampled_from(["BMP", "PPM", "WEBP", "PNG"]))
def test_what_is_not_lossy_reads_as_it_was_saved(rgb, kind):
    options = {"lossless": True} if kind == "WEBP" else {}
    np.testing.assert_array_equal(
        picture_from_bytes("p", encoded(Image.fromarray(rgb), kind, **options)), rgb
    )


def test_a_jpeg_reads_back_much_alike_and_the_better_the_larger():
    off = []
    for quality in (50, 88, 95):
        data = picture_to_jpeg(RAMP, quality)
        off.append((len(data), -np.abs(picture_from_bytes("p.jpg", data).astype(int) - RAMP).mean()))
    assert off == sorted(off)
    assert -off[1][1] < 3
    assert picture_to_jpeg(RAMP) == picture_to_jpeg(RAMP, 88)


@given(pictures(), st.integers(1, 8), st.sampled_from(["JPEG", "PNG", "WEBP"]))
def test_a_picture_comes_upright(rgb, lies, kind):
    options = {"lossless": True} if kind == "WEBP" else {}
    data = encoded(Image.fromarray(rgb), kind, exif=exif(lies), **options)
    plain = picture_from_bytes("p", encoded(Image.fromarray(rgb), kind, **options))
    stored = Image.fromarray(plain)
    stored.getexif()[0x0112] = lies
    upright = picture_from_bytes("p", data)
    np.testing.assert_array_equal(upright, np.asarray(ImageOps.exif_transpose(stored)))
    assert upright.flags["C_CONTIGUOUS"]


def test_grey_is_three_equal_colours():
    grey = np.asarray(GREY_PICTURE)
    for data in (
        encoded(GREY_PICTURE, "PNG"),
        encoded(GREY_PICTURE, "BMP"),
        pgm(grey),
        pgm(grey, b"P2"),
        png(
            ihdr(56, 40, 16, GREY),
            b"".join(b"\0" + (row * 257).astype(">u2").tobytes() for row in grey.astype(int)),
        ),
    ):
        np.testing.assert_array_equal(picture_from_bytes("p", data), np.stack([grey] * 3, axis=2))


@pytest.mark.parametrize("white", [1000, 4095, 65535])
def test_of_16_bits_white_stays_white(white):
    levels = (RAMP.astype(float) / 255 * white).round().astype(">u2")
    colour = b"P6\n56 40\n%d\n" % white + levels.tobytes()
    np.testing.assert_array_equal(picture_from_bytes("p.ppm", colour), RAMP)
    grey = b"P5\n56 40\n%d\n" % white + levels[:, :, 1].tobytes()
    np.testing.assert_array_equal(picture_from_bytes("p.pgm", grey)[:, :, 2], RAMP[:, :, 1])
    above = b"P5\n32 32\n%d\n" % min(white, 60000) + b"\xff\xff" * 1024
    assert (picture_from_bytes("p.pgm", above) == 255).all()


def test_colours_of_16_bits_keep_the_upper_8():
    rows = b"".join(b"\0" + np.stack([row, row[:, ::-1]], axis=2).tobytes() for row in RAMP)
    picture = picture_from_bytes("p.png", png(ihdr(56, 40, 16, COLOUR), rows))
    np.testing.assert_array_equal(picture, RAMP)


def test_a_palette_and_bits_are_colours():
    palette = PICTURE.quantize(64)
    np.testing.assert_array_equal(
        picture_from_bytes("p.png", encoded(palette, "PNG")), np.asarray(palette.convert("RGB"))
    )
    bits = GREY_PICTURE.convert("1")
    for kind in ("PNG", "PPM", "BMP"):
        np.testing.assert_array_equal(
            picture_from_bytes("p", encoded(bits, kind))[:, :, 0] > 0, np.asarray(bits)
        )


def test_what_is_transparent_lies_on_white():
    alpha = Image.fromarray((COLUMNS > 20).astype(np.uint8) * 255)
    for image in (PICTURE, GREY_PICTURE):
        image = image.copy()
        image.putalpha(alpha)
        for options in ({"format": "PNG"}, {"format": "WEBP", "lossless": True, "exact": True}):
            data = encoded(image, options["format"], **{k: v for k, v in options.items() if k != "format"})
            picture = picture_from_bytes("p", data)
            assert (picture[:, :21] == 255).all()
            np.testing.assert_array_equal(picture[:, 21:], np.asarray(image.convert("RGB"))[:, 21:])
    red = Image.new("RGB", (40, 40), (255, 0, 0))
    assert (picture_from_bytes("p", encoded(red, "PNG", transparency=(255, 0, 0))) == 255).all()


def test_the_four_colours_of_print_become_three():
    picture = picture_from_bytes("p.jpg", encoded(Image.new("CMYK", (40, 40), (0, 255, 255, 0)), "JPEG"))
    assert np.abs(picture[20, 20].astype(int) - (255, 0, 0)).max() < 5


@pytest.mark.parametrize("options", [{"progressive": True}, {"subsampling": 2}, {"icc_profile": b"x" * 99}])
def test_jpegs_of_every_kind_are_read(options):
    assert picture_from_bytes("p.jpg", encoded(PICTURE, "JPEG", **options)).shape == (40, 56, 3)
    four = encoded(PICTURE.convert("CMYK"), "JPEG", **options)
    assert picture_from_bytes("p.jpg", four).shape == (40, 56, 3)


def webp(kind: bytes, body: bytes) -> bytes:
    return b"RIFF" + struct.pack("<I", len(body) + 12) + b"WEBP" + kind + struct.pack("<I", len(body)) + body


LARGE = b"\x9d\x01\x2a" + struct.pack("<HH", 16383, 16383)
FRAMES = {"save_all": True, "append_images": [PICTURE.transpose(Image.Transpose.ROTATE_180)]}
GOOD = {kind: encoded(PICTURE, kind) for kind in ("JPEG", "PNG", "BMP", "WEBP", "PPM")}
SMALL = "give an image of at least 32 pixels a side and at most 16,000,000 in all"
# name -> the file, and what is said of it
BAD = {
    "empty": (b"", "is empty; give a JPEG, PNG, BMP, WebP, PPM or PGM image"),
    "a text": (b"hello", "is not a JPEG, PNG, BMP, WebP, PPM or PGM image; save it as JPEG or PNG"),
    "a GIF": (encoded(PICTURE, "GIF"), "is not a JPEG"),
    "a TIFF": (encoded(PICTURE, "TIFF"), "is not a JPEG"),
    "a picture of a telephone": (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", "is not a JPEG"),
    **{f"{kind} cut off": (data[: len(data) // 2], "") for kind, data in GOOD.items()},
    **{f"{kind} head only": (data[:12], "") for kind, data in GOOD.items()},
    "JPEG cut off in its pixels": (GOOD["JPEG"][:-60], "cannot be decoded (image file is truncated"),
    "JPEG without pixels": (GOOD["JPEG"][:200], "the file is damaged; save or copy it anew"),
    "PNG damaged": (GOOD["PNG"][:60] + bytes(40) + GOOD["PNG"][100:], "cannot be decoded"),
    "PPM cut off": (
        GOOD["PPM"][:-3],
        "is cut off: 56 x 40 pixels are announced, 2239 are there; copy it anew",
    ),
    "PGM of 16 bits cut off": (
        b"P5\n40 40\n999\n" + bytes(3199),
        "40 x 40 pixels are announced, 1599 are there",
    ),
    "PPM of 16 bits cut off": (
        b"P6\n40 40\n999\n" + bytes(9599),
        "40 x 40 pixels are announced, 1599 are there",
    ),
    "PGM of more bits": (b"P5\n40 40\n99999\n" + bytes(3200), "says that its white is 99999"),
    "PGM of no white": (b"P5\n40 40\n0\n" + bytes(1600), "says that its white is 0"),
    "PGM of 16 bits as text": (
        b"P2\n40 40\n999\n" + b"7 " * 1600,
        "has 16 bits for each pixel, written as text",
    ),
    "PNG without width": (png(ihdr(0, 50), b""), f"has 0 × 50 pixels; {SMALL}"),
    "BMP without height": (bmp(50, 0, b""), "has 50 × 0 pixels"),
    "PPM without height": (b"P6\n50 0\n255\n", "has 50 × 0 pixels"),
    "JPEG without height": (GOOD["JPEG"].replace(struct.pack(">HH", 40, 56), struct.pack(">HH", 0, 56)), ""),
    "tiny": (encoded(PICTURE.resize((31, 40)), "PNG"), f"has 31 × 40 pixels; {SMALL}"),
    "a huge PNG": (
        SIGNATURE + ihdr(2**31 - 1, 2**31 - 1) + chunk(b"IDAT", b""),
        "has 2147483647 × 2147483647",
    ),
    "a PNG of many pixels": (black_png(4001, GREY, 1), "has 4001 × 4001 pixels"),
    "a PNG that is huge by its second header": (
        png(ihdr(40, 40), bytes(40 * 41), ihdr(30_000, 30_000)),
        "has 30000 × 30000 pixels",
    ),
    "a huge BMP": (bmp(20_000, -20_000, b""), "has 20000 × 20000 pixels"),
    "a huge JPEG": (
        GOOD["JPEG"].replace(struct.pack(">HH", 40, 56), struct.pack(">HH", 65_000, 65_000)),
        "has 65000 × 65000 pixels",
    ),
    "a huge PPM": (b"P6\n20000 20000\n255\n", "has 20000 × 20000 pixels"),
    "a huge WebP": (webp(b"VP8 ", bytes(3) + LARGE + bytes(20)), "has 16383 × 16383 pixels"),
    "a huge WebP without loss": (
        webp(b"VP8L", b"\x2f\xff\xff\xff\xff" + bytes(20)),
        "has 16384 × 16384 pixels",
    ),
    "a huge WebP with more to it": (
        webp(b"VP8X", bytes(4) + b"\xff" * 6 + bytes(20)),
        "has 16777216 × 16777216",
    ),
    "a WebP that is larger than it says": (
        webp(b"VP8X", bytes(4) + b"\x3f\0\0\x3f\0\0") + webp(b"VP8 ", bytes(3) + LARGE + bytes(20))[12:],
        "cannot be decoded",
    ),
    "a WebP of no known kind": (webp(b"VP9 ", bytes(40)), "is a WebP without a size; it is damaged"),
    "a PNG that moves": (encoded(PICTURE, "PNG", **FRAMES), "is animated; give a single picture of it"),
    "a WebP that moves": (encoded(PICTURE, "WEBP", **FRAMES), "is animated; give a single picture"),
    "a JPEG of many scans": (repeated_scans(PICTURE, 30), "is a JPEG of 40 scans; save it as JPEG or PNG"),
    "a BMP of run lengths": (bmp(2001, 2000, b"\0\1", 8, 1), "at most 4,000,000 are read"),
    "other pixels": (png(ihdr(40, 40, 3, GREY), bytes(999)), "cannot be decoded"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_picture_is_refused_in_words(case):
    data, said = BAD[case]
    with pytest.raises(InputFileError) as told:
        picture_from_bytes("p.jpg", data)
    message = str(told.value)
    assert message.startswith("p.jpg: ")
    assert said in message
    assert "\n" not in message
    assert len(message) < 300
    assert told.value.remedy


def test_a_file_that_is_too_long_is_not_looked_at(tmp_path):
    with pytest.raises(InputFileError, match=r"has more than 97 MB; give a smaller picture"):
        picture_from_bytes("p.jpg", GOOD["JPEG"] + bytes(MOST_BYTES))


def test_pixels_of_a_kind_that_only_another_pillow_makes_are_refused(monkeypatch):
    monkeypatch.setattr(camera_picture.BmpImagePlugin, "BmpImageFile", lambda _: Image.new("LAB", (40, 40)))
    with pytest.raises(InputFileError, match=r"^p.bmp: has pixels of the kind LAB; save it as JPEG or PNG"):
        picture_from_bytes("p.bmp", GOOD["BMP"])


@pytest.mark.parametrize("colour", [COLOUR_ALPHA, GREY_ALPHA])
def test_a_black_picture_with_alpha_0_is_white(colour):
    assert (picture_from_bytes("p.png", black_png(40, colour, 16)) == 255).all()


def test_exif_that_would_fill_the_memory_is_not_unpacked():
    table = b"".join(struct.pack("<HHII", k, 7, 65_000, 0) for k in range(5_400))
    bomb = b"Exif\0\0II*\0\x08\0\0\0" + struct.pack("<H", 5_400) + table
    parts = segment(0xFE, b"a remark") + b"junk" + segment(0xE1, bomb[:65_000]) * 9
    data = GOOD["JPEG"][:2] + parts + GOOD["JPEG"][2:]
    np.testing.assert_array_equal(
        picture_from_bytes("p.jpg", data), picture_from_bytes("p.jpg", GOOD["JPEG"])
    )


def test_a_picture_is_read_from_disk_by_its_content_and_a_missing_one_and_a_folder_are_named(tmp_path):
    (tmp_path / "p.txt").write_bytes(GOOD["PNG"])
    np.testing.assert_array_equal(read_picture(tmp_path / "p.txt"), RAMP)
    with pytest.raises(InputFileError, match=r"no\.jpg: no such file; give the file of a camera's picture"):
        read_picture(tmp_path / "no.jpg")
    with pytest.raises(InputFileError, match="is a folder"):
        read_picture(tmp_path)
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information:\n")
    with pytest.raises(InputFileError, match=r"\(a rosbag2 folder\); give a JPEG, PNG"):
        read_picture(tmp_path)
