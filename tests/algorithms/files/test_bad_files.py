"""Map files that cannot be used: each is refused in words that name it, and nothing else happens."""

from __future__ import annotations

import contextlib
import math
import struct
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from imagefiles import COLOUR, GREY_ALPHA, SIGNATURE, bmp, chunk, ihdr, png
from mapfiles import cells, encoded, header, load, pgm
from PIL import Image

from algorithms.common.errors import InputFileError, MapMergeError, TooLargeError
from algorithms.files.images import image_decoder as image
from algorithms.files.map_file import map_from_bytes, read_image, read_map
from algorithms.files.text_loader import MAX_ALIASES, MAX_DEPTH, MAX_VALUES
from algorithms.files.yaml_fields import MAX_YAML_BYTES


def indented(levels: int) -> bytes:
    """Mappings in each other by indentation."""
    return b"".join(b" " * k + b"a:\n" for k in range(levels)) + b" " * levels + b"a: 1\n"


GOOD_PNG = encoded(Image.effect_noise((64, 64), 50), "PNG")
SIXTEEN_BIT_RGB = png(ihdr(1, 1, 16, COLOUR), bytes(7))
OLD_BMP = b"BM" + struct.pack("<IHHI", 26, 0, 0, 26) + struct.pack("<IHHHH", 12, 0, 5, 1, 24)

BAD_YAML = {
    "empty": (b"", "is empty"),
    "a list": (b"- 1\n- 2\n", "holds no keys"),
    "a text": (b"hello", "holds no keys"),
    "not YAML": (b"image: [1, 2\n", "not YAML"),
    "tabs": (b"image:\n\t- x\n", "not YAML"),
    "binary": (bytes(range(256)), "not YAML"),
    "not UTF-8": (b"image: \xff\xfe.pgm\n", "not YAML"),
    "an image": (pgm([[0]]), "m.yaml"),
    "very deep": (b"[" * 20_000, "nested too deeply"),
    "very long": (b"a: 1\n" * 50_000, "too long"),
    "no image": (header(image=None), "image is missing"),
    "no resolution": (header(resolution=None), "resolution is missing"),
    "no origin": (header(origin=None), "origin is missing"),
    "no negate": (header(negate=None), "negate is missing"),
    "no occupied_thresh": (header(occupied_thresh=None), "occupied_thresh is missing"),
    "no free_thresh": (header(free_thresh=None), "free_thresh is missing"),
    "twice": (header() + b"resolution: 0.1\n", "resolution stands there twice"),
    "half a character twice": (
        header() + b'"\\ud800": 1\n' * 2,
        "a text holds half a character, U+D800, line",
    ),
    "half a character": (header(image=None) + b'image: "m\\udfff.pgm"', "U+DFFF, line"),
    "a key that turns the text round twice": (
        header() + b'"\\u202e": 1\n' * 2,
        "the key [U+202E] stands there twice",
    ),
    "image empty": (header(image=""), "image is empty"),
    "image a list": (header(image=["m.pgm"]), "image is"),
    "resolution 0": (header(resolution=0), "positive"),
    "resolution negative": (header(resolution=-0.05), "positive"),
    "resolution a word": (header(resolution="fine"), "resolution is 'fine'"),
    "resolution with unit": (header(resolution="0.05 m"), "resolution"),
    "resolution NaN": (header(resolution=math.nan), "resolution is '.nan', not a finite number"),
    "resolution infinite": (header(resolution=math.inf), "not a finite number"),
    "resolution a thousand million": (
        header(resolution=None) + b"resolution: 1e9\n",
        "resolution is 1e+09 m; give metres per pixel, 0.0001 to 100",
    ),
    "resolution nan": (header(resolution=None) + b"resolution: nan\n", "resolution is 'nan', not a finite"),
    "resolution huge": (header(resolution=None) + b"resolution: 1e999", "not a finite number"),
    "resolution a kilometre": (
        header(resolution=1000.0),
        "resolution is 1000 m; give metres per pixel, 0.0001",
    ),
    "resolution beyond sense": (header(resolution=1e308), "resolution is 1e+308 m"),
    "resolution a micrometre": (
        header(resolution=1e-6),
        "resolution is 1e-06 m; give metres per pixel, 0.0001",
    ),
    "resolution next to nothing": (header(resolution=5e-324), "resolution is 4.94066e-324 m"),
    "origin far away": (header(origin=[1e308, 0, 0]), "which is more than 10,000 km away"),
    "origin a metre too far": (
        header(origin=[0, -10_000_001, 0]),
        "origin is [0, -10000001, 0], which is more than 10,000 km away",
    ),
    "origin overflows": (
        header(origin=None) + b"origin: [0, 1e999, 0]\n",
        "origin is [0, 1e999, 0], not 3 finite numbers",
    ),
    "origin turned round and round": (header(origin=[0, 0, 1e300]), "turns by more than 1,000 rad"),
    "resolution null": (header(resolution=None) + b"resolution:\n", "resolution is empty"),
    "resolution a list": (header(resolution=[1]), "resolution"),
    "origin short": (header(origin=[0, 0]), "origin is [0, 0], not 3"),
    "origin long": (header(origin=[0, 0, 0, 0]), "not 3 finite numbers"),
    "origin a number": (header(origin=0), "origin"),
    "origin NaN": (header(origin=[0, 0, math.nan]), "origin is [0, 0, .nan], not 3 finite numbers"),
    "origin of words": (header(origin=["a", "b", "c"]), "origin is [a, b, c]"),
    "origin nested": (header(origin=[[0], 0, 0]), "origin"),
    "negate a word": (header(negate="maybe"), "negate is 'maybe'"),
    "negate a fraction": (header(negate=0.5), "negate"),
    "mode unknown": (header(mode="ternary"), "trinary, scale, raw"),
    "mode a number": (header(mode=3), "mode is '3'"),
    "threshold NaN": (header(occupied_thresh=math.nan), "occupied_thresh"),
    "threshold above 1": (header(occupied_thresh=65), "[0, 1]"),
    "threshold below 0": (header(free_thresh=-0.1), "[0, 1]"),
    "thresholds swapped": (
        header(occupied_thresh=0.196, free_thresh=0.65),
        "free_thresh is 0.65 and occupied_thresh 0.196; free_thresh must be the smaller one",
    ),
    "thresholds equal": (header(occupied_thresh=0.5, free_thresh=0.5), "smaller"),
}


