"""The surface as a drawing: each colour on its scale, axes in metres; what is not looked at is clear."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from algorithms.optimisation.correlation_picture import CorrelationPicture
from app.drawing.palette import VIRIDIS
from app.drawing.svg.correlation_plot import correlation_svg, surface_pixels

values = arrays.arrays(
    np.float32,
    st.tuples(st.integers(1, 9), st.integers(1, 9)),
    elements=st.one_of(st.just(float("nan")), st.floats(-50, 50, width=32)),
)


def picture(found: np.ndarray, hills: tuple[tuple[float, float], ...] = ()) -> CorrelationPicture:
    return CorrelationPicture(np.pi / 2, found, np.array([-3.0, 4.0]), 0.5, np.array(hills).reshape(-1, 2))


@given(values, st.floats(0.1, 60))
def test_a_brighter_pixel_is_never_worth_less_and_what_is_not_looked_at_is_clear(found, top):
    pixels = surface_pixels(picture(found), top)
    there = np.isfinite(found)
    assert ((pixels[..., 3] > 0) == there).all()
    level = {tuple(colour): k for k, colour in reversed([*enumerate(VIRIDIS.tolist())])}
    shown = np.array([level[tuple(colour)] for colour in pixels[there][:, :3].tolist()])
    assert (np.diff(shown[np.argsort(found[there], kind="stable")]) >= 0).all()
    assert (shown[found[there] <= 0] == 0).all()


def test_its_turn_its_axes_and_its_scale_are_written_beside_it():
    drawn = correlation_svg(picture(np.ones((8, 12), np.float32), ((0.0, 6.0),)), 25.67)
    for words in ("Δθ = 90.0°", "Δx (m)", "Δy (m)", "0 or less", "25.7 m of wall"):
        assert words in drawn
    assert drawn.count("<circle") == 2  # the hill, with a rim
    assert "<circle" not in correlation_svg(picture(np.ones((8, 12), np.float32)), 1.0)


@pytest.mark.parametrize("shape", [(1, 1), (300, 2), (2, 300)])
def test_a_surface_of_any_shape_keeps_a_metre_as_long_upwards_as_across(shape):
    drawn = correlation_svg(picture(np.zeros(shape, np.float32)), 1.0)
    image = drawn.split("<image ", 2)[1]
    wide, high = (float(image.split(f'{side}="')[1].split('"')[0]) for side in ("width", "height"))
    assert wide / high == pytest.approx(shape[1] / shape[0], rel=0.1)
