from dataclasses import replace
from math import cos, sin

import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, T_MOV_WORLD, T_REF_WORLD, angles, lengths, poses, sighting
from hypothesis import assume, given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2, pose_error, rotation
from algorithms.observations.observation import encounter
from algorithms.observations.search_window import (
    CoupledWindow,
    Window,
    WindowConfig,
    coupled_window,
    paper_window,
    shift_window,
)
from algorithms.optimisation.search_box import BoxConfig, SearchBox, box_around

in_flat = st.builds(Pose2, st.floats(0, 9), st.floats(0, 7), angles)
several = st.lists(st.tuples(in_flat, in_flat), min_size=1, max_size=3)
windows = st.builds(WindowConfig, st.just("coupled"), st.floats(0.01, 1), st.floats(0.5, 5))


def met(T_ref_world, T_mov_world, pairs):
    """The encounters of robots that stood in the flat two by two."""
    return [encounter(sighting(T_ref_world, T_mov_world, *pair)) for pair in pairs]


def beside(T, window, turn, metres, towards):
    """A transform that turns by so much more than T, and puts the pivot so far from where T puts it."""
    there = T.apply(window.pivot) + metres * np.array([cos(towards), sin(towards)])
    theta = T.theta + turn
    return Pose2(*(there - rotation(theta) @ window.pivot).tolist(), theta)


@given(poses, poses, in_flat, in_flat, st.sampled_from(["origin", "encounter"]))
def test_the_true_transform_lies_in_the_window(T_ref_world, T_mov_world, observer, observed, pivot):
    seen = sighting(T_ref_world, T_mov_world, observer, observed)
    window = paper_window(encounter(seen), WindowConfig(margin=0.01, kind=pivot))
    goes_to = (T_ref_world @ T_mov_world.inverse()).apply(window.pivot)
    assert np.all(goes_to >= window.low - 1e-9)
    assert np.all(goes_to <= window.high + 1e-9)


@given(angles)
def test_with_the_norm_of_eq_6_no_turn_leaves_the_window_as_printed(turn):
    # the component-wise |x̂2| would cut off turns that bring its length onto one axis
    at = encounter(sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED))
    window = paper_window(at, WindowConfig(margin=0.0, deviations=0.0, kind="origin"))
    shift = at.x_ref - rotation(turn) @ at.x_mov
    assert np.all((shift >= window.low - 1e-9) & (shift <= window.high + 1e-9))


def test_around_the_encounter_the_window_does_not_grow_with_the_distance_of_the_origin():
    near = encounter(sighting(T_REF_WORLD, Pose2(), OBSERVER, OBSERVED))
    far = encounter(sighting(T_REF_WORLD, Pose2(400.0, -300.0, 1.0), OBSERVER, OBSERVED))
    sizes = [
        paper_window(at, WindowConfig()).high - paper_window(at, WindowConfig()).low for at in (near, far)
    ]
    assert np.allclose(*sizes)
    printed = [paper_window(at, WindowConfig(kind="origin")) for at in (near, far)]
    assert np.all(printed[1].high - printed[1].low > printed[0].high - printed[0].low + 900)


def test_a_worse_sighting_makes_a_wider_window():
    good = sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED)
    bad = replace(good, sigma_range=0.3, sigma_bearing=0.1)
    windows = [paper_window(encounter(seen), WindowConfig()) for seen in (good, bad)]
    assert np.all(windows[1].high - windows[1].low > windows[0].high - windows[0].low)


@given(poses, lengths, lengths)
def test_box_coordinates_of_a_transform_give_that_transform_back(T_ref_mov, x, y):
    pivot = np.array([x, y])
    box = SearchBox(np.zeros(3), np.ones(3), pivot)
    coordinates = np.append(T_ref_mov.apply(pivot), T_ref_mov.theta)
    distance, angle = pose_error(box.transform(coordinates), T_ref_mov, pivot)
    assert distance < 1e-6
    assert angle < 1e-9


