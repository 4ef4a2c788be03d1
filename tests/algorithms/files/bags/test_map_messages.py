"""Maps in recordings: the same map as from files, updates, the choice of a topic, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bags import KINDS, grid_message, update_message, write_bag
from drawn import drawn_map, poses
from hypothesis import HealthCheck, given, settings

from algorithms.common.errors import InputFileError, MapMergeError
from algorithms.common.pose import Pose2
from algorithms.files.map_file import read_map, write_map
from algorithms.maps.grid_map import UNKNOWN, GridMap

DRAWN = drawn_map(Pose2(3.0, -2.0, 0.4), resolution=0.1, origin_yaw=0.3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_map_from_a_recording_is_the_map_from_its_files(tmp_path, kind):
    write_map(tmp_path / "map.yaml", DRAWN)
    path = write_bag(tmp_path, "robot1", kind, [grid_message(DRAWN, 0.0)])
    a, b = read_map(tmp_path / "map.yaml"), read_map(path)
    assert np.array_equal(a.cells, b.cells)
    assert a.resolution == b.resolution  # though a message holds 0.1 as 0.100000001
    assert np.allclose(a.origin.array(), b.origin.array(), rtol=0, atol=1e-12)
    assert b.name == "robot1"


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(origin=poses)
def test_any_origin_comes_through(tmp_path_factory, origin):
    grid = replace(DRAWN, origin=origin)
    path = write_bag(tmp_path_factory.mktemp("bag"), "a", "ros1", [grid_message(grid, 0.0)])
    back = read_map(path).origin
    assert np.allclose(back.apply(np.eye(2)), origin.apply(np.eye(2)), rtol=0, atol=1e-9)


def test_the_last_map_counts_or_the_one_at_a_time_each_with_the_updates_until_then(tmp_path):
    older = GridMap(np.zeros((6, 8), np.int8), 0.05)
    newer = GridMap(np.full((6, 8), 100, np.int8), 0.05)
    wall, part = np.full((2, 3), 100, np.int8), np.full((1, 1), UNKNOWN, np.int8)
    path = write_bag(
        tmp_path,
        "bag",
        "mcap",
        [
            grid_message(older, 1.0),
            update_message(wall, 5, 4, 2.0),
            update_message(part, 0, 0, 3.0),
            grid_message(newer, 4.0),
        ],
    )
    assert np.array_equal(read_map(path).cells, newer.cells)
    assert np.array_equal(read_map(f"{path}@0.5").cells, older.cells)
    walled = older.cells.copy()
    walled[4:6, 5:8] = 100
    assert np.array_equal(read_map(f"{path}@1.5").cells, walled)
    walled[0, 0] = UNKNOWN
    assert np.array_equal(read_map(f"{path}#/map@2.9").cells, walled)


def test_where_there_are_several_maps_the_one_of_walls_is_taken_or_a_choice_asked_for(tmp_path):
    maps = {name: GridMap(np.full((3, 3), k, np.int8), 0.05) for k, name in enumerate(("/a/map", "/b/map"))}
    costs = GridMap(np.full((3, 3), 99, np.int8), 0.05)
    messages = [grid_message(grid, 0.0, topic) for topic, grid in maps.items()]
    both = write_bag(tmp_path, "both", "db3", messages)
    for topic, grid in maps.items():
        assert np.array_equal(read_map(f"{both}#{topic}").cells, grid.cells)
    with pytest.raises(InputFileError, match=r"/a/map, /b/map; say which one, as both#/a/map"):
        read_map(both)
    with pytest.raises(InputFileError, match="its maps are on /a/map, /b/map"):
        read_map(f"{both}#/map")
    one = write_bag(tmp_path, "one", "db3", [messages[0], grid_message(costs, 0.0, "/local_costmap/costmap")])
    found = read_map(one)
    assert np.array_equal(found.cells, maps["/a/map"].cells)
    assert "/a/map was taken, not /local_costmap/costmap" in found.remarks[0]


def spoilt(**fields):
    """A map's message with other fields."""
    message = grid_message(DRAWN, 0.0)
    info = {**message.fields["info"], **fields.pop("info", {})}
    return replace(message, fields={**message.fields, "info": info, **fields})


@pytest.mark.parametrize(
    ("message", "found"),
    [
        (spoilt(info={"width": 0}), "0 × "),
        (spoilt(info={"width": 10**5, "height": 10**5}), "the limit is"),
        (spoilt(data=np.zeros(7, np.int8)), "and has 7"),
        (spoilt(data=np.full(DRAWN.cells.size, -7, np.int8)), "a cell of -7"),
        (spoilt(data=np.full(DRAWN.cells.size, 120, np.int8)), "a cell of 120"),
        (spoilt(info={"resolution": 0.0}), "resolution is 0 m"),
        (spoilt(info={"resolution": float("nan")}), "resolution is nan m"),
        (spoilt(info={"origin": {"position": {"x": float("nan")}}}), "its origin is"),
        (spoilt(info={"origin": {"position": {"x": 1e9}}}), "its origin is"),
        (spoilt(info={"origin": {"orientation": {"x": 0.7, "w": 0.7}}}), "tilted"),
        (spoilt(info={"origin": {"orientation": {"z": float("inf")}}}), "not finite"),
    ],
)
def test_a_message_that_is_no_map_is_refused(tmp_path, message, found):
    path = write_bag(tmp_path, "bag", "ros1", [message])
    with pytest.raises(MapMergeError, match=found):
        read_map(path)


def test_an_update_outside_its_map_and_a_time_before_the_first_map_are_refused(tmp_path):
    late = update_message(np.zeros((2, 2), np.int8), DRAWN.width - 1, 0, 2.0)
    path = write_bag(tmp_path, "bag", "ros1", [grid_message(DRAWN, 1.0), late])
    assert read_map(f"{path}@0.5").width == DRAWN.width
    with pytest.raises(InputFileError, match="outside of the map"):
        read_map(path)
    path = write_bag(
        tmp_path, "later", "ros1", [update_message(DRAWN.cells, 0, 0, 0.0), grid_message(DRAWN, 1.0)]
    )
    with pytest.raises(InputFileError, match=r"no map on /map by then, its first one at 1\.000 s"):
        read_map(f"{path}@0.5")


def test_a_recording_without_a_map_says_how_to_come_by_one(tmp_path):
    path = write_bag(tmp_path, "bag", "ros1", [update_message(DRAWN.cells, 0, 0, 0.0)])
    with pytest.raises(InputFileError, match=r"bag .* holds no map; record a map topic"):
        read_map(path)
