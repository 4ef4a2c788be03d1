"""All robots' transforms from the answers that were chosen, solved together: a pose graph in SE(2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, wrap_angles


@dataclass(frozen=True, eq=False)
class PoseEdge:
    """T_ref_mov between two robots, by name, and the (3, 3) covariance of its x, y, theta."""

    ref: str
    mov: str
    T_ref_mov: Pose2
    covariance: FloatArray


@dataclass(frozen=True, eq=False)
class PoseSolution:
    """Where each robot's frame lies in the root's.

    poses       : T_root_robot by name; the root's is the identity
    covariances : (3, 3) of each one's x, y, theta; metres, radians
    """

    poses: Mapping[str, Pose2]
    covariances: Mapping[str, FloatArray]


def solve(root: str, begin: Mapping[str, Pose2], edges: Sequence[PoseEdge]) -> PoseSolution:
    """The poses that all edges together make likeliest.

    begin : T_root_robot of every robot, the root's the identity, to start from
    edges : tie all of them to the root
    """
    from scipy.optimize import least_squares  # it loads what only merges need

    names = sorted(name for name in begin if name != root)
    row = {name: k for k, name in enumerate(names)}
    row[root] = len(names)
    first = np.array([begin[name].array() for name in names])
    ends = np.array([[row[edge.ref], row[edge.mov]] for edge in edges])
    measured = np.array([edge.T_ref_mov.array() for edge in edges])
    whitening = np.linalg.inv(np.linalg.cholesky(np.array([edge.covariance for edge in edges])))

    def misses(flat: FloatArray) -> FloatArray:
        """Standard deviations by which each edge is missed."""
        poses = np.vstack([flat.reshape(-1, 3), np.zeros(3)])
        ref, mov = poses[ends[:, 0]], poses[ends[:, 1]]
        c, s = np.cos(ref[:, 2]), np.sin(ref[:, 2])
        x, y = (mov - ref)[:, :2].T
        turn = wrap_angles(mov[:, 2] - ref[:, 2] - measured[:, 2])
        off = np.column_stack([c * x + s * y - measured[:, 0], -s * x + c * y - measured[:, 1], turn])
        return np.asarray(np.einsum("eij,ej->ei", whitening, off).ravel(), dtype=np.float64)

    found = least_squares(misses, first.ravel(), x_scale="jac")
    spread = np.linalg.inv(found.jac.T @ found.jac)
    poses = {name: Pose2.from_array(found.x[3 * k : 3 * k + 3]) for name, k in row.items() if name != root}
    covariances = {
        name: np.asarray(spread[3 * k : 3 * k + 3, 3 * k : 3 * k + 3], dtype=np.float64)
        for name, k in row.items()
        if name != root
    }
    return PoseSolution({root: Pose2(), **poses}, {root: np.zeros((3, 3)), **covariances})
