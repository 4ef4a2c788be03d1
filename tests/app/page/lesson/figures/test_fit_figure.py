"""Pictures in the hand: a handle stands where its sliders say, and the picture tells of that place."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from math import atan2, degrees, hypot
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.drawing.palette import DARK, LIGHT
from app.page.lesson.figures.figure_registry import PICTURES, OtherWay
from app.page.lesson.figures.figure_slider import place_of, shown
from app.page.lesson.figures.fit_figure import ALONG_X, ALONG_Y, TURN, fit
from app.page.lesson.figures.search_figures import best_of
from app.page.lesson.lesson_run import LessonRun

HELD = [
    ("observation", "laid"),
    ("augmentation", "ring"),
    ("hough", "wave"),
    ("window", "origins"),
    ("objective", "fit"),
    ("verdict", "without"),
]
PIXELS = 0.1  # to which a handle's place is written


def told(svg: str) -> dict[int, tuple[float, float]]:
    """What each handle says of its sliders, as lesson.js works it out, and how much that is within PIXELS."""
    said: dict[int, tuple[float, float]] = {}
    for circle in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}circle"):
        if "data-mm-grip" not in circle.attrib:
            continue
        x, y = float(circle.get("cx", "")), float(circle.get("cy", ""))
        moves = json.loads(circle.get("data-mm-grip", ""))
        for axis, at in (("x", x), ("y", y)):
            if axis in moves:
                dial, p, u, q, v = moves[axis]
                said[dial] = u + (at - p) / (q - p) * (v - u), abs(PIXELS / (q - p) * (v - u))
        if "r" in moves:
            dial, cx, cy, scale = moves["r"]
            said[dial] = hypot(x - cx, y - cy) * scale, 2 * PIXELS * scale
        if "a" in moves:
            dial, cx, cy, zero, least = moves["a"]
            off = degrees(atan2(cy - y, x - cx)) - zero - least
            said[dial] = least + off % 360, degrees(2 * PIXELS / hypot(x - cx, y - cy))
    return said


def drawn(lesson: LessonRun, way: OtherWay, places: Sequence[int], palette=LIGHT) -> str:
    return way.draw(lesson, places, palette)


@pytest.mark.parametrize(("picture", "way"), HELD)
@settings(max_examples=8, deadline=None)
@given(data=st.data())
def test_a_handle_stands_where_its_sliders_say(lesson, picture, way, data):
    held = PICTURES[picture].ways[way]
    assert held.dials
    places = [data.draw(st.integers(0, dial.count - 1)) for dial in held.dials]
    handles = told(drawn(lesson, held, places))
    assert set(handles) == set(range(len(held.dials)))
    for number, (value, slack) in handles.items():
        dial, place = held.dials[number], places[number]
        turned = dial.count == 361 and abs(abs(value) - 180) < 1  # half a turn either way is one place
        assert turned or value == pytest.approx(shown(dial, place), abs=slack + 1e-6)
        assert turned or abs(place_of(dial, value) - place) <= slack / dial.step + 0.5


@pytest.mark.parametrize(("picture", "way"), HELD)
def test_a_picture_in_the_hand_is_whole_at_every_end_light_and_dark(lesson, picture, way):
    held = PICTURES[picture].ways[way]
    for palette in (LIGHT, DARK):
        for ends in ([0 for _ in held.dials or ()], [dial.count - 1 for dial in held.dials or ()]):
            svg = drawn(lesson, held, ends, palette)
            assert not re.search(r"[\"(, ]nan\b", svg)
            assert ElementTree.fromstring(svg).tag.endswith("svg")


def test_both_bars_are_whole_where_the_method_found_its_answer_and_short_elsewhere(lesson):
    """Within what half a step of each slider moves."""
    T, met = best_of(lesson), lesson.inputs.encounters[0]
    x, y = (T.apply(met.x_mov) - met.x_ref).tolist()
    best = [place_of(dial, value) for dial, value in ((ALONG_X, x), (ALONG_Y, y), (TURN, degrees(T.theta)))]

    def agreement(places: Sequence[int]) -> float:
        text = re.search(r"agreement: (−?[0-9.]+)", fit(lesson, places, LIGHT))
        assert text is not None
        return float(text[1].replace("−", "-"))

    top = agreement(best)
    assert top > 0
    for aside in ((10, 0, 0), (0, -10, 0), (0, 0, 25)):
        moved = [
            min(d.count - 1, max(0, b + a))
            for d, b, a in zip((ALONG_X, ALONG_Y, TURN), best, aside, strict=True)
        ]
        assert agreement(moved) < top