@pytest.mark.parametrize("case", BAD_YAML)
def test_a_bad_yaml_file_is_refused_in_words(case):
    data, words = BAD_YAML[case]
    with pytest.raises(InputFileError) as caught:
        map_from_bytes("m.yaml", data, "m.pgm", pgm([[0]]))
    message = str(caught.value)
    assert message.startswith("m.yaml: ")
    assert words in message
    assert len(message.splitlines()) == 1
    assert len(message) < 400
    assert caught.value.remedy


# name -> a file with so many of something, the most that are read, and what is said of one more
YAML_LIMITS = {
    "aliases": (lambda n: header() + b"a: &a x\nb: [" + b"*a, " * n + b"]", MAX_ALIASES, "too many values"),
    "values": (lambda n: header() + b"a: [" + b"1, " * (n - 18) + b"]", MAX_VALUES, "too many values"),
    "lists in each other": (lambda n: header() + b"a: " + b"[" * (n - 1) + b"]" * (n - 1), MAX_DEPTH, "deep"),
    "mappings in each other": (lambda n: header() + indented(n - 1), MAX_DEPTH, "nested too deeply"),
    "lists and mappings in turn": (
        lambda n: header() + b"a: " + b"{b: " * 9 + b"[" * (n - 10) + b"]" * (n - 10) + b"}" * 9,
        MAX_DEPTH,
        "nested too deeply",
    ),
    "bytes": (lambda n: header().ljust(n, b"\n"), MAX_YAML_BYTES, "bytes, which is too long"),
}


