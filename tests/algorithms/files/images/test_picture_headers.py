"""What stands before a picture's pixels is read without a decoder: what is not there takes no room."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from imagefiles import EXIF, chunk, exif, segment
from mapfiles import encoded
from PIL import Image

from algorithms.files.images.picture_headers import (
    bare_jpeg,
    bare_png,
    is_webp,
    orientation,
    scans_of,
    webp_size,
)

NOISE = Image.fromarray(np.random.default_rng(1).integers(0, 255, (40, 56, 3), np.uint8))
JPEG = encoded(NOISE, "JPEG")
PUT_BEFORE = [
    b"",
    segment(0xE1, EXIF + b"x" * 99),
    segment(0xE2, b"ICC_PROFILE\0\1\1"),
    segment(0xED, b"Photoshop 3.0\0"),
    segment(0xFE, b"a remark"),
    b"\xff\xff" + segment(0xFE, b"a remark"),
    b"junk",
    b"\xff\x00",
]


@given(st.lists(st.sampled_from(PUT_BEFORE), max_size=6))
def test_whatever_a_camera_puts_before_the_pixels_of_a_jpeg_goes_and_they_stay(before):
    kept, _ = bare_jpeg(JPEG[:2] + b"".join(before) + JPEG[2:])
    assert kept == JPEG


@given(st.binary(max_size=200))
def test_of_no_jpeg_nothing_is_left(data):
    kept, found = bare_jpeg(b"\xff\xd8\xff" + data.replace(b"\xda", b""))
    assert (kept, orientation(found)) == (b"", 1)


@given(st.lists(st.sampled_from([b"tEXt", b"iCCP", b"zTXt", b"gAMA", b"unKn"]), max_size=6))
def test_whatever_else_is_in_a_png_goes_and_its_pixels_stay(more):
    plain = encoded(NOISE, "PNG")
    head, rest = plain[:33], plain[33:]
    assert bare_png(head + b"".join(chunk(kind, b"a\0\0b") for kind in more) + rest) == plain
    assert bare_png(plain[:-20]) == plain[:-20]


@given(st.integers(1, 8), st.sampled_from("<>"))
def test_the_first_exif_of_a_jpeg_is_found(lies, order):
    data = JPEG[:2] + segment(0xE1, exif(lies, order)) + segment(0xE1, exif(9 - lies)) + JPEG[2:]
    kept, found = bare_jpeg(data)
    assert kept == JPEG
    assert orientation(found) == lies


@given(st.binary(max_size=80))
def test_exif_that_tells_nothing_is_upright(data):
    assert 1 <= orientation(data) <= 8
    assert 1 <= orientation(EXIF + b"II*\0" + data) <= 8
    assert 1 <= orientation(b"MM\0*\0\0\0\x08" + data) <= 8


@pytest.mark.parametrize("value", [0, 9, 65535])
def test_an_orientation_that_there_is_not_is_upright(value):
    assert orientation(exif(value)) == 1


def test_a_table_of_exif_that_is_longer_than_its_file_ends_with_it():
    table = exif(6)
    assert (
        orientation(table.replace(struct.pack("<H", 1) + struct.pack("<H", 0x112), b"\xff\xff\x12\x01")) == 6
    )
    for length in range(len(table)):
        assert orientation(table[:length]) in (1, 6)


def test_the_scans_of_a_jpeg_are_counted():
    assert scans_of(JPEG) == 1
    assert scans_of(bare_jpeg(encoded(NOISE, "JPEG", progressive=True))[0]) == 10


@pytest.mark.parametrize("options", [{}, {"lossless": True}, {"exif": exif(3)}])
def test_the_size_of_a_webp_is_known_by_its_first_bytes(options):
    data = encoded(NOISE, "WEBP", **options)
    assert is_webp(data)
    assert webp_size(data[:30]) == (56, 40)
    assert webp_size(data[:29]) is None


@given(st.binary(max_size=40))
def test_what_is_no_webp_has_no_size_or_a_small_one(data):
    size = webp_size(b"RIFF\0\0\0\0WEBP" + data)
    assert size is None or max(size) <= 2**24
