"""Map files: laws of the round trip, Nav2's rule by hand-computed examples, and bad files."""

from __future__ import annotations

import contextlib
import io
import math
import os
import struct
import tempfile
import zlib
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image

from algorithms import atomic
from algorithms.errors import InputFileError, MapMergeError, OutputError, TooLargeError
from algorithms.gridmap import GridMap
from algorithms.mapio import (
    Shading,
    image_map_from_bytes,
    map_from_bytes,
    map_to_bytes,
    read_image,
    read_map,
    write_map,
)
from algorithms.pose import Pose2

HEADER = {
    "image": "m.pgm",
    "resolution": 0.05,
    "origin": [1.0, -2.0, 0.5],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def header(**changes: object) -> bytes:
    """A map's YAML file; a value of None leaves its key out."""
    values = {**HEADER, **changes}
    return yaml.safe_dump({k: v for k, v in values.items() if v is not None}).encode()


def pgm(pixels: object, kind: bytes = b"P5", maxval: int = 255) -> bytes:
    grey = np.asarray(pixels, dtype=np.uint8)
    head = b"%s\n%d %d\n%d\n" % (kind, grey.shape[1], grey.shape[0], maxval)
    if kind == b"P2":
        return head + b" ".join(b"%d" % value for value in grey.ravel().tolist()) + b"\n"
    return head + grey.tobytes()


def encoded(image: Image.Image, kind: str, **options: object) -> bytes:
    stream = io.BytesIO()
    image.save(stream, kind, **options)
    return stream.getvalue()


def load(data: bytes, **changes: object) -> GridMap:
    return map_from_bytes("m.yaml", header(**changes), "m.pgm", data)


def cells(data: bytes, **changes: object) -> list[list[int]]:
    return load(data, **changes).cells.tolist()


finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(min_value=0, exclude_min=True, allow_nan=False, allow_infinity=False)
shapes = hnp.array_shapes(min_dims=2, max_dims=2, max_side=9)
greys = hnp.arrays(np.uint8, shapes)
any_cells = st.one_of(
    hnp.arrays(np.int8, shapes, elements=st.integers(-1, 100)),
    hnp.arrays(np.int8, shapes, elements=st.sampled_from([-1, 0, 100])),
)
grids = st.builds(GridMap, any_cells, positive, st.builds(Pose2, finite, finite, finite))


# --- laws of the round trip ---


@given(grid=grids)
def test_what_is_written_reads_back_the_same(grid):
    files = map_to_bytes(grid, "room")
    again = map_from_bytes("room.yaml", files["room.yaml"], "room.pgm", files["room.pgm"])
    assert again.cells.tolist() == grid.cells.tolist()
    assert again.resolution == grid.resolution
    assert again.origin == grid.origin
    assert again.name == "room"


@given(grid=grids)
def test_other_yaml_parsers_read_the_same_numbers(grid):
    values = yaml.safe_load(map_to_bytes(grid, "room")["room.yaml"])
    o = grid.origin
    assert values["origin"] == [o.x, o.y, o.theta]
    assert values["resolution"] == grid.resolution
    assert all(type(value) is float for value in [*values["origin"], values["resolution"]])


@settings(max_examples=20)
@given(grid=grids, stem=st.sampled_from(["map", "a b", "größe", "no", "x: y", "'", "v1.2", "#1"]))
def test_a_map_on_disk_reads_back_under_any_name(grid, stem):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "new" / f"{stem}.yaml"
        write_map(path, grid)
        for again in (read_map(path), read_map(path.with_suffix(".pgm"))):
            assert again.cells.tolist() == grid.cells.tolist()
            assert again.origin == grid.origin
            assert again.name == stem
        assert sorted(os.listdir(path.parent)) == [f"{stem}.pgm", f"{stem}.yaml"]


def test_three_classes_are_written_as_nav2_saves_them():
    grid = GridMap(np.array([[0, 100], [-1, 0]], dtype=np.int8), 0.05)
    files = map_to_bytes(grid, "m")
    assert files["m.pgm"] == b"P5\n2 2\n255\n" + bytes([205, 254, 254, 0])
    assert b"mode: trinary" in files["m.yaml"]


def test_other_values_are_written_raw():
    grid = GridMap(np.array([[0, 50, -1]], dtype=np.int8), 0.05)
    files = map_to_bytes(grid, "m")
    assert files["m.pgm"].endswith(bytes([0, 50, 255]))
    assert b"mode: raw" in files["m.yaml"]


@given(grey=greys, mode=st.sampled_from(["trinary", "scale", "raw"]), negate=st.booleans())
def test_every_format_of_the_same_pixels_loads_to_the_same_cells(grey, mode, negate):
    image = Image.fromarray(grey)
    versions = [
        encoded(image, "PNG"),
        encoded(image, "BMP"),
        encoded(image.convert("RGB"), "PNG"),
        encoded(image.convert("RGB"), "BMP"),
        encoded(image.convert("RGB"), "PPM"),
        encoded(image.convert("RGBA"), "PNG"),
        encoded(image.convert("LA"), "PNG"),
        pgm(grey, b"P2"),
    ]
    wanted = cells(pgm(grey), mode=mode, negate=int(negate))
    assert all(cells(data, mode=mode, negate=negate) == wanted for data in versions)


@given(grey=greys)
def test_negate_undoes_an_inverted_image(grey):
    # Thresholds that no grey meets exactly: 1 − v/255 and (255 − v)/255 differ in the last bit.
    thresholds = {"occupied_thresh": 0.6512, "free_thresh": 0.1987}
    assert cells(pgm(255 - grey), negate=1, **thresholds) == cells(pgm(grey), **thresholds)


@given(grey=greys, mode=st.sampled_from(["trinary", "scale", "raw"]))
def test_flipping_the_rows_of_the_image_flips_the_rows_of_cells(grey, mode):
    assert cells(pgm(grey[::-1]), mode=mode) == cells(pgm(grey), mode=mode)[::-1]


def test_the_top_row_of_the_image_is_the_last_row_of_cells():
    assert cells(pgm([[0, 0], [254, 205]])) == [[0, -1], [100, 100]]


def test_the_flip_holds_across_the_blocks_of_a_tall_image():
    column = np.resize(np.arange(101, dtype=np.uint8), (1000, 1))
    assert load(pgm(column), mode="raw").cells[:, 0].tolist() == column[::-1, 0].tolist()


def test_two_maps_of_different_resolution_keep_their_own():
    assert load(pgm([[0]]), resolution=0.05).resolution == 0.05
    assert load(pgm([[0]]), resolution=0.1).resolution == 0.1


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


def test_a_black_and_white_image_is_a_map_too():
    image = Image.new("1", (2, 1))
    image.putdata([0, 255])
    assert all(cells(encoded(image, kind)) == [[100, 0]] for kind in ("PNG", "BMP", "PPM"))


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


# --- the YAML file ---


@pytest.mark.parametrize(
    ("text", "value"), [("1e-3", 0.001), ("5E-2", 0.05), (".05", 0.05), ("'0.05'", 0.05), ("1", 1)]
)
def test_numbers_may_be_written_as_anyone_writes_them(text, value):
    data = header(resolution=None) + f"resolution: {text}\n".encode()
    assert map_from_bytes("m.yaml", data, "m.pgm", pgm([[0]])).resolution == value


@pytest.mark.parametrize(
    ("text", "cell"), [("0", 100), ("1", 0), ("false", 100), ("True", 0), ("no", 100), ("yes", 0)]
)
def test_negate_may_be_a_number_or_a_word(text, cell):
    data = header(negate=None) + f"negate: {text}\n".encode()
    assert map_from_bytes("m.yaml", data, "m.pgm", pgm([[0]])).cells.tolist() == [[cell]]


def test_the_mode_may_be_in_capitals_and_other_keys_are_passed_over():
    assert cells(pgm([[7]]), mode="Raw", elevation_image="e.pgm") == [[7]]


def test_thresholds_do_not_count_in_raw():
    assert cells(pgm([[7]]), mode="raw", free_thresh=1, occupied_thresh=0) == [[7]]


def test_yaw_and_position_of_the_origin_are_kept():
    assert load(pgm([[0]])).origin == Pose2(1.0, -2.0, 0.5)


def test_the_image_of_an_upload_is_the_one_given(tmp_path):
    (tmp_path / "other.pgm").write_bytes(pgm([[254]]))
    assert cells(pgm([[0]]), image=str(tmp_path / "other.pgm")) == [[100]]


def test_the_image_may_lie_in_another_folder(tmp_path):
    (tmp_path / "images").mkdir()
    image = tmp_path / "images" / "a.pgm"
    image.write_bytes(pgm([[0]]))
    for i, name in enumerate(("images/a.pgm", str(image))):
        (tmp_path / f"{i}.yaml").write_bytes(header(image=name))
        assert read_map(tmp_path / f"{i}.yaml").cells.tolist() == [[100]]


def test_a_plain_image_becomes_a_map_where_the_resolution_is_given(tmp_path):
    path = tmp_path / "plain.png"
    path.write_bytes(encoded(Image.new("L", (1, 1), 128), "PNG"))
    grid = read_image(path, 0.1, Pose2(1, 2, 3), Shading(mode="scale"))
    assert grid.cells.tolist() == [[67]]
    assert (grid.resolution, grid.origin, grid.name) == (0.1, Pose2(1, 2, 3), "plain")
    upload = image_map_from_bytes("plain.png", path.read_bytes(), 0.1)
    assert upload.cells.tolist() == [[-1]]
    assert upload.name == "plain"


def test_an_image_without_its_yaml_is_refused_with_the_ways_out(tmp_path):
    (tmp_path / "plain.png").write_bytes(encoded(Image.new("L", (1, 1)), "PNG"))
    with pytest.raises(InputFileError, match=r"plain.yaml beside it.*resolution"):
        read_map(tmp_path / "plain.png")


# --- bad files ---


def chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png_header(width: int, height: int, bits: int = 8, colour: int = 0) -> bytes:
    body = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", body)


GOOD_PNG = encoded(Image.effect_noise((64, 64), 50), "PNG")
SIXTEEN_BIT_RGB = png_header(1, 1, 16, 2) + chunk(b"IDAT", zlib.compress(bytes(7))) + chunk(b"IEND", b"")

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
    "image empty": (header(image=""), "image is empty"),
    "image a list": (header(image=["m.pgm"]), "image is"),
    "resolution 0": (header(resolution=0), "positive"),
    "resolution negative": (header(resolution=-0.05), "positive"),
    "resolution a word": (header(resolution="fine"), "resolution is 'fine'"),
    "resolution with unit": (header(resolution="0.05 m"), "resolution"),
    "resolution NaN": (header(resolution=math.nan), "resolution is '.nan', not a finite number"),
    "resolution infinite": (header(resolution=math.inf), "not a finite number"),
    "resolution huge": (header(resolution=None) + b"resolution: 1e999", "not a finite number"),
    "resolution null": (header(resolution=None) + b"resolution:\n", "resolution is empty"),
    "resolution a list": (header(resolution=[1]), "resolution"),
    "origin short": (header(origin=[0, 0]), "origin is [0, 0], not 3"),
    "origin long": (header(origin=[0, 0, 0, 0]), "not 3 finite numbers"),
    "origin a number": (header(origin=0), "origin"),
    "origin NaN": (header(origin=[0, 0, math.nan]), "origin"),
    "origin of words": (header(origin=["a", "b", "c"]), "origin is [a, b, c]"),
    "origin nested": (header(origin=[[0], 0, 0]), "origin"),
    "negate a word": (header(negate="maybe"), "negate is 'maybe'"),
    "negate a fraction": (header(negate=0.5), "negate"),
    "mode unknown": (header(mode="ternary"), "trinary, scale, raw"),
    "mode a number": (header(mode=3), "mode is '3'"),
    "threshold NaN": (header(occupied_thresh=math.nan), "occupied_thresh"),
    "threshold above 1": (header(occupied_thresh=65), "[0, 1]"),
    "threshold below 0": (header(free_thresh=-0.1), "[0, 1]"),
    "thresholds swapped": (header(occupied_thresh=0.196, free_thresh=0.65), "smaller"),
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


BAD_IMAGE = {
    "empty": (b"", "is empty"),
    "text": (b"hello, world", "not a PGM, PPM, PNG or BMP"),
    "JPEG": (encoded(Image.new("L", (8, 8)), "JPEG"), "not a PGM, PPM, PNG or BMP"),
    "GIF": (encoded(Image.new("L", (8, 8)), "GIF"), "not a PGM, PPM, PNG or BMP"),
    "TIFF": (encoded(Image.new("CMYK", (8, 8)), "TIFF"), "not a PGM, PPM, PNG or BMP"),
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
    "PPM cut": (b"P6\n9 9\n255\n" + bytes(9), "cut off: 9 x 9"),
    "PFM": (b"Pf\n1 1\n-1.0\n" + bytes(4), "not a PGM"),
    "PNG 16 bit": (encoded(Image.new("I;16", (2, 2)), "PNG"), "16 bits"),
    "PNG 16 bit colour": (SIXTEEN_BIT_RGB, "16 bits"),
    "PNG cut": (GOOD_PNG[: len(GOOD_PNG) // 2], "decoded"),
    "PNG head only": (GOOD_PNG[:8], "decoded"),
    "PNG damaged": (GOOD_PNG[:60] + bytes(40) + GOOD_PNG[100:], "decoded"),
    "PNG without width": (png_header(0, 5), "m.png"),
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


HUGE = {
    "PGM": b"P5\n20000 20000\n255\n",
    "ASCII PGM": b"P2\n20000 20000\n255\n",
    "PNG": png_header(20000, 20000) + chunk(b"IDAT", b"") + chunk(b"IEND", b""),
    "PNG at its format's limit": png_header(2**31 - 1, 2**31 - 1) + chunk(b"IDAT", b""),
    "BMP": b"BM"
    + struct.pack("<IHHI", 54, 0, 0, 54)
    + struct.pack("<IiiHHIIiiII", 40, 20000, 20000, 1, 24, 0, 0, 0, 0, 0, 0),
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


# --- whole files or none ---


@pytest.fixture
def grid() -> GridMap:
    return GridMap(np.array([[0, 100, -1]], dtype=np.int8), 0.05)


@pytest.mark.parametrize("broken", ["fsync", "replace"])
def test_a_failing_write_leaves_the_old_files_whole(tmp_path, monkeypatch, grid, broken):
    write_map(tmp_path / "m.yaml", grid)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic.os, broken, fail)
    with pytest.raises(OutputError, match=r"m\.pgm.*No space left on device.*; .*disk"):
        write_map(tmp_path / "m.yaml", GridMap(np.zeros((9, 9), dtype=np.int8), 0.1))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_full_disk_at_the_second_file_leaves_the_first_as_it_was(tmp_path, monkeypatch):
    first, second = tmp_path / "first", tmp_path / "second"
    first.write_bytes(b"old")
    calls = []

    def fail_at_second(_: int) -> None:
        calls.append(1)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic.os, "fsync", fail_at_second)
    with pytest.raises(OutputError, match="second"):
        atomic.write_files({first: b"new", second: b"new"})
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("first", b"old")]


def test_a_place_that_cannot_be_written_is_named(tmp_path, grid):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match="file"):
        write_map(tmp_path / "file" / "m.yaml", grid)
    (tmp_path / "m.yaml").mkdir()
    with pytest.raises(OutputError, match=r"m\.yaml.*folder"):
        write_map(tmp_path / "m.yaml", grid)
    with pytest.raises(OutputError, match=r"end in \.yaml"):
        write_map(tmp_path / "m.pgm", grid)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "m.yaml"]


def test_a_link_is_written_through(tmp_path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    atomic.write_file(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_a_written_file_may_be_read_by_whom_the_system_lets(tmp_path):
    (tmp_path / "plain").write_bytes(b"")
    atomic.write_file(tmp_path / "ours", b"")
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "plain").stat().st_mode
