"""Record tests/algorithms/files/bags/recorded_by_ros1.bag with ROS 1's own library, not ours.

    python3 tests/tools/ros1_recording.py FILE

with a Python that has rosbag and the messages (Debian: python3-rosbag, python3-nav-msgs, python3-map-msgs,
python3-tf2-msgs). Ten seconds: a map that is sent twice and brought up to date, and a robot that drives.
"""

from __future__ import annotations

import sys

import genpy
import rosbag
from geometry_msgs.msg import TransformStamped
from map_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from tf2_msgs.msg import TFMessage

BEGIN = 1_600_000_000
WIDTH, HEIGHT = 40, 30


def grid(value: int) -> OccupancyGrid:
    """A room whose floor has one value, walled, with an unknown cell at the bottom left."""
    message = OccupancyGrid()
    message.header.frame_id = "map"
    message.info.resolution, message.info.width, message.info.height = 0.05, WIDTH, HEIGHT
    message.info.origin.position.x, message.info.origin.position.y = -1.25, 2.5
    message.info.origin.orientation.w = 1.0
    walls = (0, WIDTH - 1), (0, HEIGHT - 1)
    cells = [100 if x in walls[0] or y in walls[1] else value for y in range(HEIGHT) for x in range(WIDTH)]
    message.data = [-1, *cells[1:]]
    return message


def update() -> OccupancyGridUpdate:
    """A pillar of 2 × 3 cells from column 7, row 5 on."""
    message = OccupancyGridUpdate()
    message.x, message.y, message.width, message.height, message.data = 7, 5, 2, 3, [100] * 6
    return message


def transform(parent: str, child: str, time: genpy.Time, x: float) -> TFMessage:
    found = TransformStamped()
    found.header.frame_id, found.child_frame_id, found.header.stamp = parent, child, time
    found.transform.translation.x, found.transform.rotation.w = x, 1.0
    return TFMessage([found])


def main(path: str) -> None:
    with rosbag.Bag(path, "w", compression=rosbag.Compression.BZ2) as bag:
        for tenths in range(0, 101, 5):
            time = genpy.Time(BEGIN + tenths // 10, tenths % 10 * 100_000_000)
            bag.write("/tf", transform("map", "odom", time, 1.0), time)
            bag.write("/tf", transform("odom", "base_link", time, tenths / 10), time)
            if tenths in (10, 50):
                bag.write("/map", grid(0 if tenths == 50 else 20), time)
            if tenths == 70:
                bag.write("/map_updates", update(), time)


if __name__ == "__main__":
    main(sys.argv[1])
