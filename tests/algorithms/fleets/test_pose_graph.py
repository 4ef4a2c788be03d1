"""Poses that are solved together: from any root the same, and no farther off than they say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.fleets.pose_graph import PoseEdge, solve

SIGMAS = np.array([0.03, 0.03, 0.005])
PAIRS = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0), (0, 2), (1, 3)]


def measured(seed: int) -> tuple[dict[str, Pose2], list[PoseEdge]]:
    """True poses, and edges with errors drawn."""
    rng = np.random.default_rng(seed)
    poses = [Pose2(*rng.uniform(-20, 20, 2), rng.uniform(-3, 3)) for _ in range(5)]
    edges = []
    for a, b in PAIRS:
        T = (poses[a].inverse() @ poses[b]).array() + rng.normal(size=3) * SIGMAS
        edges.append(PoseEdge(f"r{a}", f"r{b}", Pose2.from_array(T), np.diag(SIGMAS**2)))
    return {f"r{k}": pose for k, pose in enumerate(poses)}, edges


def seen_from(poses: dict[str, Pose2], root: str) -> dict[str, Pose2]:
    return {name: poses[root].inverse() @ pose for name, pose in poses.items()}


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_another_root_gives_the_same_poses_moved(seed):
    poses, edges = measured(seed)
    first, other = (solve(root, seen_from(poses, root), edges).poses for root in ("r0", "r3"))
    for name in poses:
        moved = first["r3"] @ other[name]
        assert moved.xy == pytest.approx(first[name].xy, abs=1e-4)
        assert wrap_angle(moved.theta - first[name].theta) == pytest.approx(0.0, abs=1e-5)


@settings(max_examples=20)
@given(st.integers(0, 10_000))
def test_the_truth_lies_within_what_the_covariances_say(seed):
    poses, edges = measured(seed)
    true = seen_from(poses, "r0")
    solution = solve("r0", true, edges)
    for name in list(poses)[1:]:
        off = solution.poses[name].array() - true[name].array()
        off[2] = wrap_angle(float(off[2]))
        assert off @ np.linalg.solve(solution.covariances[name], off) < 30  # 3 degrees of freedom


@settings(max_examples=10)
@given(st.integers(0, 10_000))
def test_one_edge_more_makes_no_pose_less_certain(seed):
    poses, edges = measured(seed)
    true = seen_from(poses, "r0")
    fewer, more = (solve("r0", true, each).covariances for each in (edges[:5], edges))
    for name in poses:
        assert np.trace(more[name]) <= np.trace(fewer[name]) * 1.01


def test_without_a_loop_each_pose_is_the_chain_of_its_edges():
    poses, edges = measured(5)
    solution = solve("r0", seen_from(poses, "r0"), edges[:4])
    at = Pose2()
    for edge in edges[:4]:
        at = at @ edge.T_ref_mov
        assert solution.poses[edge.mov].xy == pytest.approx(at.xy, abs=1e-6)
