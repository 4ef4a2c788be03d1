"""Messages within this process: as of any link."""

from __future__ import annotations

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from app.live.message_fields import grid_message, transforms_message
from app.live.ros_link import TF, Topic, map_topic
from app.live.watch.inner_link import InnerLink

ROOM = GridMap(np.array([[0, 100, -1], [50, 0, 0]], dtype=np.int8), 0.05, Pose2(1.0, 2.0, 0.5))
MAP, MOVES = map_topic("/r1/map"), Topic("/tf", TF)


def test_who_comes_late_is_sent_the_last_map_and_no_transform():
    link = InnerLink()
    maps, moves = link.advertise(MAP), link.advertise(MOVES)
    maps.send(grid_message(ROOM, "r1/map", 1))
    moves.send(transforms_message([("map", "base", Pose2())], 1))
    (message,) = link.subscribe(MAP).take()
    np.testing.assert_array_equal(message.data, ROOM.cells.ravel())
    assert link.subscribe(MOVES).take() == []


def test_of_maps_that_wait_the_newest_alone_is_kept():
    link = InnerLink()
    listener, maps = link.subscribe(MAP), link.advertise(MAP)
    for second in (1, 2, 3):
        maps.send(grid_message(ROOM, f"frame {second}", second))
    (message,) = listener.take()
    assert message.header.frame_id == "frame 3"
    assert listener.take() == []


def test_it_tells_what_is_published_and_by_how_many():
    link = InnerLink()
    listener, maps = link.subscribe(MAP), link.advertise(MAP)
    assert (listener.publishers, maps.listeners, link.published()) == (1, 1, {MAP: 1})
    maps.leave()
    assert (listener.publishers, link.published()) == (0, {})
