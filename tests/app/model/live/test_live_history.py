"""The past of a map that grows stays within bounds, however long it goes on."""

from __future__ import annotations

import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.model.live.live_history import LiveHistory


@given(steps=st.lists(st.floats(0.1, 40.0), min_size=1, max_size=300), most=st.integers(2, 20))
def test_however_long_it_goes_on_few_moments_are_kept_each_as_it_was(steps, most):
    history, times = LiveHistory(most), np.cumsum(steps).tolist()
    for time in times:
        history.add(time, time)
    assert 1 <= len(history.times) <= most
    assert list(history.times) == sorted(set(history.times))
    for kept in history.times:
        assert history.at(kept) == (kept, kept)


def test_moments_are_kept_evenly_over_an_hour():
    history = LiveHistory(most=100)
    for second in range(3600):
        history.add(float(second), second)
    gaps = np.diff(history.times)
    assert gaps.max() <= 2 * gaps.min()
    assert len(history.times) > 30
    assert history.times[0] < 100
    assert history.times[-1] > 3500


def test_what_takes_much_room_is_kept_less_often():
    history, noise = LiveHistory(most_bytes=100_000), random.Random(3)
    for second in range(60):
        history.add(float(second), noise.randbytes(10_000))  # which cannot be pressed
    assert history.bytes <= 100_000
    assert 3 <= len(history.times) <= 10


@pytest.mark.parametrize(("asked", "found"), [(0.0, 5.0), (5.0, 5.0), (8.9, 5.0), (9.0, 9.0), (99.0, 9.0)])
def test_a_time_between_shows_what_stood_then(asked, found):
    history = LiveHistory()
    history.add(5.0, "first")
    history.add(9.0, "second")
    assert history.at(asked)[0] == found


def test_before_anything_stood_there_is_no_past():
    assert LiveHistory().at(3.0) is None
