"""The other vendor: what Fast DDS sends we read, and it reads what we send; recorded, and on loopback."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from dds_domains import new_domain
from fastdds_peer import NEEDED, build, can_be_built

from algorithms.common.pose import Pose2
from algorithms.files.bags.map_messages import grid_of
from algorithms.files.bags.message_types import GRID, MessageReader
from algorithms.files.bags.message_writing import MessageWriter
from algorithms.maps.grid_map import GridMap
from app.live.dds_link import DdsLink
from app.live.live_frames import LiveFrames
from app.live.message_fields import grid_message, transforms_message
from app.live.ros_link import TF, Topic, map_topic

RECORDED = Path(__file__).parent / "recorded_by_fastdds"
STAMP = 1_700_000_000 * 1_000_000_000
POSE = Pose2(3.0, -4.0, 2 * np.arcsin(0.6))


def drawn() -> GridMap:
    """The map of ros_peer.cpp."""
    cells = np.zeros((30, 40), dtype=np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    cells[0, 0] = -1
    return GridMap(cells, 0.05, Pose2(-1.25, 2.5))


@pytest.fixture(scope="module")
def peer(tmp_path_factory):
    if not can_be_built():
        pytest.skip(f"Fast DDS is not here; what it has recorded is read all the same ({NEEDED})")
    return build(tmp_path_factory.mktemp("fastdds"))


def check_map(message):
    grid = grid_of("robot", "robot", message)
    np.testing.assert_array_equal(grid.cells, drawn().cells)
    assert (grid.resolution, grid.origin, message.header.frame_id) == (0.05, drawn().origin, "robot/map")


def test_the_bytes_of_fast_dds_are_read_and_ours_are_the_same():
    data = (RECORDED / "map.cdr").read_bytes()
    check_map(MessageReader(ros1=False).read("map", GRID, data))
    ours = grid_message(drawn(), "robot/map", STAMP + 250_000_000)
    del ours["info"]["map_load_time"]
    assert MessageWriter().write(GRID, ours) == data
    transforms = MessageReader(ros1=False).read("tf", TF, (RECORDED / "tf.cdr").read_bytes())
    (one,) = transforms.transforms
    assert (one.header.frame_id, one.child_frame_id) == ("robot/map", "robot/base_link")
    assert (one.transform.translation.x, one.transform.rotation.w) == (3.0, 0.8)


def test_what_was_recorded_is_what_fast_dds_sends_today(peer, tmp_path):
    subprocess.run([peer, "record", tmp_path], check=True)
    for name in ("map.cdr", "tf.cdr"):
        assert (tmp_path / name).read_bytes() == (RECORDED / name).read_bytes()


def test_a_map_and_transforms_of_a_robot_on_fast_dds_arrive(peer):
    domain = new_domain()
    link = DdsLink(domain, "lo")
    maps, frames = link.subscribe(map_topic("/map")), LiveFrames(link)
    command = [peer, "publish", str(domain)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as robot:
        try:
            assert robot.stdout.readline() == "publishing\n"
            found, pose, end = [], None, time.monotonic() + 60
            while not (found and pose) and time.monotonic() < end:
                found = found or maps.take()
                frames.poll()
                if "robot/base_link" in frames.names:
                    pose = frames.pose("robot/map", "robot/base_link")
                time.sleep(0.02)
            check_map(found[0])
            np.testing.assert_allclose(pose.array(), POSE.array(), atol=1e-9)
            assert maps.publishers == 1
        finally:
            robot.kill()
            link.close()


def test_a_robot_on_fast_dds_hears_the_merged_map_and_the_frames_also_where_it_comes_late(peer):
    domain = new_domain()
    link = DdsLink(domain, "lo")
    cells = np.array([[-1, 0, 1], [2, 3, 100]], dtype=np.int8)
    link.advertise(map_topic("/mapmeld/map")).send(
        grid_message(GridMap(cells, 0.05, Pose2(1.5, 0.0)), "r1/map", 0)
    )
    static = link.advertise(Topic("/tf_static", TF, latched=True, depth=1))
    static.send(transforms_message([("r1/map", "r2/map", Pose2(2.5, 0.0))], 0))
    told = subprocess.run(
        [peer, "listen", str(domain)], capture_output=True, text=True, timeout=120, check=True
    )
    link.close()
    expected = 0
    for cell in cells.astype(np.uint8).ravel().tolist():
        expected = (31 * expected + cell) % 1_000_000_007
    assert told.stdout.splitlines() == ["listening", f"r1/map 3 2 0.05 1.5 {expected}", "r1/map r2/map 2.5"]