def test_a_box_of_the_printed_kind_is_in_shift_and_turn():
    T = Pose2(1.0, 2.0, 3.0)
    at = encounter(sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED))
    wide = paper_window(at, WindowConfig(margin=10, kind="origin"))
    box = box_around(T, wide, BoxConfig(0.3, 0.4, 5.0))
    assert np.allclose(box.centre, T.array())
    assert np.allclose(box.high - box.low, (0.6, 0.8, np.deg2rad(10)))


@given(st.floats(0.05, 5), st.floats(0.05, 5))
def test_the_box_stays_in_the_window(sigma_x, sigma_y):
    at = encounter(sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED))
    window = paper_window(at, WindowConfig())
    middle = T_REF_WORLD @ T_MOV_WORLD.inverse()
    box = box_around(middle, window, BoxConfig(sigma_x, sigma_y))
    assert np.all(box.low[:2] >= window.low)
    assert np.all(box.high[:2] <= window.high)
    assert np.all(box.low < box.high)


@pytest.mark.parametrize(
    ("field", "value"), [("sigma_x", 0.0), ("sigma_theta", 400.0), ("sigma_y", float("nan"))]
)
def test_a_margin_out_of_bounds_is_refused_by_name_and_range(field, value):
    from algorithms.common.errors import SettingError

    with pytest.raises(SettingError, match=rf"BoxConfig.{field} .* must lie in \["):
        BoxConfig(**{field: value})


@given(poses, poses, several, windows)
def test_the_truth_is_where_every_exact_sighting_puts_it(T_ref_world, T_mov_world, pairs, config):
    window = coupled_window(met(T_ref_world, T_mov_world, pairs), config)
    truth = (T_ref_world @ T_mov_world.inverse()).array()[None]
    assert np.allclose(window.deviations(truth), 0, atol=1e-6)
    assert window.contains(truth).all()


@given(poses, poses, several, poses, poses, poses)
def test_deviations_do_not_hang_on_the_frames_of_the_maps(
    T_ref_world, T_mov_world, pairs, T, T_new_ref, T_new_mov
):
    config = WindowConfig("coupled")
    window = coupled_window(met(T_ref_world, T_mov_world, pairs), config)
    moved = coupled_window(met(T_new_ref @ T_ref_world, T_new_mov @ T_mov_world, pairs), config)
    then = window.deviations(T.array()[None])
    now = moved.deviations((T_new_ref @ T @ T_new_mov.inverse()).array()[None])
    assert np.allclose(now, then, rtol=1e-6, atol=1e-6)


@given(several, windows, angles, st.floats(0, 3), angles)
def test_the_rectangle_of_the_coupled_window_holds_all_that_is_in_it(pairs, config, turn, metres, towards):
    window = coupled_window(met(T_REF_WORLD, T_MOV_WORLD, pairs), config)
    T = beside(T_REF_WORLD @ T_MOV_WORLD.inverse(), window, turn, metres, towards)
    goes_to = T.apply(window.pivot)
    inside = np.all((goes_to >= window.low - 1e-9) & (goes_to <= window.high + 1e-9))
    assert inside or not window.contains(T.array()[None])[0]


@given(several, windows)
def test_and_the_rectangle_is_no_larger_than_it_must_be(pairs, config):
    window = coupled_window(met(T_REF_WORLD, T_MOV_WORLD, pairs[:1]), config)
    turns = np.arange(0, 2 * np.pi, 1e-3)
    rim = (
        window.x_ref[0]
        + np.linalg.solve(window.whitening[0], window.k * np.array([np.cos(turns), np.sin(turns)])).T
    )
    assert np.allclose([rim.min(axis=0), rim.max(axis=0)], [window.low, window.high], atol=1e-5)


