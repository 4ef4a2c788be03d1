"""What a person knows: each number goes in and comes out; a choice uses what it names and keeps the rest."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.observations.priors import InitialPose, NearPlace, TurnPrior
from app.model.knowledge import (
    CHOICES,
    PRIORS,
    choice_of,
    counted,
    kind_of,
    laid,
    numbers_of,
    used,
    with_number,
)

EACH = [InitialPose(Pose2(3.0, -2.0, 0.4)), TurnPrior(1.2, 0.3), NearPlace(1.0, 2.0, -3.0, 4.0, 1.5)]


@pytest.mark.parametrize("prior", EACH, ids=kind_of)
@given(value=st.floats(0.1, 3.0))
def test_a_number_that_was_typed_is_read_back_and_no_other_changes(prior, value):
    for name, before in numbers_of(prior).items():
        after = numbers_of(with_number(prior, name, value))
        assert after.pop(name) == pytest.approx(value)
        others = {other: number for other, number in numbers_of(prior).items() if other != name}
        assert after == pytest.approx(others), before


@pytest.mark.parametrize(("prior", "name"), [(EACH[0], "s_xy"), (EACH[1], "s_yaw"), (EACH[2], "radius")])
def test_a_deviation_below_zero_is_refused(prior, name):
    with pytest.raises(SettingError, match="must be"):
        with_number(prior, name, -1.0)


def test_where_map_2_is_laid_is_what_is_known_of_it():
    T = Pose2(7.0, 8.0, -0.5)
    pose, turn, near = (laid(prior, T) for prior in EACH)
    assert pose.pose == T
    assert turn.yaw == T.theta
    assert near == EACH[2]


def test_a_choice_uses_its_kind_alone_and_all_uses_everything(inputs):
    known = (*inputs.observations, *EACH)
    assert used(known, "all") == known
    assert used(known, "nothing") == ()
    for choice in ("sighting", *PRIORS):
        assert {kind_of(one) for one in used(known, choice)} == {choice}


def test_what_is_not_used_is_kept_and_comes_back(inputs):
    known = (*inputs.observations, *EACH)
    mixed = inputs.knowing(known)
    assert mixed.choice == "all"
    assert mixed.mixed
    nothing = mixed.knowing(mixed.pool, "nothing")
    assert nothing.known == ()
    assert nothing.complete
    turn = nothing.knowing(nothing.pool, "turn")
    assert turn.known == (EACH[1],)
    assert turn.chosen_prior == EACH[1]
    assert set(turn.pool) == set(known)


def test_what_is_known_is_counted_in_words(inputs):
    (seen,) = inputs.observations
    assert counted(()) == CHOICES["nothing"]
    assert counted((seen,)) == "a sighting"
    assert counted((seen, seen, EACH[1])) == "2 sightings, roughly the turn"


def test_the_choice_of_what_a_file_holds_uses_all_of_it(inputs):
    assert choice_of(()) == "nothing"
    assert choice_of(inputs.observations) == "sighting"
    assert choice_of(EACH[1:2]) == "turn"
    assert choice_of((*inputs.observations, EACH[0])) == "all"
