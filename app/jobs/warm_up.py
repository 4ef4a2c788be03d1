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
    """Merge a room with itself."""
    cells = np.full((40, 60), FREE, dtype=np.int8)
    cells[[0, -1], :], cells[:, [0, -1]] = OCCUPIED, OCCUPIED
    room = GridMap(cells, 0.1)
    return MergeJob(room, room, (Observation(Pose2(2.0, 2.0), 3.0, 2.0, 1.0, 0.0),), None)


def warm_up() -> Iterator[Step]:
    """Do it, unless this process is the copy of one that has."""
    if not getattr(sys.modules.get(PRELOADED), "loaded", False):
        yield from small_merge().run({})
