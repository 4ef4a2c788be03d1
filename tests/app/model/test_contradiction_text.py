"""The list of contradictions in words, its rings on the map, and their picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.verdict.contradictions import Contradiction, Contradictions, find_conflicts
from app.drawing import grid_pixels as render
from app.drawing.palette import DARK, LIGHT
from app.drawing.scene.map_comparison import rings
from app.model.contradiction_text import MOST_PLACES, summary, whose
from app.page.panels.result_panel import places_html

NOTHING = Contradictions(np.zeros((2, 2), bool), np.zeros((2, 2), bool), (), 0.0)
WALL = Contradiction(1.0, -2.0, 0.5, 3.0, 0.0)


def test_the_summary_counts_places_and_wall_and_says_where_there_is_none():
    assert summary(NOTHING) == "No wall of one map lies in the other's free floor."
    assert summary(replace(NOTHING, small_parts=0.4)).startswith("0.4 m of wall contradict, in specks")
    one = replace(NOTHING, places=(WALL,), small_parts=0.5)
    assert summary(one).startswith("3.5 m of wall contradict: one place, and 0.5 m in smaller patches.")
    assert "smaller" not in summary(replace(one, small_parts=0.0))


def test_only_the_largest_places_are_listed_and_ringed_and_the_rest_is_told_in_sum():
    many = replace(NOTHING, places=(WALL,) * (MOST_PLACES + 2))
    page = places_html(many)
    assert page.count("data-mm-place") == len(rings(many.places, np.zeros(2))) == MOST_PLACES
    assert f"{MOST_PLACES + 2} places, and 6.0 m in smaller patches" in page
    assert "x 1.0, y −2.0" in page


def test_a_ring_stands_in_the_scene_whose_zero_is_the_anchor():
    (ring,) = rings((WALL,), np.array([10.0, 20.0]))
    assert ring == {"n": 1, "at": [-9.0, -22.0], "r": 0.5}


def test_a_list_that_is_out_of_date_can_be_read_and_not_pressed():
    page = places_html(replace(NOTHING, places=(WALL,)), faded=True)
    assert "opacity:.4" in page
    assert "disabled" in page


@pytest.mark.parametrize(
    ("ref_wall", "mov_wall", "told"),
    [(3.0, 0.1, "map 1's wall"), (0.1, 3.0, "map 2's wall"), (1.0, 1.2, "both maps' wall")],
)
def test_it_is_told_whose_wall_the_other_map_denies(ref_wall, mov_wall, told):
    assert whose(replace(WALL, ref_wall=ref_wall, mov_wall=mov_wall)) == told


@pytest.mark.parametrize("palette", [LIGHT, DARK])
def test_only_denied_walls_stand_out_in_the_colour_of_their_map(palette):
    cells = np.full((40, 60), FREE, dtype=np.int8)
    cells[0, :] = OCCUPIED
    ref, mov = cells.copy(), cells.copy()
    ref[20, 5:15], mov[30, 40:50] = OCCUPIED, OCCUPIED
    fusion = fuse((GridMap(ref, 0.1), GridMap(mov, 0.1)), (Pose2(), Pose2()))
    pixels = render.denied_walls(fusion, find_conflicts(fusion), palette).pixels
    assert (pixels[20, 5:15] == (*palette.ref, 255)).all()
    assert (pixels[30, 40:50] == (*palette.mov, 255)).all()
    assert (pixels[0, :, 3] == render.FAINT).all()
    assert np.count_nonzero(pixels[..., 3]) == 80
