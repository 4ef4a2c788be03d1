import numpy as np
import pytest
from drawn import flat_pair
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap
from algorithms.maps.map_fusion import fuse
from algorithms.verdict.performance_index import performance_index

REF, MOV, _, T = flat_pair()
TRUE = fuse((REF, MOV), (Pose2(), T))


def row(*cells):
    return GridMap(np.array([cells], dtype=np.int8), 1.0)


def test_the_true_transform_has_the_same_index_with_and_without_the_truth():
    assert performance_index(TRUE, TRUE) == pytest.approx(performance_index(TRUE))
    assert performance_index(TRUE) > 0.98


def test_agreement_outside_the_true_overlap_does_not_count():
    ref, mov = row(0, 0, 100, 0, -1), row(0, 100, 0, -1, -1)
    true = fuse((ref, mov), (Pose2(), Pose2()))
    beside = fuse(
        (ref, mov), (Pose2(), Pose2(1.0, 0.0))
    )  # three of its cells agree, one of them not in the overlap
    assert performance_index(true, true) == pytest.approx(1 / 3)
    assert performance_index(beside) == pytest.approx(1.0)
    assert performance_index(beside, true) == pytest.approx(2 / 3)


@settings(deadline=None, max_examples=25)
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-np.pi, np.pi))
def test_it_is_a_share_and_no_worse_place_beats_the_truth_by_much(x, y, turn):
    index = performance_index(fuse((REF, MOV), (Pose2(), Pose2(x, y, 0) @ T @ Pose2(theta=turn))), TRUE)
    assert 0 <= index <= 1
    assert index <= performance_index(TRUE, TRUE) + 0.02


def test_maps_that_share_no_cell_have_none():
    assert performance_index(fuse((row(0, 0), row(0)), (Pose2(), Pose2(50.0, 0.0)))) is None


def test_an_undecided_cell_is_in_the_overlap_and_agrees_with_nobody():
    assert performance_index(fuse((row(0, 0), row(0, 50)), (Pose2(), Pose2()))) == 0.5
