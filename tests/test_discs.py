"""Near a wall, asked around the walls alone: the same as asking every cell for its distance."""

from __future__ import annotations

import numpy as np
from drawn import small_maps
from hypothesis import given
from hypothesis import strategies as st

from algorithms.maps.wall_distance import distances, near
from algorithms.optimisation.likelihood_field import distance_to_walls


@given(small_maps(side=60), st.floats(0, 9))
def test_near_is_what_the_distances_say(grid, cells):
    reach = int(np.ceil(cells)) + 1
    expected = distance_to_walls(grid.occupied) <= np.float32(cells)
    assert np.array_equal(near(grid.occupied, distances(reach) <= np.float32(cells)), expected)


def test_without_walls_nothing_is_near_one():
    nothing = np.zeros((4, 5), dtype=bool)
    assert not near(nothing, distances(3) <= 3).any()