@pytest.mark.parametrize("what", YAML_LIMITS)
def test_a_yaml_file_at_a_limit_is_read_and_one_step_beyond_it_is_refused(what):
    made, most, words = YAML_LIMITS[what]
    assert map_from_bytes("m.yaml", made(most), "m.pgm", pgm([[0]])).cells.tolist() == [[100]]
    with pytest.raises(InputFileError, match=rf"^m.yaml: .*{words}"):
        map_from_bytes("m.yaml", made(most + 1), "m.pgm", pgm([[0]]))


BAD_IMAGE = {
    "empty": (b"", "is empty"),
    "text": (b"hello, world", "not a PGM, PPM, PBM, PNG or BMP"),
    "JPEG": (encoded(Image.new("L", (8, 8)), "JPEG"), "not a PGM, PPM, PBM, PNG or BMP"),
    "GIF": (encoded(Image.new("L", (8, 8)), "GIF"), "not a PGM, PPM, PBM, PNG or BMP"),
    "TIFF": (encoded(Image.new("CMYK", (8, 8)), "TIFF"), "not a PGM, PPM, PBM, PNG or BMP"),
    "PGM head only": (b"P5\n", "decoded"),
    "PGM cut in its head": (b"P5\n10 ", "decoded"),
    "PGM cut": (pgm(np.zeros((9, 9)))[:-1], "cut off: 9 x 9"),
    "PGM without width": (b"P5\n0 5\n255\n", "0 x 5 pixels"),
    "PGM negative": (b"P5\n-3 5\n255\n" + bytes(15), "decoded"),
    "PGM white 0": (b"P5\n1 1\n0\n\0", "white is 0"),
    "PGM 16 bit": (b"P5\n1 1\n65535\n\0\0", "16 bits"),
    "PGM 12 bit": (b"P5\n1 1\n4095\n\0\0", "16 bits"),
    "PPM 16 bit": (b"P6\n1 1\n65535\n" + bytes(6), "16 bits"),
    "ASCII PGM 16 bit": (b"P2\n1 1\n1000\n7\n", "16 bits"),
    "ASCII PGM cut": (b"P2\n3 1\n255\n7 7", "cut off: 3 x 1"),
    "ASCII PGM of words": (b"P2\n3 1\n255\n7 seven 7", "something else than numbers"),
    "ASCII PGM of signs": (b"P2\n3 1\n255\n7 -7 7", "something else than numbers"),
    "ASCII PGM above its white": (b"P2\n2 1\n100\n7 101", "a pixel of 101"),
    "ASCII PGM too long": (b"P2\n4000 4000\n255\n" + b"0 " * 8_000_001, "16 MB of pixels written as text"),
    "ASCII PPM cut": (b"P3\n2 1\n255\n1 2 3 4 5", "cut off: 2 x 1"),
    "ASCII PBM cut": (b"P1\n3 2\n0 1 1 0 1", "cut off: 3 x 2 pixels are announced, 5 are there"),
    "ASCII PBM of words": (b"P1\n3 1\n0 one 1", "something else than 0 and 1"),
    "ASCII PBM of numbers": (b"P1\n3 1\n0 2 1", "something else than 0 and 1"),
    "ASCII PBM too long": (b"P1\n1000 1000\n" + b"0 " * 8_000_001, "16 MB of pixels written as text"),
    "PGM without height": (b"P5\n5 0\n255\n", "has 5 x 0 pixels; give an image with pixels"),
    "ASCII PGM without width": (b"P2\n0 5\n255\n", "0 x 5 pixels"),
    "PBM cut": (b"P4\n9 3\n" + bytes(5), "cut off: 9 x 3"),
    "PBM without height": (b"P4\n9 0\n" + bytes(5), "9 x 0 pixels"),
    "PGM of comments": (b"P5\n" + b"#\n" * 40_000 + b"1 1\n255\n\0", "decoded"),
    "PPM cut": (b"P6\n9 9\n255\n" + bytes(9), "cut off: 9 x 9"),
    "PFM": (b"Pf\n1 1\n-1.0\n" + bytes(4), "not a PGM"),
    "PNG 16 bit": (encoded(Image.new("I;16", (2, 2)), "PNG"), "16 bits"),
    "PNG 16 bit colour": (SIXTEEN_BIT_RGB, "16 bits"),
    "PNG cut": (GOOD_PNG[: len(GOOD_PNG) // 2], "decoded"),
    "PNG head only": (GOOD_PNG[:8], "decoded"),
    "PNG damaged": (GOOD_PNG[:60] + bytes(40) + GOOD_PNG[100:], "decoded"),
    "PNG 16 bit by its second header": (png(ihdr(1, 1), bytes(7), ihdr(1, 1, 16, COLOUR)), "16 bits"),
    "PNG 16 bit with alpha": (png(ihdr(1, 1, 16, GREY_ALPHA), bytes(5)), "16 bits"),
    "PNG without width": (png(ihdr(0, 5), bytes(5)), "has 0 x 5 pixels; give an image with pixels"),
    "PNG without height": (png(ihdr(5, 0), b""), "has 5 x 0 pixels"),
    "PNG without pixels by its second header": (png(ihdr(1, 1), bytes(2), ihdr(0, 1)), "m.png"),
    "PNG without data": (SIGNATURE + ihdr(3, 2) + chunk(b"IEND"), "decoded"),
    "CMYK": (encoded(Image.new("CMYK", (8, 8)), "JPEG"), "m.png: is not a PGM, PPM, PBM, PNG or BMP"),
    "BMP without width": (bmp(0, 5, b""), "has 0 x 5 pixels; give an image with pixels"),
    "BMP without height": (bmp(5, 0, b""), "has 5 x 0 pixels"),
    "BMP of a negative width": (bmp(-5, 5, b""), "has -5 x 5 pixels"),
    "old BMP without width": (OLD_BMP, "has 0 x 5 pixels"),
    "BMP of run lengths": (
        bmp(2001, 2000, b"\0\1", 8, 1),
        "BMP of run lengths with 2001 x 2000 pixels; at most 4,000,000",
    ),
    "BMP of short run lengths": (bmp(65_000, 1500, b"\0\1", 4, 2), "BMP of run lengths with 65000 x 1500"),
    "BMP cut": (encoded(Image.new("RGB", (9, 9)), "BMP")[:-40], "decoded"),
    "BMP head only": (b"BM", "decoded"),
}


@pytest.mark.parametrize("case", BAD_IMAGE)
def test_a_bad_image_is_refused_in_words(case):
    data, words = BAD_IMAGE[case]
    with pytest.raises(InputFileError) as caught:
        map_from_bytes("m.yaml", header(), "m.png", data)
    message = str(caught.value)
    assert message.startswith("m.png: ")
    assert words in message
    assert len(message.splitlines()) == 1
    assert caught.value.remedy


def test_pixels_of_a_kind_that_only_another_pillow_makes_are_refused(monkeypatch):
    """Which kinds there are has changed from one Pillow to the next; of CMYK it would make some grey."""
    monkeypatch.setattr(image.BmpImagePlugin, "BmpImageFile", lambda _: Image.new("CMYK", (8, 8)))
    with pytest.raises(InputFileError, match=r"^m.pgm: has pixels of the kind CMYK; save it as an 8-bit PGM"):
        load(bmp(8, 8, bytes(192)))


def test_an_image_that_memory_does_not_suffice_for_is_not_called_damaged(monkeypatch):
    monkeypatch.setattr(image, "read_netpbm", Mock(side_effect=MemoryError))
    with pytest.raises(InputFileError, match=r"^m.pgm: needs more memory than there is; crop the map"):
        load(pgm([[0]]))


def test_a_bmp_of_run_lengths_is_read():
    runs = b"\3\0\0\0" + b"\1\377\2\0" + b"\0\1"  # black black black; white black black
    assert cells(bmp(3, 2, runs, 8, 1)) == [[100, 100, 100], [0, 100, 100]]


HUGE = {
    "PGM": b"P5\n20000 20000\n255\n",
    "ASCII PGM": b"P2\n20000 20000\n255\n",
    "PBM": b"P4\n20000 20000\n",
    "ASCII PBM": b"P1\n20000 20000\n",
    "PGM of one column": b"P5\n1 65536\n255\n" + bytes(65536),
    "PNG of one column": SIGNATURE + ihdr(1, 100_000_000, 1) + chunk(b"IDAT", b"") + chunk(b"IEND", b""),
    "PNG of one row": SIGNATURE + ihdr(50_000_000, 1, 8, 6) + chunk(b"IDAT", b"") + chunk(b"IEND", b""),
    "PNG": SIGNATURE + ihdr(20000, 20000) + chunk(b"IDAT", b"") + chunk(b"IEND", b""),
    "PNG at its format's limit": SIGNATURE + ihdr(2**31 - 1, 2**31 - 1) + chunk(b"IDAT", b""),
    "BMP": bmp(20000, 20000, b""),
}


@pytest.mark.parametrize("kind", HUGE)
def test_a_huge_image_is_refused_by_its_header(kind):
    with pytest.raises(TooLargeError, match=r"m.pgm .*limit"):
        load(HUGE[kind])


@given(data=st.binary(max_size=60), at=st.integers(0, len(GOOD_PNG) - 1))
def test_a_damaged_png_loads_or_is_refused_and_nothing_else(data, at):
    with contextlib.suppress(MapMergeError):
        load(GOOD_PNG[:at] + data + GOOD_PNG[at + len(data) :])


@given(data=st.binary(max_size=200))
def test_any_bytes_for_a_yaml_file_are_refused_and_nothing_else(data):
    with pytest.raises(InputFileError):
        map_from_bytes("m.yaml", data, "m.pgm", pgm([[0]]))


def test_a_message_stays_short_whatever_the_file_holds():
    bomb = b"a: &a [x, x, x, x, x, x, x, x, x]\n"
    for name, last in zip("bcdefghij", "abcdefghi", strict=True):
        bomb += f"{name}: &{name} [{', '.join([f'*{last}'] * 9)}]\n".encode()
    with pytest.raises(InputFileError) as caught:
        map_from_bytes("m.yaml", header(origin=None) + bomb + b"origin: *j\n", "m.pgm", b"")
    assert len(str(caught.value)) < 400


def test_missing_files_and_folders_are_named(tmp_path):
    with pytest.raises(InputFileError, match=r"none\.yaml: no such file"):
        read_map(tmp_path / "none.yaml")
    with pytest.raises(InputFileError, match=r"none\.pgm: no such file"):
        read_map(tmp_path / "none.pgm")
    with pytest.raises(InputFileError, match=r"none\.pgm: no such file"):
        read_image(tmp_path / "none.pgm", 0.05)
    with pytest.raises(InputFileError, match="is a folder"):
        read_map(tmp_path)
    with pytest.raises(InputFileError, match="cannot be read"):
        read_map(Path("a\0b.yaml"))
    (tmp_path / "m.yaml").write_bytes(header(image="gone.pgm"))
    with pytest.raises(InputFileError, match=r"m\.yaml: its image gone\.pgm is not there"):
        read_map(tmp_path / "m.yaml")
    (tmp_path / "gone.pgm").mkdir()
    with pytest.raises(InputFileError, match=r"m\.yaml: its image gone\.pgm is a folder"):
        read_map(tmp_path / "m.yaml")
    with pytest.raises(InputFileError, match=r"gone\.pgm: is a folder; check the path"):
        read_map(tmp_path / "gone.pgm")
    with pytest.raises(InputFileError, match="cannot be read"):
        read_map(Path("a\0b.pgm"))
