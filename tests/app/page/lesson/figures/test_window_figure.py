"""What the sighting leaves, by geometry: where the circle lies, what contains it, and what falls into it."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import cv2
import numpy as np
import pytest
from looks import lesson_of
from svg_shapes import dots, lines

from algorithms.common.pose import rotation
from algorithms.methods.steps import CandidatesDetail, WindowDetail
from app.drawing.palette import LIGHT
from app.drawing.scene.search_symbols import windows
from app.drawing.scene_layout import lay_out
from app.page.lesson.figures.window_figure import TURNS, best_turn, origins, window
from app.page.lesson.lesson_run import LessonRun

BETWEEN = 214.0  # pixels: the plot of map 1 lies to the left of it, the one from near by to the right


def box_of(path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle and half the sides of what a path encloses."""
    low, high = path.min(axis=0), path.max(axis=0)
    return (low + high) / 2, (high - low) / 2


def square_of(drawn: str) -> tuple[np.ndarray, np.ndarray]:
    (square,) = (path for path in lines(drawn, LIGHT.conflict) if len(path) == 4)
    return box_of(square)


@pytest.fixture(scope="module")
def far_off(small_case) -> LessonRun:
    """Map 2's origin is far from the meeting place, as in a large building."""
    mov, seen = small_case.mov, small_case.observations[0]
    moved = replace(mov, origin=replace(mov.origin, x=mov.origin.x + 21, y=mov.origin.y - 13))
    seen = replace(seen, observed_x=seen.observed_x + 21, observed_y=seen.observed_y - 13)
    return lesson_of(replace(small_case, mov=moved, observations=(seen,), truth=None), sides={})


def test_picture_and_map_show_the_same_square_at_the_same_place_about_the_circle(far_off):
    drawn = window(far_off, (), LIGHT)
    middle, half = square_of(drawn)
    (x_hat,) = (dot for dot in dots(drawn, LIGHT.best) if dot[0] < BETWEEN)
    inputs, detail = far_off.inputs, far_off.get(WindowDetail)
    layout = lay_out(inputs.ref, inputs.mov, inputs.at)
    turn = far_off.run_until(CandidatesDetail).at_hand.T_ref_mov.theta
    on_map, disc, *_ = windows(detail, turn, layout, LIGHT, layout.view())
    its_middle, its_half = box_of(on_map["p"][:, :2])
    assert (middle - x_hat) / half * (1, -1) == pytest.approx(its_middle / its_half, abs=0.02)
    assert (np.abs(its_middle) + box_of(disc["p"][:, :2])[1] < its_half).all()


def test_the_circle_lies_about_the_meeting_place_and_every_candidate_puts_robot_2_into_it(far_off):
    drawn = window(far_off, (), LIGHT)
    circle = max(
        (path for path in lines(drawn, LIGHT.best) if len(path) > 8), key=lambda path: np.ptp(path[:, 0])
    )
    (x_hat,) = dots(drawn, LIGHT.conflict)
    assert box_of(circle)[0] == pytest.approx(x_hat, abs=0.2)
    *tried, _legend = (dot for dot in dots(drawn, LIGHT.particle) if dot[0] > BETWEEN)
    assert len(tried) == len(far_off.get(CandidatesDetail).candidates)
    ring = circle.astype(np.float32)
    assert all(cv2.pointPolygonTest(ring, dot.tolist(), True) > -1 for dot in tried)


@pytest.mark.parametrize("place", [0, 5, TURNS - 1])
def test_map_2s_origin_runs_round_a_ring_that_the_papers_square_encloses(far_off, place):
    drawn = origins(far_off, (place,), LIGHT)
    middle, half = square_of(drawn)
    ring = next(path for path in lines(drawn, LIGHT.best) if len(path) > 300)
    ring_middle, ring_half = box_of(ring)
    assert ring_middle == pytest.approx(middle, abs=0.2)
    coupled, paper = (getattr(far_off.get(WindowDetail), name) for name in ("coupled", "paper"))
    lever = hypot(*coupled.pivot.tolist())
    pixels = half / ((paper.high - paper.low) / 2)  # of the sheet, to a metre
    assert ring_half == pytest.approx(lever * pixels, abs=0.2)
    assert (ring_half < half).all()
    origin = next(dot for dot in dots(drawn, LIGHT.best) if dot[0] < BETWEEN)
    turn = best_turn(far_off) + np.radians(place * 360 / TURNS)
    goes_to = (origin - middle) * (1, -1) / pixels + rotation(turn) @ coupled.pivot
    assert goes_to == pytest.approx(0, abs=0.3)  # x̂₂ comes to lie on x̂₁
