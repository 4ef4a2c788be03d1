"""Transforms with their errors: one after the other, there and back, and as often as one tries."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.fleets.transform_chain import EXACT, UncertainTransform

poses = st.builds(Pose2, st.floats(-20, 20), st.floats(-20, 20), st.floats(-3, 3))
uncertain = st.builds(
    lambda T, a, b, c: UncertainTransform(T, np.diag([a, b, c]) ** 2),
    poses,
    st.floats(0.01, 0.3),
    st.floats(0.01, 0.3),
    st.floats(0.001, 0.05),
)


@given(uncertain)
def test_the_inverse_undoes_it_and_its_own_inverse_is_the_same_again(one):
    back = one.inverse().inverse()
    assert back.T.array() == pytest.approx(one.T.array())
    assert back.covariance == pytest.approx(one.covariance)
    assert one.then(one.inverse()).T.array() == pytest.approx(np.zeros(3), abs=1e-9)


@given(uncertain, uncertain, uncertain)
def test_how_a_chain_is_bracketed_changes_nothing(a, b, c):
    left, right = a.then(b).then(c), a.then(b.then(c))
    assert left.T.xy == pytest.approx(right.T.xy)
    assert left.covariance == pytest.approx(right.covariance)


@given(uncertain, uncertain)
def test_the_inverse_of_a_chain_is_the_chain_of_inverses(a, b):
    assert a.then(b).inverse().covariance == pytest.approx(b.inverse().then(a.inverse()).covariance)


@given(uncertain)
def test_what_is_exact_adds_nothing(one):
    for whole in (one.then(EXACT), EXACT.then(one)):
        assert whole.T.array() == pytest.approx(one.T.array())
        assert whole.covariance == pytest.approx(one.covariance)


def test_errors_that_were_drawn_scatter_a_chain_as_it_says():
    rng = np.random.default_rng(3)
    one = UncertainTransform(Pose2(4.0, -2.0, 0.7), np.diag([0.05, 0.03, 0.01]) ** 2)
    two = UncertainTransform(Pose2(-3.0, 5.0, -1.1), np.diag([0.02, 0.06, 0.02]) ** 2)
    drawn = [
        (
            Pose2.from_array(one.T.array() + rng.normal(size=3) * [0.05, 0.03, 0.01])
            @ Pose2.from_array(two.T.array() + rng.normal(size=3) * [0.02, 0.06, 0.02])
        ).array()
        for _ in range(4000)
    ]
    assert np.cov(np.array(drawn).T) == pytest.approx(one.then(two).covariance, rel=0.1, abs=2e-4)


@given(uncertain, st.floats(0.05, 0.5), st.floats(0.01, 0.1))
def test_loosening_adds_its_error_where_the_pivot_goes(one, distance, angle):
    pivot = np.array([3.0, -4.0])
    loose = one.loosened(pivot, distance, angle)
    x, y = (one.T.apply(pivot) - one.T.xy).tolist()
    there = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
    more = there @ (loose.covariance - one.covariance) @ there.T
    assert more == pytest.approx(np.eye(2) * distance**2, abs=1e-9)
    assert loose.covariance[2, 2] - one.covariance[2, 2] == pytest.approx(angle**2)
