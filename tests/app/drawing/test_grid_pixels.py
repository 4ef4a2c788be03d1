"""Pictures: the right way up, walls never lost, whose wall is whose."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.spectra.augmented_map import augment
from algorithms.verdict.contradictions import find_conflicts, near_walls
from app.drawing import grid_pixels as render
from app.drawing.palette import DARK, LIGHT, level_colours


def l_shaped(rows: int = 12, cols: int = 20) -> GridMap:
    """A wall along the left edge and along the bottom: an L as a person reads it."""
    cells = np.full((rows, cols), FREE, dtype=np.int8)
    cells[:, 0] = OCCUPIED
    cells[0, :] = OCCUPIED
    cells[-1, -1] = UNKNOWN
    return GridMap(cells, 0.1)


def test_a_scene_picture_has_the_bottom_row_first_and_a_screen_picture_the_top_row():
    picture = render.walls(l_shaped().cells, LIGHT.ref).pixels
    assert (picture[0, :, 3] == 255).all()  # the foot of the L
    assert (picture[-1, 1:, 3] == 0).all()
    assert (render.upright(picture)[-1, :, 3] == 255).all()
    assert (picture[:, 0, 3] == 255).all()  # its stem, at the left in both


def test_walls_have_one_colour_and_everything_else_is_transparent():
    picture = render.walls(l_shaped().cells, LIGHT.mov).pixels
    assert set(map(tuple, picture[..., :3].reshape(-1, 3))) == {LIGHT.mov}
    assert set(np.unique(picture[..., 3])) == {0, 255}


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_the_floor_is_transparent_only_where_nothing_is_known(palette):
    picture = render.floor(l_shaped().cells, palette).pixels
    assert picture[-1, -1, 3] == 0
    assert (picture[..., 3] == 0).sum() == 1
    assert tuple(picture[5, 5, :3]) == palette.free


def test_a_huge_map_is_sent_at_a_bounded_size_and_keeps_its_thinnest_wall():
    cells = np.full((4000, 3000), FREE, dtype=np.int8)
    cells[:, 1501] = OCCUPIED
    picture = render.walls(cells, LIGHT.ref)
    assert max(picture.pixels.shape) <= render.MOST_PIXELS
    assert picture.pooled == 2
    assert (picture.pixels[:, 1501 // picture.pooled, 3] == 255).all()


def test_pooling_lets_walls_win_over_free_and_free_over_unknown():
    cells = np.array([[UNKNOWN, FREE, UNKNOWN, UNKNOWN, UNKNOWN]], dtype=np.int8)
    assert render.pool(cells, 2).tolist() == [[FREE, UNKNOWN, UNKNOWN]]
    cells = np.array([[OCCUPIED, FREE]], dtype=np.int8)
    assert render.pool(cells, 2).tolist() == [[OCCUPIED]]


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_walls_stand_out_from_the_floor_the_more_the_higher_their_level_and_far_ones_stay_faint(palette):
    room = l_shaped(80, 120)
    lifted = augment(room, np.array([0.05, 0.05]), np.eye(2) * 0.3**2, 100.0)
    picture = render.levels(lifted, palette).pixels
    assert picture[0, -1, 3] < 100
    assert picture[40, 60, 3] == 0
    contrasts = contrast(level_colours(np.linspace(0, 1, 256), palette.dark), palette.free)
    assert contrasts.min() >= 3
    assert np.diff(contrasts).min() > -0.1
    assert contrast(picture[0, 0, :3], palette.free) == pytest.approx(contrasts.max(), rel=0.02)  # on x̂


def contrast(colours, floor):
    """(…,) of (…, 3) colours with another, as WCAG measures it."""
    first, second = (
        np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722]
        for c in (np.asarray(colours) / 255, np.asarray(floor) / 255)
    )
    return (np.maximum(first, second) + 0.05) / (np.minimum(first, second) + 0.05)


def test_a_merged_map_shows_agreement_and_contradiction_in_their_own_colours():
    left, right = l_shaped(), l_shaped()
    changed = right.cells.copy()
    changed[0, 2:11] = FREE  # one map's wall, the other's free floor
    merged = fuse((left, GridMap(changed, 0.1)), (Pose2(), Pose2()))
    picture = render.merged_walls(merged, near_walls(merged), LIGHT).pixels
    assert tuple(picture[0, 10]) == (*LIGHT.agreed, 255)
    assert tuple(picture[0, 6]) == (*LIGHT.conflict, 255)
    assert picture[5, 5, 3] == 0


def test_walls_that_one_map_alone_knows_keep_that_maps_colour():
    left = l_shaped()
    beside = fuse((left, left), (Pose2(), Pose2(5.0, 0.0, 0.0)))
    picture = render.merged_walls(beside, near_walls(beside), LIGHT).pixels
    assert tuple(picture[0, 3, :3]) == LIGHT.ref
    assert tuple(picture[0, -3, :3]) == LIGHT.mov


@given(st.integers(0, 5), st.integers(-3, 3), st.floats(-0.2, 0.2))
def test_what_is_drawn_as_contradicting_is_what_is_counted_cell_for_cell(seed, shift, turn):
    rng = np.random.default_rng(seed)  # few walls: most would be near one of the other map
    one, other = (
        GridMap(rng.choice([UNKNOWN, FREE, OCCUPIED], (40, 50), p=[0.2, 0.78, 0.02]).astype(np.int8), 0.1)
        for _ in range(2)
    )
    fusion = fuse((one, other), (Pose2(), Pose2(0.1 * shift, 0.1, turn)))
    counted = find_conflicts(fusion)
    picture = render.merged_walls(fusion, near_walls(fusion), LIGHT).pixels
    drawn = (picture[..., :3] == LIGHT.conflict).all(axis=2) & (picture[..., 3] > 0)
    assert drawn.any()
    assert np.array_equal(drawn, counted.ref_only | counted.mov_only)
