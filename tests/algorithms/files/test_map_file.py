"""Map files: laws of the round trip, and what their YAML file may say."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from mapfiles import cells, encoded, header, image_map_from_bytes, load, pgm
from PIL import Image

from algorithms.common.errors import InputFileError
from algorithms.common.pose import Pose2
from algorithms.files.images.thresholds import Shading
from algorithms.files.map_file import (
    map_from_bytes,
    map_to_bytes,
    read_image,
    read_map,
    write_map,
)
from algorithms.maps.grid_map import COARSEST, FARTHEST, FINEST, MOST_TURN, GridMap

places, turns = st.floats(-FARTHEST, FARTHEST), st.floats(-MOST_TURN, MOST_TURN)
origins = st.builds(Pose2, places, places, turns)
shapes = hnp.array_shapes(min_dims=2, max_dims=2, max_side=9)
greys = hnp.arrays(np.uint8, shapes)
any_cells = st.one_of(
    hnp.arrays(np.int8, shapes, elements=st.integers(-1, 100)),
    hnp.arrays(np.int8, shapes, elements=st.sampled_from([-1, 0, 100])),
)
grids = st.builds(GridMap, any_cells, st.floats(FINEST, COARSEST), origins)


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
    # Thresholds that no grey meets exactly: 1 − v/255 and (255 − v)/255 differ in the last bit. And without
    # the savers' own grey for unknown, which is told by itself, whatever the thresholds say.
    grey = np.where((grey == 205) | (grey == 50), 100, grey).astype(np.uint8)
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
