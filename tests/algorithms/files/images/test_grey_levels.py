"""What a person is told of how a map's greys were read: unknown read as free, no wall read, and the like."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import numpy as np
import pytest
from drawn import drawn_map
from hypothesis import given
from hypothesis import strategies as st
from mapfiles import image_map_from_bytes
from PIL import Image

from algorithms.common.pose import Pose2
from algorithms.files.images.grey_levels import corrected, count_greys, remarks
from algorithms.files.images.thresholds import Shading, cells_of
from algorithms.files.map_file import map_from_bytes, map_to_bytes, read_map
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN

FLAT = drawn_map(Pose2())
NAV2 = Shading(free_thresh=0.25)


def greys(wall: int = 0, free: int = 254, unknown: int = 205) -> np.ndarray:
    """The flat's image, row 0 at the top, in these greys."""
    out = np.full(FLAT.cells.shape, unknown, dtype=np.uint8)
    out[FLAT.cells == FREE] = free
    out[FLAT.cells == OCCUPIED] = wall
    return out[::-1]


def read(image: np.ndarray, shading: Shading = Shading()):  # noqa: B008
    stream = io.BytesIO()
    Image.fromarray(image).save(stream, "PNG")
    return image_map_from_bytes("flat.png", stream.getvalue(), 0.05, shading=shading)


def test_a_map_as_our_own_writer_leaves_it_needs_no_remark():
    files = map_to_bytes(FLAT, "flat")
    grid = map_from_bytes("flat.yaml", files["flat.yaml"], "flat.pgm", files["flat.pgm"])
    assert grid.remarks == ()


def test_the_savers_unknown_is_read_as_unknown_whatever_free_thresh_says_and_that_is_told():
    grid = read(greys(), NAV2)
    assert np.array_equal(grid.cells, FLAT.cells)
    (told,) = grid.remarks
    assert "grey 205" in told
    assert f"{np.mean(FLAT.cells == UNKNOWN):.0%} of its cells" in told
    assert "free_thresh: 0.196" in told


def test_greys_that_are_not_the_savers_alone_are_read_by_the_letter():
    image = greys().copy()
    image[0, 0] = 100
    grid = read(image, NAV2)
    assert (grid.cells == FREE).sum() > (FLAT.cells == FREE).sum()
    assert "a third grey, 205" in grid.remarks[0]


@pytest.mark.parametrize(("grey", "threshold"), [(216, "0.15"), (210, "0.17"), (230, "0.09")])
def test_a_third_grey_that_is_read_as_free_is_told_with_a_threshold_that_cures_it(grey, threshold):
    grid = read(greys(unknown=grey))
    (told,) = grid.remarks
    assert f"a third grey, {grey}," in told
    assert f"free_thresh: {threshold}" in told
    assert f"--unknown-grey {grey}" in told
    cured = read(greys(unknown=grey), Shading(free_thresh=float(threshold)))
    assert np.array_equal(cured.cells, FLAT.cells)
    assert cured.remarks == ()
    flagged = read(greys(unknown=grey), Shading(unknown_grey=grey))
    assert np.array_equal(flagged.cells, FLAT.cells)


def test_an_image_without_unknown_cells_is_told_that_its_floor_says_nothing():
    (told,) = read(greys(unknown=254)).remarks
    assert "none of its cells is unknown" in told


def test_a_closed_hall_that_was_seen_whole_may_have_no_unknown_cell():
    cells = np.full((60, 80), 254, dtype=np.uint8)
    cells[0] = cells[-1] = 0
    cells[:, 0] = cells[:, -1] = 0
    assert read(cells).remarks == ()


def test_a_raw_map_of_the_savers_greys_is_read_as_trinary_and_that_is_told():
    grid = read(greys(), Shading(mode="raw"))
    assert np.array_equal(grid.cells, FLAT.cells)
    assert "mode raw" in grid.remarks[0]


def test_a_raw_map_of_other_large_greys_is_told_that_none_of_it_is_wall():
    (told,) = read(greys(wall=10, free=250, unknown=180), Shading(mode="raw")).remarks
    assert "no cell of it is a wall" in told
    assert "mode: trinary" in told


