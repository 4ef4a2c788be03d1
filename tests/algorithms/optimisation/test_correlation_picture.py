"""The picture of a surface: its brightest pixel is the highest hill, at its place, however it is pooled."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from drawn import drawn_map, flat_pair
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.maps.coarse_grid import trimmed
from algorithms.observations.pair_problem import Known, PairProblem
from algorithms.observations.priors import InitialPose
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.correlation_picture import CorrelationPicture, picture_of
from algorithms.optimisation.plane_correlation import PlaneConfig, PlaneCorrelation

REF, MOV, _, T_TRUE = flat_pair()
TILTED = drawn_map(Pose2(1.0, -2.0, 0.7), origin_yaw=0.4)  # its rows do not run along its frame's axes
PAIRS = {"as they are": (REF, MOV), "swapped": (MOV, REF), "tilted": (TILTED, MOV)}
PLANES = {
    name: (PlaneCorrelation(trimmed(ref), trimmed(mov), PlaneConfig()), ref, mov)
    for name, (ref, mov) in PAIRS.items()
}


def seen(
    name: str, turn: float, pixels: int = 128, known: tuple[Known, ...] = ()
) -> tuple[CorrelationPicture | None, np.ndarray]:
    """The picture of a turn of a pair, and the poses of its hills."""
    plane, ref, mov = PLANES[name]
    config = WindowConfig(kind="coupled", deviations=3.5)
    window = PairProblem.of(ref, mov, known).window(config, curved=True)
    look = plane.look(turn, window, 5)
    return picture_of(plane, look, pixels), look.poses


@given(st.sampled_from(sorted(PLANES)), st.floats(-pi, pi), st.integers(8, 160))
def test_the_brightest_pixel_is_where_the_highest_hill_is_and_no_pixel_is_more_than_asked_for(
    name, turn, pixels
):
    picture, hills = seen(name, turn, pixels)
    rows, cols = picture.values.shape
    row, col = np.unravel_index(np.nanargmax(picture.values), (rows, cols))
    middle = picture.low + (np.array([col, row]) + 0.5) * picture.pixel
    assert np.abs(middle - hills[0, :2]).max() <= 1.5 * picture.pixel  # it may lie askew in two rasters
    assert picture.hills == pytest.approx(hills[:, :2])
    assert ((picture.low <= picture.hills) & (picture.hills <= picture.high)).all()
    assert max(rows, cols) <= 2**0.5 * pixels + 2  # of a tilted surface the corners stand out


def test_what_is_known_leaves_only_its_own_shifts_in_the_picture():
    rough = InitialPose(T_TRUE, 0.5, 0.5, 0.1)
    turn = float(
        PLANES["as they are"][0].turns[np.abs(PLANES["as they are"][0].turns - T_TRUE.theta).argmin()]
    )
    whole, _ = seen("as they are", turn)
    narrow, hills = seen("as they are", turn, known=(rough,))
    assert np.isfinite(whole.values).all()
    assert narrow.pixel <= whole.pixel
    assert (narrow.high - narrow.low < (whole.high - whole.low) / 2).all()
    assert np.nanmax(narrow.values) == np.nanmax(whole.values)
    assert np.hypot(*(hills[0, :2] - (T_TRUE.x, T_TRUE.y))) < 0.3


def test_a_turn_that_cannot_be_has_no_picture():
    away = InitialPose(T_TRUE, 0.5, 0.5, 0.1)
    picture, _ = seen("as they are", T_TRUE.theta + pi, known=(away,))
    assert picture is None