@given(st.tuples(in_flat, in_flat), in_flat, windows, angles, st.floats(0, 1), angles)
def test_a_second_sighting_leaves_less_and_lets_nothing_new_in(pair, robot, config, turn, metres, towards):
    one = coupled_window(met(T_REF_WORLD, T_MOV_WORLD, [pair]), config)
    both = coupled_window(met(T_REF_WORLD, T_MOV_WORLD, [pair, (pair[0], robot)]), config)
    truth = T_REF_WORLD @ T_MOV_WORLD.inverse()
    T = beside(truth, one, turn, metres, towards).array()[None]
    assert one.contains(T)[0] or not both.contains(T)[0]
    # what turns about the first robot is in the first window, and carries the second robot away
    apart = np.hypot(robot.x - pair[1].x, robot.y - pair[1].y)
    assume(apart > 2 * config.deviations)
    flipped = beside(truth, one, np.pi, 0.0, 0.0).array()[None]
    assert one.contains(flipped)[0]
    assert not both.contains(flipped)[0]


@given(
    st.tuples(in_flat, in_flat), windows, st.floats(1, 5), st.floats(1, 5), angles, st.floats(0, 3), angles
)
def test_a_worse_sighting_leaves_all_that_a_better_one_leaves(pair, config, far, wide, turn, metres, towards):
    good = sighting(T_REF_WORLD, T_MOV_WORLD, *pair)
    bad = replace(good, sigma_range=good.sigma_range * far, sigma_bearing=good.sigma_bearing * wide)
    windows = [coupled_window([encounter(seen)], config) for seen in (good, bad)]
    T = beside(T_REF_WORLD @ T_MOV_WORLD.inverse(), windows[0], turn, metres, towards).array()[None]
    deviations = [window.deviations(T)[0, 0] for window in windows]
    assert deviations[1] <= deviations[0] + 1e-9
    assert windows[1].contains(T)[0] or not windows[0].contains(T)[0]


def test_a_metre_off_along_the_beam_is_more_deviations_than_a_metre_across_a_far_one():
    seen = replace(sighting(T_REF_WORLD, T_MOV_WORLD, Pose2(0, 0, 0), Pose2(8, 0, 0)), sigma_bearing=0.1)
    window = coupled_window([encounter(seen)], WindowConfig("coupled", margin=0.01))
    T = T_REF_WORLD @ T_MOV_WORLD.inverse()
    beam = T_REF_WORLD.theta
    along, across = (beside(T, window, 0.5, 1.0, beam + off) for off in (0, np.pi / 2))
    deviations = window.deviations(np.array([along.array(), across.array()]))[:, 0]
    assert deviations == pytest.approx([1 / np.hypot(0.05, 0.01), 1 / np.hypot(0.8, 0.01)], rel=1e-6)


@given(poses)
def test_what_is_pulled_in_lies_in_the_disc_turns_as_before_and_moves_no_farther_than_it_must(T):
    at = encounter(sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED))
    window = coupled_window([at], WindowConfig("coupled"))
    pulled = window.pulled_in(T)
    assert window.contains(pulled.array()[None])[0]
    assert pulled.theta == T.theta
    assert window.pulled_in(pulled) == pulled
    was, now = (np.linalg.norm(pose.apply(window.pivot) - at.x_ref) for pose in (T, pulled))
    assert now <= was + 1e-9


@pytest.mark.parametrize("kind", ["coupled", "encounter", "origin"])
def test_the_settings_say_which_window_and_the_papers_knows_the_first_sighting_only(kind):
    pairs = [(OBSERVER, OBSERVED), (OBSERVER, Pose2(5.5, 1.0, 0.0))]
    config, both = WindowConfig(kind), met(T_REF_WORLD, T_MOV_WORLD, pairs)
    one, two = (shift_window(both[:n], coupled_window(both[:n], config), config) for n in (1, 2))
    assert isinstance(one, CoupledWindow if kind == "coupled" else Window)
    assert np.array_equal([one.low, one.high, one.pivot], [two.low, two.high, two.pivot])
