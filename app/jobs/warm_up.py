"""A merge of some cells: whoever has run it has loaded what a merge needs, and compiled what was not yet."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.methods.steps import Step
from algorithms.observations.observation import Observation
from app.jobs.forked_start import PRELOADED
from app.model.merge_job import MergeJob


def small_merge() -> MergeJob:
    """Merge a room of 4 x 3 m with itself: a wall stands in it, and two robots that see each other."""
    cells = np.full((60, 80), FREE, dtype=np.int8)
    for walls in (cells[:2], cells[-2:], cells[:, :2], cells[:, -2:], cells[20:22, 30:60], cells[40:, 50:52]):
        walls[:] = OCCUPIED
    room = GridMap(cells, 0.05, name="room")
    seen = Observation(
        observer=Pose2(1.0, 1.6, 0.3),
        observed_x=3.2,
        observed_y=1.9,
        observed_heading=2.0,
        range=2.22,
        bearing=-0.164,
        bearing_back=1.277,
    )
    return MergeJob(room, room, (seen,), None)


def warm_up() -> Iterator[Step]:
    """Do it, unless this process is the copy of one that has."""
    if not getattr(sys.modules.get(PRELOADED), "loaded", False):
        yield from small_merge().run({})
