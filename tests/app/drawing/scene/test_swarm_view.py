"""The proven optimum in the space of the swarm: inside the box, or on its border with how far off it is."""

from __future__ import annotations

from math import pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from proofs import proof_state

from algorithms.common.pose import Pose2
from algorithms.methods.steps import ProvenDetail, RefineDetail, Step
from algorithms.optimisation.optimiser import SearchState
from algorithms.optimisation.search_box import SearchBox
from algorithms.optimisation.subcell_peak import Peak
from app.drawing.browser_messages import BrowserMessages
from app.drawing.palette import DARK, LIGHT
from app.drawing.scene.swarm_view import SwarmView, in_box, proven_optimum
from app.model.run_state import RunState

BOX = SearchBox(np.array([2.0, 3.0, 1.0]), np.array([4.0, 5.0, 1.2]), np.array([30.0, -7.0]))
inner = st.tuples(st.floats(2.0, 4.0), st.floats(3.0, 5.0), st.floats(1.0, 1.2))


def shown(T: Pose2):
    """What is drawn of an optimum at T, beside a swarm whose best is the middle of the box."""
    middle, one = BOX.centre, BOX.centre[None]
    state = SearchState(0, one, np.zeros(1), one, np.zeros(1), middle, 0.0)
    proven = ProvenDetail(proof_state(), Peak(T, 20.0, np.eye(3)), False)
    return proven_optimum(proven, RefineDetail(0, 1, BOX, state), LIGHT)


@given(inner)
def test_an_optimum_inside_the_box_is_a_star_at_its_place(pose):
    (star,) = shown(BOX.transform(np.array(pose)))
    assert star["s"] == "star"
    assert star["t"] == "proven optimum"
    x, y, turn = (np.array(pose) - BOX.centre) / ((BOX.high - BOX.low) / 2)
    assert star["p"] == pytest.approx([x, turn, -y], abs=1e-6)


@given(st.floats(-pi, pi), st.floats(-9, 9), st.floats(-9, 9))
def test_an_optimum_outside_of_it_stands_on_the_border_and_says_how_far_it_is(turn, dx, dy):
    x, y, _ = BOX.centre
    T = BOX.transform(np.array([x + dx, y + dy, turn]))
    coordinates = in_box(T, BOX)
    if (np.abs(coordinates - BOX.centre) <= 1.01 * (BOX.high - BOX.low) / 2).all():
        return
    ray, star, more = shown(T)
    assert np.abs(star["p"]).max() == pytest.approx(1.0)
    assert ray["p"][1] == pytest.approx(star["p"])
    assert star["t"] == "proven optimum, outside"
    metres, _, words = more["t"].partition(" m and ")
    assert float(metres) == pytest.approx(np.hypot(dx, dy), abs=0.0501)  # a digit is told
    assert words.endswith("from the swarm's best")


def test_a_turn_is_taken_to_the_side_of_the_box_that_is_nearer():
    across = SearchBox(np.array([0, 0, pi - 0.1]), np.array([1, 1, pi + 0.1]), np.zeros(2))
    assert in_box(Pose2(0.5, 0.5, -pi + 0.05), across)[2] == pytest.approx(pi + 0.05)
    assert shown(BOX.transform(BOX.centre + (0, 0, radians(178))))[2]["t"].startswith("0.0 m and 178°")


class Drawn(BrowserMessages):
    """A stage that keeps what is drawn on it."""

    def __init__(self) -> None:
        super().__init__()
        self.layers: dict[str, object] = {}

    def send(self, message):
        self.layers.update(message.get("layers", {}))


def test_who_comes_back_finds_the_box_and_its_numbers_again_in_the_colours_of_now():
    stage = Drawn()
    view, story = SwarmView(stage), RunState()
    one = BOX.centre[None]
    state = SearchState(0, one, np.zeros(1), one, np.zeros(1), BOX.centre, 0.0)
    story.add(Step("refine", RefineDetail(0, 1, BOX, state), 0.0))

    def frame(palette):
        view.show(story, palette, look=True)
        stage.flush()
        return stage.layers["axes"]

    first = frame(LIGHT)
    assert first
    view.hide()
    stage.flush()
    assert stage.layers["axes"] is None
    again = frame(LIGHT)
    assert [item.get("t") for item in again] == [item.get("t") for item in first]
    assert [item["c"] for item in frame(DARK)] != [item["c"] for item in again]
