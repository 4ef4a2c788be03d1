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

    def seen(flat: FloatArray) -> tuple[FloatArray, ...]:
        """Of each edge cos and sin of the ref robot's turn, and where it has the mov robot, in its frame."""
        poses = np.vstack([flat.reshape(-1, 3), np.zeros(3)])
        ref, mov = poses[ends[:, 0]], poses[ends[:, 1]]
        c, s = np.cos(ref[:, 2]), np.sin(ref[:, 2])
        x, y, turn = (mov - ref).T
        return c, s, c * x + s * y, -s * x + c * y, turn

    def misses(flat: FloatArray) -> FloatArray:
        """Standard deviations by which each edge is missed."""
        _, _, x, y, turn = seen(flat)
        off = np.column_stack([x, y, turn]) - measured
        off[:, 2] = wrap_angles(off[:, 2])
        return np.asarray(np.einsum("eij,ej->ei", whitening, off).ravel(), dtype=np.float64)

    def jacobian(flat: FloatArray) -> FloatArray:
        """(3 E, 3 N) of ``misses``."""
        c, s, x, y, _ = seen(flat)
        zero, one = np.zeros_like(c), np.ones_like(c)
        by_mov = np.stack([c, s, zero, -s, c, zero, zero, zero, one], axis=1).reshape(-1, 3, 3)
        by_ref = -by_mov
        by_ref[:, 0, 2], by_ref[:, 1, 2] = y, -x
        blocks = np.zeros((len(edges), 3, len(names) + 1, 3))
        numbers = np.arange(len(edges))
        blocks[numbers, :, ends[:, 0]] = whitening @ by_ref
        blocks[numbers, :, ends[:, 1]] += whitening @ by_mov
        return blocks[:, :, :-1].reshape(3 * len(edges), 3 * len(names))

    found = least_squares(misses, first.ravel(), jacobian, method="lm", x_scale="jac")
    spread = np.linalg.inv(found.jac.T @ found.jac)
    poses = {name: Pose2.from_array(found.x[3 * k : 3 * k + 3]) for name, k in row.items() if name != root}
    covariances = {
        name: np.asarray(spread[3 * k : 3 * k + 3, 3 * k : 3 * k + 3], dtype=np.float64)
        for name, k in row.items()
        if name != root
    }
    return PoseSolution({root: Pose2(), **poses}, {root: np.zeros((3, 3)), **covariances})
