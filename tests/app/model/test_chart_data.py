"""The numbers behind the picture of the proof and the climb of the swarm."""

from __future__ import annotations

from math import inf, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from proofs import proof_state

from algorithms.common.pose import FloatArray, wrap_angles
from algorithms.methods.steps import PlaneDetail
from algorithms.optimisation.branch_and_bound import ProofState
from app.model import chart_data as charts
from app.model.objective_label import AGREEMENT

values = st.one_of(st.just(-inf), st.floats(-50, 120))


@st.composite
def states(draw: st.DrawFn) -> ProofState:
    """Proofs over circles of a few or of many sectors, in the order that the certificate tells them."""
    count = draw(st.integers(1, 40))
    step = 2 * np.pi / count
    ceilings = np.array(draw(st.lists(values, min_size=count, max_size=count)))
    found = np.minimum(ceilings, np.array(draw(st.lists(values, min_size=count, max_size=count))))
    rivals = draw(st.lists(st.tuples(st.just(0.0), st.just(0.0), st.floats(-3.14, 3.14)), max_size=3))
    return proof_state(
        turns=wrap_angles((np.arange(count) + 0.5) * step),
        ceilings=ceilings,
        found=found,
        best=draw(st.one_of(st.none(), st.just(np.array([0.0, 0.0, draw(st.floats(-3.14, 3.14))])))),
        rivals=np.array(rivals).reshape(-1, 3),
        rival_values=np.full(len(rivals), 3.0),
        floor=draw(values),
    )


def inside(x: FloatArray, y: FloatArray, at: float) -> float:
    """Height of a stair at a place."""
    return float(y[np.searchsorted(x, at, side="right") - 1])


@given(states())
def test_every_curve_of_a_proof_lies_on_the_circle_and_in_its_range_without_infinities(state):
    chart = charts.proof(state, 90.0, AGREEMENT)
    (low, top), (x, ceiling, found, floor, best, rivals) = chart.up, chart.columns
    assert (np.diff(x) >= 0).all()
    assert x[0] == pytest.approx(-180)
    assert x[-1] == pytest.approx(180)
    for curve in (ceiling, found, floor):
        assert np.isfinite(curve).all()
        assert (curve >= low).all()
        assert (curve <= top).all()
    assert (found <= ceiling).all()
    assert np.isfinite(best).sum() == (state.best is not None)
    assert np.isfinite(rivals).sum() == (len(state.rivals) if state.best is not None else 0)


@given(states())
def test_in_the_middle_of_every_sector_stands_its_own_ceiling(state):
    chart = charts.proof(state, 90.0, AGREEMENT)
    top, (x, ceiling, found, *_) = chart.up[1], chart.columns
    for turn, bound, met in zip(np.degrees(state.turns), state.ceilings, state.found, strict=True):
        assert inside(x, ceiling, turn) == pytest.approx(np.clip(bound, 0, top))
        assert inside(x, found, turn) == pytest.approx(np.clip(met, 0, top))


@given(st.lists(st.one_of(st.just(nan), st.floats(1e-3, 300)), min_size=1, max_size=40))
def test_the_best_of_every_turn_is_a_curve_without_holes_whose_top_is_marked_once(tops):
    turns = np.arange(len(tops)) * (2 * np.pi / len(tops)) - np.pi
    detail = PlaneDetail(0, turns, np.array(tops), None, 0.1, np.zeros((0, 3)), np.zeros(0), 0.0)
    chart = charts.plane_turns(detail, AGREEMENT)
    (low, high), (x, y, best) = chart.up, chart.columns
    assert x == pytest.approx(np.degrees(turns))
    assert np.isfinite(y).all()
    assert ((y == tops) | (np.isnan(tops) & (y == 0))).all()
    assert (low <= y).all()
    assert (y <= high).all()
    assert np.isfinite(best).sum() == np.isfinite(tops).any()
    if np.isfinite(tops).any():
        assert np.nanmax(best) == np.nanmax(tops)


def test_the_optimum_is_marked_at_its_turn_and_its_value():
    x, _, _, _, best, rivals = charts.proof(proof_state(), 30.0, AGREEMENT).columns
    assert x[np.isfinite(best)] == pytest.approx(np.degrees(0.5))
    assert best[np.isfinite(best)] == pytest.approx(20.0)
    assert rivals[np.isfinite(rivals)] == pytest.approx(15.0)


def test_the_axis_of_a_proof_stands_still_while_the_ceiling_comes_down():
    first = charts.proof(proof_state(ceiling=90.0), 90.0, AGREEMENT).up
    assert charts.proof(proof_state(ceiling=21.0), 90.0, AGREEMENT).up == first
    assert charts.proof(proof_state(best_value=-inf, ceiling=-inf), -inf, AGREEMENT).up == (0.0, 1.0)


def test_the_table_names_the_optimum_and_its_rivals():
    assert charts.proof_rows(proof_state(), AGREEMENT) == [
        ("optimum", "28.6°", "20.0", "100%"),
        ("rival 1", "-149.4°", "15.0", "75%"),
    ]
    assert charts.proof_rows(proof_state(best=None), AGREEMENT) == []
    assert charts.proof_rows(proof_state(proven=False), AGREEMENT)[0][0] == "best so far"


def test_a_climb_that_begins_outside_of_the_window_has_no_infinite_point():
    x, *lines = charts.climb([[-inf, -3.0, 5.0], [-inf]], AGREEMENT).columns
    assert x.tolist() == [1, 2, 3]
    assert [line.tolist() for line in lines] == [[0, -3, 5], [0, 0, 0], [0, 0, 0], [0, 0, 0]]


def test_a_mark_between_two_sectors_leaves_no_spike_in_the_stair():
    turns, best = np.array([-0.5, 0.5]) * np.pi, np.zeros(3)
    state = proof_state(
        turns=turns,
        ceilings=np.array([1.0, 5.0]),
        found=np.array([1.0, 5.0]),
        best=best,
        rivals=np.zeros((0, 3)),
        rival_values=np.zeros(0),
    )
    x, ceiling, *_ = charts.proof(state, 30.0, AGREEMENT).columns
    assert x[x == 0].size == 3  # the end of one, the beginning of the other, the mark
    assert ceiling.tolist() == sorted(ceiling.tolist())
