"""Boxes are buttons over the image, and lines below it; every word in them is escaped."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from looked_at import CAMERA, looked_at

from algorithms.common.pose import Pose2
from algorithms.detection.robot_sighting import SightedRobots
from app.drawing.palette import DARK, LIGHT
from app.drawing.sighting_picture import STRIP
from app.page.sighting.sighting_html import boxes_html, gradients_html, picture_html
from app.page.sighting.sighting_look import Look


@pytest.fixture
def found() -> Look:
    seen, view = looked_at(Pose2(2.5, 0.4, 0.3))
    return Look(np.full((480, 640, 3), 90, np.uint8), 640, 480, CAMERA, view, seen)


def style(html: str) -> dict[str, float]:
    """Per cent of each side of the first button."""
    return {side: float(value) for side, value in re.findall(r"(left|top|width|height):([\d.]+)%", html)[:4]}


def test_a_button_lies_over_its_box(found):
    box, high = found.seen.sighted[0].detection, 480 + STRIP * 640
    at = style(picture_html(found, 0, LIGHT))
    assert at["left"] == pytest.approx(100 * box.left / 640, abs=0.01)
    assert at["top"] == pytest.approx(100 * box.top / high, abs=0.01)
    assert at["width"] == pytest.approx(100 * box.width / 640, abs=0.01)
    alone = style(picture_html(replace(found, view=None), 0, LIGHT))
    assert alone["top"] == pytest.approx(100 * box.top / 480, abs=0.01)


def test_a_box_that_reaches_out_of_the_image_is_cut_off(found):
    (one,) = found.seen.sighted
    wide = replace(one, detection=replace(one.detection, left=-50.0, right=900.0, top=-9.0, bottom=999.0))
    at = style(picture_html(replace(found, seen=SightedRobots((wide,), 0)), 0, LIGHT))
    assert (at["left"], at["top"], at["width"]) == (0, 0, 100)
    assert at["height"] == pytest.approx(100 * 480 / (480 + STRIP * 640), abs=0.01)


def test_the_smaller_one_of_two_boxes_lies_on_top(found):
    (one,) = found.seen.sighted
    large = replace(one, detection=replace(one.detection, left=0.0, right=600.0))
    html = picture_html(replace(found, seen=SightedRobots((one, large), None)), None, LIGHT)
    assert html.index('data-mm-box="1"') < html.index('data-mm-box="0"')


def test_what_is_chosen_possible_and_refused_is_told_apart(found):
    (one,) = found.seen.sighted
    refused = replace(one, position=None, why_not="<b>too wide</b>")
    html = boxes_html(SightedRobots((one, refused, one), 0), 1, 7)
    assert re.findall(r'data-state="(\w+)"', html) == ["chosen", "refused", "possible"]
    assert re.findall(r'aria-pressed="(\w+)"', html) == ["false", "true", "false"]
    assert "Refused: &lt;b&gt;too wide" in html
    assert "97.0%" in html
    assert "7 more" in html


def test_a_single_box_asks_for_no_choice_and_none_leaves_nothing(found):
    assert "Press a box" not in boxes_html(found.seen, 0, 0)
    assert boxes_html(SightedRobots((), None), None, 0) == ""


def test_every_button_says_what_it_is(found):
    html = picture_html(found, 0, DARK)
    assert re.search(r'aria-label="box 1: front or back, 97.0%: 2.5', html)
    assert 'alt="What robot 1&#x27;s camera saw, and below it the laser&#x27;s points"' in html


def test_both_views_of_the_detector_are_shown():
    assert gradients_html((b"a", b"b")).count("data:image/jpeg;base64,") == 2
