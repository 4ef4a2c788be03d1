"""Patterns belong to their place, and fade where they are finer than a pixel."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.simulator.views.surfaces.materials import FacePoints, Material
from algorithms.simulator.views.surfaces.noise import lattice, rough, smooth
from algorithms.simulator.views.surfaces.patterns import PATTERNS
from algorithms.simulator.views.surfaces.pictures import ON_WALLS, painted_picture


def face(n: int, grain: float) -> FacePoints:
    u, v = (
        grid.ravel().astype(np.float32)
        for grid in np.meshgrid(np.linspace(0.001, 0.999, n), np.linspace(0, 2, n))
    )
    return FacePoints(u, v, np.full_like(u, 1.0), np.full_like(u, 2.0), np.full_like(u, grain))


@pytest.mark.parametrize("name", [name for name in PATTERNS if name != "picture"])
def test_a_pattern_is_one_of_colours_and_the_same_each_time(name):
    material = Material(name, (0.6, 0.5, 0.4), (0.2, 0.3, 0.4), (0.4, 0.3), seed=5)
    first, again = (PATTERNS[name](material, face(40, 0.003)) for _ in range(2))
    assert first.shape == (1600, 3)
    assert np.array_equal(first, again)
    assert -0.01 <= first.min() <= first.max() < 1.6


@pytest.mark.parametrize("name", ["carpet", "boards", "fabric", "tiles"])
def test_what_is_finer_than_a_pixel_is_not_seen(name):
    material = Material(name, (0.6, 0.5, 0.4), (0.2, 0.3, 0.4), (0.5, 0.5), seed=5)
    near, far = (PATTERNS[name](material, face(80, grain)) for grain in (0.001, 0.5))
    rough_near, rough_far = (
        np.abs(np.diff(shown[:, 0].reshape(80, 80), axis=0)).mean() for shown in (near, far)
    )
    assert rough_far < rough_near


def test_noise_lies_between_0_and_1_and_is_smooth_where_it_is_called_so():
    x = np.linspace(-20, 20, 4001)
    for noise in (smooth(x, x * 0.3, 2), rough(x, -x, 3)):
        assert 0 <= noise.min() < 0.35
        assert 0.65 < noise.max() <= 1
        assert np.abs(np.diff(noise)).max() < 0.1
    i = np.arange(-300, 300)
    assert 0.45 < lattice(i, 7).mean() < 0.55
    assert np.array_equal(smooth(i * 1.0, i * 0.0), lattice(i, 0))


@pytest.mark.parametrize("kind", ON_WALLS)
def test_what_hangs_on_walls_is_as_large_as_it_says(kind):
    picture, width, height = painted_picture(kind, 1)
    assert picture.dtype == np.uint8
    assert picture.shape[0] / picture.shape[1] == pytest.approx(height / width, rel=0.05)
    assert picture.std() > 3
