"""Histograms of oriented gradients: scikit-image's numbers, and what they tell of an image."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skimage.feature import hog

from algorithms.detection.hog_grid import BLOCK, NUMBERS, ORIENTATIONS, hog_grid


@given(
    height=st.integers(16, 70), width=st.integers(16, 70), cell=st.integers(4, 8), seed=st.integers(0, 999)
)
@settings(max_examples=40, deadline=None)
def test_the_numbers_are_those_of_scikit_image(height, width, cell, seed):
    image = np.random.default_rng(seed).random((height, width), dtype=np.float32)
    theirs = hog(image, ORIENTATIONS, (cell, cell), (BLOCK, BLOCK), block_norm="L2-Hys", feature_vector=False)
    ours = hog_grid(image, cell)
    assert ours.shape == (*theirs.shape[:2], NUMBERS)
    assert ours == pytest.approx(theirs.reshape(ours.shape), abs=1e-5)


def test_an_even_image_has_no_direction_and_an_edge_has_one():
    image = np.zeros((32, 32), np.float32)
    assert not hog_grid(image, 8).any()
    image[:, 16:] = 1.0  # its gradient points to the right
    found = hog_grid(image, 8).reshape(3, 3, BLOCK * BLOCK, ORIENTATIONS)
    assert found[..., 0].any()
    assert not found[..., 1:].any()
