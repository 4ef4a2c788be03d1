"""Near a wall, asked around the walls alone: the same as asking every cell for its distance."""

from __future__ import annotations

import cv2
import numpy as np
from drawn import small_maps
from hypothesis import given
from hypothesis import strategies as st

from algorithms.maps.wall_distance import distance_to_walls, distances, is_near_wall


@given(small_maps(side=60), st.floats(0, 9))
def test_near_is_what_the_distances_say(grid, cells):
    reach = int(np.ceil(cells)) + 1
    expected = distance_to_walls(grid.occupied) <= np.float32(cells)
    assert np.array_equal(is_near_wall(grid.occupied, distances(reach) <= np.float32(cells)), expected)


@given(small_maps(side=60), st.integers(2, 4))
def test_a_distance_is_the_same_to_its_last_digit_on_any_number_of_threads(grid, threads):
    usual = cv2.getNumThreads()
    try:
        cv2.setNumThreads(1)
        alone = distance_to_walls(grid.occupied)
        cv2.setNumThreads(threads)
        assert np.array_equal(distance_to_walls(grid.occupied), alone)
    finally:
        cv2.setNumThreads(usual)


def test_without_walls_nothing_is_near_one():
    nothing = np.zeros((4, 5), dtype=bool)
    assert not is_near_wall(nothing, distances(3) <= 3).any()
