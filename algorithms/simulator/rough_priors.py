"""What somebody may know of a true transform, drawn around it: a rough pose, or a rough turn."""

from __future__ import annotations

from math import radians
from typing import Literal

import numpy as np

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.observations.observation import Observation, encounter
from algorithms.observations.priors import InitialPose, Prior, TurnPrior
from algorithms.simulator.portable_random import normals

Knowledge = Literal["sighting", "initial", "turn", "none"]
"""What is known of a pair: what robot 1 saw, a rough initial pose, a rough turn, or nothing."""

SIGMA_XY = 2.0  # metres; of what people remember of where robots started
SIGMA_YAW = radians(10)


def met_at(o: Observation, yaw: float) -> Pose2:
    """T_ref_mov turned by ``yaw`` that puts robot 2 where it was seen: for maps that share no place."""
    at = encounter(o)
    x, y = (at.x_ref - Pose2(theta=yaw).apply(at.x_mov)).tolist()
    return Pose2(x, y, wrap_angle(yaw))


def rough_prior(
    T_ref_mov: Pose2,
    knowledge: Knowledge,
    rng: np.random.Generator,
    sigma_xy: float = SIGMA_XY,
    sigma_yaw: float = SIGMA_YAW,
) -> tuple[Prior, ...]:
    """Knowledge with errors of these standard deviations; () for a sighting, or for nothing.

    sigma_xy, sigma_yaw : metres, radians
    """
    dx, dy, turn = normals(rng, 3).tolist()
    yaw = wrap_angle(T_ref_mov.theta + turn * sigma_yaw)
    if knowledge == "turn":
        return (TurnPrior(yaw, sigma_yaw),)
    if knowledge == "initial":
        pose = Pose2(T_ref_mov.x + dx * sigma_xy, T_ref_mov.y + dy * sigma_xy, yaw)
        return (InitialPose(pose, sigma_xy, sigma_xy, sigma_yaw),)
    return ()
