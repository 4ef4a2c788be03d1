"""The robots themselves, which stand in each other's maps as small rings of wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import FloatArray, Pose2


@dataclass(frozen=True, eq=False)
class Robots:
    """Where robots are known to have stood. What a map shows there is the robot itself, and no wall.

    in_ref : (N, 2) the observers; metres, ref frame. Map 1's maker: what its own map shows there is so
    in_mov : (M, 2) the observed; metres, mov frame. Likewise map 2's
    size   : radius around them; metres
    """

    in_ref: FloatArray
    in_mov: FloatArray
    size: float

    def places(self, T_ref_mov: Pose2) -> FloatArray:
        """(N + M, 2) all of them in the ref frame."""
        return np.concatenate([self.in_ref, T_ref_mov.apply(self.in_mov)])


NO_ROBOTS = Robots(np.zeros((0, 2)), np.zeros((0, 2)), 0.0)