def between(low: float, high: float, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.rint(255 * (1 - rng.uniform(low, high, FLAT.cells.shape)))[::-1]


def probabilities(wall: tuple[float, float], floor: tuple[float, float], unknown: int) -> np.ndarray:
    """The flat as a SLAM system writes it that tells probabilities."""
    image, upright = greys(unknown=unknown).astype(float), FLAT.cells[::-1]
    image[upright == OCCUPIED] = between(*wall, 1)[upright == OCCUPIED]
    image[upright == FREE] = between(*floor, 2)[upright == FREE]
    return image.astype(np.uint8)


def test_greys_between_the_thresholds_are_told_with_thresholds_that_cure_them():
    image = probabilities((0.55, 0.64), (0.2, 0.44), 127)
    (told,) = read(image).remarks
    assert "no cell of it is a wall or free floor" in told
    found = re.search(r"Set occupied_thresh: ([0-9.]+) and free_thresh: ([0-9.]+)", told)
    assert found is not None
    cured = read(image, Shading(occupied_thresh=float(found[1]), free_thresh=float(found[2])))
    assert np.array_equal(cured.occupied, FLAT.occupied)
    assert np.array_equal(cured.free, FLAT.free)
    assert cured.remarks == ()


def test_walls_that_scale_takes_for_half_free_are_told_to_be_none():
    (told,) = read(probabilities((0.4, 0.48), (0.0, 0.1), 170), Shading(mode="scale")).remarks
    assert "no cell of it is a wall" in told
    assert "in mode scale a wall is 65 %" in told


def test_an_empty_map_is_told_to_be_one():
    (told,) = read(np.full((50, 60), 205, dtype=np.uint8)).remarks
    assert "no cell of it is known: all 3,000 are unknown" in told


def test_a_map_without_floor_is_told_so():
    (told,) = read(greys(free=205)).remarks
    assert "no cell of it is free floor" in told


@pytest.mark.parametrize(
    ("seen", "missing"), [({"free": 254}, "a wall"), ({"wall": 0}, "free floor")], ids=["floor", "walls"]
)
def test_a_savers_map_on_which_something_is_not_seen_yet_keeps_its_unknown(seen, missing):
    (told,) = read(greys(**({"wall": 205, "free": 205} | seen))).remarks
    assert told.startswith(f"no cell of it is {missing} yet")
    assert "thresh" not in told
    grid = read(greys(**({"wall": 205, "free": 205} | seen)), NAV2)
    assert np.array_equal(grid.cells == UNKNOWN, greys(**({"wall": 205, "free": 205} | seen))[::-1] == 205)


def test_two_greys_that_are_nearly_one_are_one_floor():
    image = greys().copy()
    rows, cols = np.nonzero(image == 254)
    image[rows[::2], cols[::2]] = 255
    assert read(image).remarks == ()


def test_a_negative_is_told_to_be_one():
    (told,) = read(255 - greys(unknown=0)).remarks
    assert "negate: 1" in told
    assert read(255 - greys(free=255, unknown=100), Shading(negate=True, occupied_thresh=0.65)).remarks == ()


def test_remarks_travel_with_the_map(tmp_path):
    import pickle

    grid = read(greys(unknown=216))
    assert pickle.loads(pickle.dumps(grid)).remarks == grid.remarks
    assert grid.mirrored().remarks == grid.remarks
    files = map_to_bytes(FLAT, "flat")
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    assert read_map(tmp_path / "flat.yaml", unknown_grey=254).remarks != ()


images = st.builds(
    lambda seed, few, shape: np.random.default_rng(seed).choice(few, shape).astype(np.uint8),
    st.integers(0, 2**32 - 1),
    st.lists(st.integers(0, 255), min_size=1, max_size=9),
    st.tuples(st.integers(1, 20), st.integers(1, 20)),
)
shadings = st.builds(
    lambda negate, low, step, mode: Shading(negate, min(1.0, low + step), low, mode),
    st.booleans(),
    st.floats(0, 0.9),
    st.floats(0.01, 0.5),
    st.sampled_from(["trinary", "scale", "raw"]),
)


@given(images, shadings, st.booleans())
def test_whatever_is_read_the_remarks_are_clauses_and_the_reading_changes_only_the_savers_greys(
    image, shading, with_alpha
):
    alpha = np.full(image.shape, 255, dtype=np.uint8) if with_alpha else None
    counts = count_greys(image, alpha)
    assert counts.sum() == image.size
    meant, said = corrected(shading, counts)
    assert (meant == shading) == (said == "")
    if not {205} < set(np.unique(image).tolist()) <= {0, 205, 254}:
        assert meant == shading
    for told in remarks(meant, counts, cells_of(image, alpha, meant)):
        assert told[0].islower() or told[0].isdigit()
        assert not told.endswith(".")


def test_a_grey_that_is_named_unknown_is_unknown_in_every_mode():
    for mode in ("trinary", "scale", "raw"):
        table = replace(Shading(mode=mode), unknown_grey=50).table()
        assert table[50] == UNKNOWN
