"""A problem of two maps is checked once: there is a sighting, and the robots stand on their own maps."""

from dataclasses import replace

import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, T_MOV_WORLD, T_REF_WORLD, drawn_map, sighting
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.observations.observation import encounter
from algorithms.observations.pair_problem import PairProblem

SEEN = sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED)
REF, MOV = drawn_map(T_REF_WORLD), drawn_map(T_MOV_WORLD)


def test_one_sighting_a_list_of_them_or_none_make_a_problem():
    assert (
        PairProblem.of(REF, MOV, SEEN) == PairProblem(REF, MOV, (SEEN,)) == PairProblem.of(REF, MOV, [SEEN])
    )
    assert PairProblem.of(REF, MOV, ()) == PairProblem(REF, MOV)


def test_problems_are_equal_where_maps_are_the_same_and_sightings_equal():
    assert PairProblem(REF, MOV, (replace(SEEN),)) == PairProblem(REF, MOV, (SEEN,))
    assert PairProblem(REF, drawn_map(T_MOV_WORLD), (SEEN,)) != PairProblem(REF, MOV, (SEEN,))
    assert PairProblem(REF, MOV, (SEEN, SEEN)) != PairProblem(REF, MOV, (SEEN,))


def test_the_robots_of_a_problem_stand_where_the_sighting_puts_them():
    robots = PairProblem(REF, MOV, (SEEN,)).robots(0.4)
    assert np.allclose(robots.in_ref, [SEEN.observer.xy])
    assert np.allclose(robots.in_mov, [encounter(SEEN).x_mov])
    assert robots.size == 0.4


def test_a_robot_far_off_its_own_map_is_told_with_what_may_be_mixed_up():
    ref, mov = drawn_map(T_REF_WORLD, name="first"), drawn_map(T_MOV_WORLD, name="second")
    PairProblem(ref, mov, (SEEN,))
    with pytest.raises(SettingError, match=r"robot 1 at .* outside its own map 'second'.*swapped"):
        PairProblem(mov, ref, (SEEN,))
    with pytest.raises(SettingError, match=r"robot 2 at \(800, .* check observed.pose"):
        PairProblem(ref, mov, (replace(SEEN, observed_x=800.0),))


@pytest.mark.parametrize("number", [1, 2, 3])
def test_of_several_observations_the_one_that_puts_a_robot_off_its_map_is_named(number):
    ref, mov = drawn_map(T_REF_WORLD), drawn_map(T_MOV_WORLD)
    several = [SEEN] * 3
    PairProblem.of(ref, mov, several)
    several[number - 1] = replace(SEEN, observed_x=800.0)
    with pytest.raises(SettingError, match=f"^observation {number} puts robot 2 at"):
        PairProblem.of(ref, mov, several)


@given(st.floats(0.1, 4.9), st.floats(0, 2 * np.pi))
def test_a_robot_a_little_off_a_cropped_map_is_let_pass(metres, direction):
    grid = drawn_map(Pose2())
    edge = grid.corners()[2] + metres * np.array([np.cos(direction), np.sin(direction)])
    stands = replace(SEEN, observer=Pose2(*edge.tolist()), observed_x=4.0, observed_y=3.0)
    PairProblem(grid, grid, (stands,))
