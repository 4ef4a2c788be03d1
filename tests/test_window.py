from dataclasses import replace

import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, T_MOV_WORLD, T_REF_WORLD, angles, lengths, poses, sighting
from hypothesis import given
from hypothesis import strategies as st

from algorithms.observation import encounter
from algorithms.pose import Pose2, pose_error, rotation
from algorithms.window import Box, BoxConfig, WindowConfig, box_around, paper_window

in_flat = st.builds(Pose2, st.floats(0, 9), st.floats(0, 7), angles)


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
    box = Box(np.zeros(3), np.ones(3), pivot)
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
    from algorithms.errors import SettingError

    with pytest.raises(SettingError, match=rf"BoxConfig.{field} .* must lie in \["):
        BoxConfig(**{field: value})
