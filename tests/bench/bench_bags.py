"""How fast a recording of 2 GB tells what it holds and gives its map, and in how much memory.

`make bench`. What is pinned is the ratio against reading all of its images in the same run.
"""

from __future__ import annotations

import resource
import subprocess
import sys
from time import perf_counter

import numpy as np
import pytest
from bags import grid_message, image_message, sensor_frames, transform_message, write_bag

from algorithms.common.pose import Pose2
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.bag_summary import read_summary
from algorithms.files.bags.message_types import IMAGES
from algorithms.files.map_file import read_map
from algorithms.maps.grid_map import GridMap

PICTURES = 2000  # of 1 MB
MOST_MEMORY = 300  # MB of a process that gives the map
TIMES_FASTER = 2  # than who reads all images


def messages():
    """200 seconds of a camera, transforms, and a map of a million cells every five seconds."""
    grid = GridMap(np.zeros((1000, 1000), np.int8), 0.05)
    pictures = np.random.default_rng(1).integers(0, 256, (4, 600, 600, 3), np.uint8)
    yield from sensor_frames(Pose2(), Pose2())
    yield grid_message(grid, 0.0, "/first_map")
    for k in range(PICTURES):
        at = k / 10
        yield from (transform_message("map", "odom", at + j * 0.03, (0, 0, 0)) for j in range(3))
        yield image_message(pictures[k % 4], at)
        if k % 50 == 10:
            yield grid_message(grid, at)


@pytest.mark.parametrize("kind", ["ros1", "db3", "mcap"])
def bench_bag(benchmark, tmp_path, kind):
    path = write_bag(tmp_path, "robot1", kind, messages())

    def look():
        return read_summary(path), read_map(f"{path}#/map"), read_map(f"{path}#/first_map")

    benchmark.pedantic(look, rounds=3, warmup_rounds=1)
    start = perf_counter()
    with open_bag(path) as bag:
        for _ in bag.messages(bag.of_type(*IMAGES)):
            pass
    all_images = perf_counter() - start
    code = "import sys; from algorithms.files.map_file import read_map; read_map(sys.argv[1])"
    subprocess.run([sys.executable, "-c", code, f"{path}#/map"], check=True)
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    benchmark.extra_info.update(all_images_seconds=all_images, memory_mb=memory)
    assert benchmark.stats.stats.median * TIMES_FASTER < all_images
    assert memory < MOST_MEMORY
