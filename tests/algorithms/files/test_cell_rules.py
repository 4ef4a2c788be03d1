"""Which cell a pixel becomes: Nav2's rule by examples worked out by hand, and every kind of image."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from imagefiles import interlaced_png
from mapfiles import cells, encoded, load, pgm
from PIL import Image

# --- Nav2's rule, worked out by hand ---
# occ = 1 − grey / 255, or grey / 255 where negated, compared with 0.65 and 0.196 unless said.

RULE = [
    # mode, negate, grey, alpha, cell
    ("trinary", 0, 0, None, 100),  # occ 1
    ("trinary", 0, 254, None, 0),  # occ 0.0039
    ("trinary", 0, 255, None, 0),  # occ 0
    ("trinary", 0, 205, None, -1),  # occ 0.19608, just above 0.196: the saver's unknown
    ("trinary", 0, 206, None, 0),  # occ 0.19216
    ("trinary", 0, 89, None, 100),  # occ 0.65098
    ("trinary", 0, 90, None, -1),  # occ 0.64706
    ("trinary", 0, 128, None, -1),  # occ 0.498
    ("trinary", 1, 0, None, 0),  # occ 0
    ("trinary", 1, 49, None, 0),  # occ 0.19216
    ("trinary", 1, 50, None, -1),  # occ 0.19608
    ("trinary", 1, 165, None, -1),  # occ 0.64706
    ("trinary", 1, 166, None, 100),  # occ 0.65098
    ("trinary", 1, 255, None, 100),  # occ 1
    ("trinary", 0, 0, 255, 100),  # opaque
    ("trinary", 0, 0, 254, -1),  # nearly opaque is not opaque
    ("trinary", 0, 254, 0, -1),
    ("trinary", 1, 255, 128, -1),
    ("scale", 0, 0, None, 100),
    ("scale", 0, 255, None, 0),
    ("scale", 0, 89, None, 100),
    ("scale", 0, 90, None, 99),  # (0.64706 − 0.196) / 0.454 = 0.99352
    ("scale", 0, 205, None, 0),  # (0.19608 − 0.196) / 0.454 = 0.00017
    ("scale", 0, 204, None, 1),  # (0.2 − 0.196) / 0.454 = 0.00881
    ("scale", 0, 128, None, 67),  # (0.49804 − 0.196) / 0.454 = 0.66528
    ("scale", 1, 128, None, 67),  # (0.50196 − 0.196) / 0.454 = 0.67392
    ("scale", 1, 100, None, 43),  # (0.39216 − 0.196) / 0.454 = 0.43206
    ("scale", 0, 128, 255, 67),
    ("scale", 0, 128, 254, -1),
    ("raw", 0, 0, None, 0),
    ("raw", 0, 1, None, 1),
    ("raw", 0, 100, None, 100),
    ("raw", 0, 101, None, -1),
    ("raw", 0, 128, None, -1),
    ("raw", 0, 255, None, -1),
    ("raw", 1, 7, None, 7),  # negate does not count
    ("raw", 0, 7, 0, 7),  # nor does alpha
]


@pytest.mark.parametrize(("mode", "negate", "grey", "alpha", "cell"), RULE)
def test_a_pixel_becomes_the_cell_that_nav2_makes_of_it(mode, negate, grey, alpha, cell):
    see_through = encoded(Image.new("LA", (1, 1), (grey, alpha or 0)), "PNG")
    data = pgm([[grey]]) if alpha is None else see_through
    assert cells(data, mode=mode, negate=negate) == [[cell]]


THRESHOLD_RULE = [
    # A threshold that a grey meets belongs to occupied, or to free: 0.2 = 51/255, 0.6 = 153/255.
    (1, 0.2, 0.6, 51, 0),
    (1, 0.2, 0.6, 52, -1),
    (1, 0.2, 0.6, 153, 100),
    (1, 0.2, 0.6, 152, -1),
    (0, 0.0, 1.0, 255, 0),
    (0, 0.0, 1.0, 254, -1),
    (0, 0.0, 1.0, 1, -1),
    (0, 0.0, 1.0, 0, 100),
    # 153/255 = 0.6 lies just above 0.6 in float32, so 1 − it lies below 0.4; not so in float64.
    (0, 0.196, 0.4, 153, -1),
    (0, 0.196, 0.4, 152, 100),
]


@pytest.mark.parametrize(("negate", "free", "occupied", "grey", "cell"), THRESHOLD_RULE)
def test_a_grey_on_a_threshold_counts_as_beyond_it(negate, free, occupied, grey, cell):
    changes = {"negate": negate, "free_thresh": free, "occupied_thresh": occupied}
    assert cells(pgm([[grey]]), **changes) == [[cell]]


def test_colours_count_by_their_luma():
    # Luma of (255, 0, 0) is 76, of (0, 255, 0) 150, of (0, 0, 255) 29: occ 0.70, 0.41, 0.89.
    image = Image.new("RGB", (3, 1))
    image.putdata([(255, 0, 0), (0, 255, 0), (0, 0, 255)])
    assert cells(encoded(image, "PNG")) == [[100, -1, 100]]
    assert cells(encoded(image, "PPM")) == [[100, -1, 100]]


def test_a_palette_image_counts_by_its_colours_and_its_transparency():
    image = Image.new("P", (3, 1))
    image.putpalette([0, 0, 0, 254, 254, 254, 0, 0, 0])
    image.putdata([0, 1, 2])
    assert cells(encoded(image, "PNG")) == [[100, 0, 100]]
    assert cells(encoded(image, "PNG", transparency=bytes([255, 255, 0]))) == [[100, 0, -1]]
    assert cells(encoded(image, "BMP")) == [[100, 0, 100]]


@given(colours=st.lists(st.tuples(*[st.integers(0, 110)] * 3), min_size=1, max_size=9))
def test_a_colour_counts_the_same_in_a_palette(colours):
    direct, by_palette = Image.new("RGB", (len(colours), 1)), Image.new("P", (len(colours), 1))
    direct.putdata(colours)
    by_palette.putpalette([level for colour in colours for level in colour])
    by_palette.putdata(range(len(colours)))
    wanted = cells(encoded(direct, "PNG"), mode="raw")
    assert cells(encoded(by_palette, "PNG"), mode="raw") == wanted


def test_a_transparent_grey_of_a_png_is_unknown():
    image = Image.new("L", (2, 1))
    image.putdata([0, 254])
    assert cells(encoded(image, "PNG", transparency=0)) == [[-1, 0]]


@given(
    grey=arrays(np.uint8, st.tuples(st.integers(1, 17), st.integers(1, 17))),
    channels=st.sampled_from([1, 2, 3, 4]),
)
def test_an_interlaced_png_is_the_plain_one(grey, channels):
    pixels = grey if channels == 1 else np.stack([grey, grey[::-1], grey[:, ::-1], 255 - grey][:channels], 2)
    plain = encoded(Image.fromarray(pixels), "PNG")
    interlaced = interlaced_png(pixels)
    assert (plain[28], interlaced[28]) == (0, 1)  # the header's word for it
    assert cells(interlaced, mode="raw") == cells(plain, mode="raw")
    assert cells(interlaced) == cells(plain)


def test_a_black_and_white_image_is_a_map_too():
    image = Image.new("1", (2, 1))
    image.putdata([0, 255])
    assert all(cells(encoded(image, kind)) == [[100, 0]] for kind in ("PNG", "BMP", "PPM"))


@given(
    black=arrays(np.bool_, st.tuples(st.integers(1, 5), st.integers(1, 20))),
    gap=st.sampled_from([b"", b" ", b"\r\n", b"# 0\n#1\n"]),
)
def test_a_pbm_means_the_same_as_text_and_as_bits(black, gap):
    rows, columns = black.shape
    text = b"P1 #\n%d %d\n" % (columns, rows) + gap.join(b"%d" % bit for bit in black.ravel())
    bits = encoded(Image.fromarray(~black), "PPM")
    assert bits.startswith(b"P4")
    wanted = np.where(black, 100, 0)[::-1].tolist()
    assert cells(text) == cells(bits) == wanted


def test_a_pgm_whose_white_is_not_255_is_stretched():
    assert cells(pgm([[0, 1, 99, 100]], maxval=100)) == [[100, 100, 0, 0]]
    assert cells(pgm([[0, 1, 99, 100]], b"P2", maxval=100)) == [[100, 100, 0, 0]]


@pytest.mark.parametrize("maxval", [255, 100, 1])
def test_an_image_written_as_text_is_the_one_written_as_bytes(maxval):
    samples = (np.arange(24) % (maxval + 1)).astype(np.uint8)
    words = b" ".join(b"%d" % value for value in samples)
    for plain, binary, size in ((2, 5, b"6 4"), (3, 6, b"4 2")):
        text = load(b"P%d\n%s # a comment\n%d\n" % (plain, size, maxval) + words.replace(b" 5 ", b"#x\n5\t"))
        assert np.array_equal(
            text.cells, load(b"P%d\n%s\n%d\n" % (binary, size, maxval) + bytes(samples)).cells
        )


def test_comments_in_a_pgm_are_passed_over():
    data = b"P5\n# CREATOR: an editor 1 2 3\n2 # wide\n1\n#\n255\n" + bytes([0, 254])
    assert cells(data) == [[100, 0]]


def test_bytes_that_look_like_blanks_are_pixels():
    assert cells(pgm([[32, 10, 35]]), mode="raw") == [[32, 10, 35]]
