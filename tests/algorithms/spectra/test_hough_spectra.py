from itertools import product

import numpy as np
import pytest
from drawn import drawn_map, lengths
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.maps.grid_map import GridMap
from algorithms.spectra.augmented_map import augment
from algorithms.spectra.candidates import CandidateConfig, circular_peaks, match_turns
from algorithms.spectra.hough_spectra import (
    SpectraConfig,
    correlate_turns,
    fast_length,
    hough_spectrum,
    hough_transform,
    match_shift,
    parabolic_offset,
    project,
)

HERE = np.array([4.0, 3.0])


def lifted(turn=0.0, shift=(0.0, 0.0), spread=3.0, **kw):
    T_map_world = Pose2(*shift, turn)
    grid = drawn_map(T_map_world, **kw)
    return augment(grid, T_map_world.apply(HERE), np.eye(2) * spread**2, 100.0)


def half_turn_gap(a, b):
    """Between two turns when a turn and its twin count as one."""
    return abs((a - b + np.pi / 2) % np.pi - np.pi / 2)


def test_a_wall_stands_out_in_the_direction_of_its_normal():
    cells = np.full((40, 40), -1, dtype=np.int8)
    cells[20, 5:35] = 100  # along x: its normal points along y
    wall = augment(GridMap(cells, 0.05), np.array([1.0, 1.0]), np.eye(2), 100.0)
    assert hough_spectrum(wall, 180, 0.05).argmax() == 90


def test_every_vote_is_counted_whatever_the_direction():
    augmented = lifted()
    votes = hough_transform(augmented, 90, 0.05)
    assert np.allclose(votes.sum(axis=1), augmented.levels.sum())


def seen_from(T_new_old, spread=3.0):
    """The same raster in a frame that lies elsewhere: its walls don't change, their numbers do."""
    grid = drawn_map(Pose2())
    moved = GridMap(grid.cells, grid.resolution, T_new_old @ grid.origin)
    return augment(moved, T_new_old.apply(HERE), np.eye(2) * spread**2, 100.0)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 359), lengths, lengths)
def test_turning_a_room_rolls_its_hough_spectrum_and_shifting_leaves_it(bins, x, y):
    turned = hough_spectrum(seen_from(Pose2(x, y, bins * np.pi / 180)), 180, 0.05)
    rolled = np.roll(hough_spectrum(seen_from(Pose2()), 180, 0.05), bins)
    assert np.allclose(turned, rolled, atol=1e-9)


@settings(max_examples=8, deadline=None)
@given(st.integers(1, 179))
def test_drawing_a_room_turned_rolls_its_hough_spectrum(bins):
    turned = hough_spectrum(lifted(bins * np.pi / 180), 180, 0.05)
    rolled = np.roll(hough_spectrum(lifted(), 180, 0.05), bins)
    assert np.corrcoef(turned, rolled)[0, 1] > 0.97


def test_a_map_turned_half_round_has_the_same_hough_spectrum():
    assert (
        np.corrcoef(hough_spectrum(lifted(np.pi), 180, 0.05), hough_spectrum(lifted(), 180, 0.05))[0, 1]
        > 0.999
    )


@settings(max_examples=10, deadline=None)
@given(st.floats(-np.pi, np.pi), st.floats(-np.pi, np.pi))
def test_the_first_turn_or_its_twin_is_the_known_one(turn_ref, turn_mov):
    match = match_turns(lifted(turn_ref), lifted(turn_mov), SpectraConfig(), CandidateConfig())
    known = turn_ref - turn_mov  # the sign of eq. (12) as printed gives minus this
    assert half_turn_gap(match.turns[0], known) < np.deg2rad(0.5)
    assert half_turn_gap(match.turns[1], known) < np.deg2rad(0.5)
    assert min(abs(wrap_angle(turn - known)) for turn in match.turns[:2]) < np.deg2rad(0.5)


def test_every_turn_comes_with_its_twin_and_strengths_fall():
    match = match_turns(lifted(0.4), lifted(), SpectraConfig(), CandidateConfig(peaks=2))
    assert len(match.turns) == 4
    assert list(match.strengths) == sorted(match.strengths, reverse=True)
    for turn, twin in zip(match.turns[::2], match.turns[1::2], strict=True):
        assert abs(wrap_angle(turn - twin)) == pytest.approx(np.pi)
    assert match.twins == (False, True) * 2


def test_without_twins_and_with_one_peak_there_is_the_bare_argmax():
    match = match_turns(lifted(0.4), lifted(), SpectraConfig(), CandidateConfig(peaks=1, twins=False))
    assert len(match.turns) == 1
    assert 0 <= match.turns[0] < np.pi
    assert match.correlation.argmax() == pytest.approx(match.turns[0] / np.pi * 360, abs=1)


@given(st.lists(st.floats(0, 1), min_size=8, max_size=8), st.lists(st.floats(0, 1), min_size=8, max_size=8))
def test_swapping_the_spectra_mirrors_the_correlation(a, b):
    forward, back = correlate_turns(np.array(a), np.array(b)), correlate_turns(np.array(b), np.array(a))
    assert np.allclose(forward, np.roll(back[::-1], 1), atol=1e-9)


def test_a_map_without_walls_has_an_empty_spectrum():
    empty = augment(GridMap(np.zeros((5, 5), np.int8), 0.05), np.zeros(2), np.eye(2), 100.0)
    assert not hough_spectrum(empty, 90, 0.05).any()


def test_peaks_are_ranked_and_a_flat_signal_still_gives_one():
    assert circular_peaks(np.array([5.0, 1, 3, 1, 4, 2])) == [0, 4, 2]
    assert circular_peaks(np.zeros(6)) == [0]


@given(st.floats(-0.45, 0.45))
def test_the_top_of_a_parabola_is_found_between_its_samples(top):
    assert parabolic_offset(*(-((k - top) ** 2) for k in (-1, 0, 1))) == pytest.approx(top)


coordinates = st.lists(st.floats(-10, 10), min_size=3, max_size=40, unique=True).map(np.array)


@given(coordinates)
def test_a_projection_keeps_the_weight_and_its_centre(at):
    levels = np.linspace(1, 2, len(at))
    sums, where = project(at, levels, 0.05)
    assert sums.sum() == pytest.approx(levels.sum())
    assert sums @ where / sums.sum() == pytest.approx(levels @ at / levels.sum(), abs=1e-9)


@given(coordinates, st.floats(-30, 30))
def test_a_known_shift_along_an_axis_is_found(at, shift):
    levels = np.ones(len(at))
    match = match_shift(at + shift, at, levels, levels, 0.05, shift - 1, shift + 1)
    assert match.shift == pytest.approx(shift, abs=0.05)


@given(coordinates, coordinates, st.floats(-5, 5), st.floats(0.05, 3))
def test_a_shift_never_leaves_its_window(a, b, middle, half):
    match = match_shift(a, b, np.ones(len(a)), np.ones(len(b)), 0.05, middle - half, middle + half)
    assert middle - half <= match.shift <= middle + half


def test_correlation_of_shifts_does_not_wrap_around():
    left, right = np.array([0.0, 0.05]), np.array([9.0, 9.05])
    match = match_shift(left, right, np.ones(2), np.ones(2), 0.05, -20, 20)
    assert match.shift == pytest.approx(-9.0, abs=0.03)


def test_a_quick_length_is_the_next_one_made_of_small_primes():
    small = {2**a * 3**b * 5**c * 7**d * 11**e for a, b, c, d, e in product(range(13), *[range(8)] * 4)}
    for least in range(1, 3000):
        assert fast_length(least) == min(size for size in range(least, 2 * least + 1) if size in small)
