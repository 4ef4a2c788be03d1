"""Where a fleet's maps lie in the scene: as they were placed, groups apart from each other."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from app.drawing.fleet_layout import lay_out_fleet
from app.drawing.scene_layout import known_corners

POSES = st.builds(Pose2, st.floats(-30, 30), st.floats(-30, 30), st.floats(-3, 3))


def room(high: int, wide: int) -> GridMap:
    return GridMap(np.zeros((high, wide), dtype=np.int8), 0.05, Pose2(3.0, -2.0, 0.4))


@st.composite
def grouped(draw):
    """Maps by name, and groups of them."""
    sizes = draw(st.lists(st.tuples(st.integers(20, 200), st.integers(20, 200)), min_size=2, max_size=9))
    maps = {f"r{k}": room(*size) for k, size in enumerate(sizes)}
    cut = draw(st.integers(1, len(maps)))
    names = list(maps)
    first = {name: Pose2() if name == "r0" else draw(POSES) for name in names[:cut]}
    return maps, [first, *({name: Pose2()} for name in names[cut:])]


@given(grouped())
def test_robots_of_a_group_lie_as_they_were_placed_and_its_first_map_has_its_middle_at_zero(drawn):
    maps, groups = drawn
    layout = lay_out_fleet(maps, groups)
    assert np.allclose(layout.at("r0").array()[:2], 0, atol=1e-9)
    for group in groups:
        root = next(iter(group))
        for name, T in group.items():
            between = layout.poses[root].inverse() @ layout.poses[name]
            assert np.allclose(between.array(), (group[root].inverse() @ T).array(), atol=1e-6)


@given(grouped())
def test_groups_lie_apart_and_all_maps_in_their_boxes(drawn):
    maps, groups = drawn
    layout = lay_out_fleet(maps, groups)
    for a, b in combinations(layout.boxes, 2):
        assert a[2] < b[0] or b[2] < a[0] or a[3] < b[1] or b[3] < a[1]
    for group, (x0, y0, x1, y1) in zip(groups, layout.boxes, strict=True):
        for name in group:
            low, high = (
                edge(layout.poses[name].apply(known_corners(maps[name])), axis=0) for edge in (np.min, np.max)
            )
            assert np.all(low >= np.array([x0, y0]) - 1e-6)
            assert np.all(high <= np.array([x1, y1]) + 1e-6)
