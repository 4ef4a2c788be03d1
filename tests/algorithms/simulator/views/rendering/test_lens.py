from dataclasses import replace

import numpy as np
import pytest
from sights import STILL

from algorithms.simulator.portable_random import stream
from algorithms.simulator.views.rendering.lens import blurred, developed, noise

GREY = np.full((60, 80, 3), 0.2, dtype=np.float32)


def shown(light=STILL, seen=GREY):
    return developed(seen, light, stream(0, "lens")).astype(float)


def test_more_light_is_a_brighter_picture_and_white_is_its_end():
    levels = [
        shown(seen=np.full((40, 40, 3), level, dtype=np.float32)).mean() for level in (0, 0.1, 0.5, 1, 4, 100)
    ]
    assert levels == sorted(levels)
    assert levels[0] == 0
    assert levels[-1] == 255


def test_corners_lose_light_and_warm_light_is_red():
    corner = shown(replace(STILL, vignetting=0.3))
    assert corner[30, 40, 0] == shown()[30, 40, 0]
    assert corner[0, 0, 0] < corner[30, 40, 0] - 10
    red, green, blue = shown(replace(STILL, warmth=1.0))[30, 40]
    assert red > green > blue


def test_a_blur_keeps_the_light_and_has_the_width_that_is_asked_for():
    spot = np.zeros((61, 61, 3), dtype=np.float32)
    spot[30, 30] = 1
    for sigma in (0.5, 1.1, 2.0):
        spread = blurred(spot, sigma)[..., 0]
        assert spread.sum() == pytest.approx(1, rel=1e-5)
        assert (spread.sum(axis=0) * (np.arange(61) - 30) ** 2).sum() == pytest.approx(sigma**2, rel=1e-4)
    assert blurred(spot, 0.0) is spot


def test_noise_has_the_deviation_that_is_asked_for_and_differs_between_colours():
    field = noise(stream(1, "noise"), 100, 120)
    assert field.std() == pytest.approx(1, abs=0.03)
    between = np.corrcoef(field.reshape(-1, 3).T)
    assert 0.5 < between[0, 1] < 0.8
    assert shown(replace(STILL, noise=4.0)).std() == pytest.approx(4, abs=0.6)
