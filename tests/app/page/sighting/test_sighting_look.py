"""One look: what a person is shown of it, and when it is out of date."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, degrees, hypot

import numpy as np
import pytest
from tagged_pictures import ASIDE, CAMERA, NEAR, SIZE, sighting_files

from algorithms.common.pose import Pose2
from algorithms.detection.hog_grid import WindowShape
from algorithms.detection.svm_detector import DetectorModel
from algorithms.files.camera_picture import picture_from_bytes, picture_to_png
from algorithms.files.scan_file import scan_from_bytes
from app.model.merge_inputs import Upload
from app.model.sighting.look_settings import LookSettings
from app.page.sighting.sighting_look import WIDEST, LookOrder, look

TAGS = LookSettings("tags")
SHAPE = WindowShape(7, 7, 6)


def everywhere(chance_from: float) -> DetectorModel:
    """A model that takes every window for a robot, as likely as that."""
    return DetectorModel(
        SHAPE,
        ("robot",),
        np.zeros((1, SHAPE.length), np.float32),
        np.array([chance_from], np.float32),
        np.array([[1.0, 0.0]], np.float32),
        np.zeros((1, SHAPE.length), np.float32),
        np.zeros(1, np.float32),
    )


def order_of(*robots, settings=TAGS, **more) -> LookOrder:
    files = sighting_files(*robots)
    scan = scan_from_bytes("scan.yaml", files["scan.yaml"])
    return LookOrder(Upload("seen.png", files["seen.png"]), CAMERA, scan, None, settings, **more)


def test_a_robot_is_found_where_it_stands():
    found = look(None, order_of(NEAR))
    assert found.seen.chosen == 0
    position = found.seen.position
    assert abs(position.range - hypot(*NEAR)) < 4 * position.sigma_range + 0.01
    assert position.bearing == pytest.approx(atan2(NEAR[1], NEAR[0]), abs=0.01)
    assert (found.width, found.height) == (640, 480)
    assert found.gradients == ()  # tags have none


def test_another_box_can_be_chosen_and_a_refused_one_is_no_sighting():
    found = look(None, order_of(NEAR, ASIDE))
    assert found.seen.position is None
    ranges = [found.choosing(k).seen.position.range for k in range(2)]
    assert ranges == pytest.approx([hypot(*ASIDE), hypot(*NEAR)], abs=0.03)  # the larger box first
    flat = look(None, replace(order_of(NEAR), scan=order_of().scan))
    assert flat.choosing(0).seen.position is None
    assert flat.choosing(0).seen.reason == flat.seen.sighted[0].why_not


def test_a_tag_of_known_size_needs_no_scan_and_has_no_strip():
    settings = LookSettings("tags", tag_size=SIZE)
    found = look(None, replace(order_of(NEAR, settings=settings), scan=None))
    assert found.view is None
    assert found.seen.position.range == pytest.approx(hypot(*NEAR), abs=0.15)


def test_without_a_calibration_the_field_of_view_makes_the_camera():
    settings = LookSettings("tags", field_of_view=1.1)
    found = look(None, replace(order_of(NEAR, settings=settings), camera=None))
    assert found.camera.degrees_wide() == pytest.approx(degrees(1.1))
    assert found.seen.position is not None  # the box only chooses among the laser's points


def test_of_many_boxes_the_likeliest_are_shown_with_their_gradients(monkeypatch):
    monkeypatch.setattr("app.page.sighting.sighting_look.MOST_BOXES", 3)
    settings = LookSettings("own", least_probability=0.3)
    found = look(None, replace(order_of(NEAR, settings=settings), model=everywhere(0.0)))
    assert len(found.seen.sighted) == 3 == len(found.gradients)
    assert found.more > 0
    view, edges = (picture_from_bytes("", jpeg) for jpeg in found.gradients[0])
    assert view.shape == edges.shape


def test_a_large_image_is_shown_smaller_and_a_small_one_as_it_is():
    large = picture_to_png(np.zeros((1200, 1920, 3), np.uint8))
    order = replace(order_of(settings=LookSettings("tags", field_of_view=1.0)), camera=None)
    found = look(None, replace(order, picture=Upload("large.png", large)))
    assert found.photo.shape == (600, WIDEST, 3)
    assert (found.width, found.height) == (1920, 1200)
    assert look(None, order).photo.shape == (480, 640, 3)


def test_the_walls_of_map_1_count_where_the_robots_place_is_known(small_case):
    order = order_of(NEAR, grid=small_case.ref)
    assert look(None, order).seen.position is not None
    placed = replace(order, observer=small_case.observations[0].observer)
    assert "the map has a wall before it" in look(None, placed).seen.reason


def test_an_order_is_the_same_as_long_as_nothing_that_counts_changes(small_case):
    order = order_of(NEAR, grid=small_case.ref, observer=Pose2())
    assert order.same_as(replace(order))
    for change in (
        {"settings": LookSettings("tags", tag_size=0.1)},
        {"observer": Pose2(1.0)},
        {"grid": None},
        {"picture": Upload("seen.png", b"other")},
    ):
        assert not order.same_as(replace(order, **change))
