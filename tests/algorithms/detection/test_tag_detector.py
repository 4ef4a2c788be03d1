"""Tags are read, and a tag of known size tells its distance."""

from __future__ import annotations

from math import atan2, hypot, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tagged_pictures import CAMERA, SIZE, picture_of

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.detection.footprint import Footprint
from algorithms.detection.robot_sighting import sight_by_tags
from algorithms.detection.tag_detector import TagDetector, position_by_tag
from algorithms.sensors.camera import Camera


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 100), st.floats(0.8, 3.0), st.floats(-0.3, 0.3), st.floats(-0.6, 0.6))
def test_a_tag_is_read_and_its_distance_is_told(number, x, side, turn):
    y = side * x
    found = TagDetector("36h11", SIZE).detect(picture_of([(number, x, y, turn)]), CAMERA)
    assert [one.label for one in found] == [f"tag {number}"]
    assert abs(found[0].tag.distance - hypot(x, y)) < 4 * found[0].tag.sigma + 0.01
    assert CAMERA.bearings(np.array([found[0].middle[0]]))[0] == pytest.approx(atan2(y, x), abs=0.02)


def test_the_centre_of_the_robot_is_behind_its_tag():
    body = Footprint(0.4, 0.4)
    (one,) = TagDetector("36h11", SIZE).detect(picture_of([(3, 1.5, 0.2, 0.0)]), CAMERA)
    seen = position_by_tag(one, CAMERA, body)
    assert seen.point() == pytest.approx([1.7, 0.2], abs=3 * seen.sigma_range + 0.02)


def test_a_turned_camera_turns_the_bearing():
    turned = Camera(640, 480, (520.0, 520.0), (319.5, 239.5), mounting=Pose2(0.0, 0.0, pi / 2))
    picture = picture_of([(3, 1.5, 0.0, 0.0)])
    (one,) = TagDetector("36h11", SIZE).detect(picture, turned)
    assert position_by_tag(one, turned, Footprint()).bearing == pytest.approx(pi / 2, abs=0.01)


def test_two_tags_of_one_robot_are_one_sighting_and_two_robots_are_refused():
    detector = TagDetector("36h11", SIZE)
    one_robot = detector.detect(picture_of([(0, 1.5, 0.1, 0.0), (1, 1.6, -0.2, 0.7)]), CAMERA)
    assert len(one_robot) == 2
    assert sight_by_tags(one_robot, CAMERA, Footprint()).position is not None
    two = detector.detect(picture_of([(0, 1.5, 0.45, 0.0), (1, 1.6, -0.45, 0.0)]), CAMERA)
    refused = sight_by_tags(two, CAMERA, Footprint())
    assert refused.position is None
    assert "several robots" in refused.reason
    assert sight_by_tags(two, CAMERA, Footprint(), pick=1).position is not None


def test_without_its_size_a_tag_tells_no_distance():
    found = TagDetector("36h11").detect(picture_of([(3, 1.5, 0.0, 0.0)]), CAMERA)
    assert found[0].tag is None
    refused = sight_by_tags(found, CAMERA, Footprint())
    assert "give the laser's scan, or the tag's size" in refused.reason


def test_a_tag_of_another_family_and_a_mirrored_one_are_none():
    picture = picture_of([(3, 1.5, 0.0, 0.0)])
    assert TagDetector("aruco-6x6", SIZE).detect(picture, CAMERA) == ()
    assert TagDetector("36h11", SIZE).detect(np.ascontiguousarray(picture[:, ::-1]), CAMERA) == ()


@pytest.mark.parametrize("family", ["48h12", ""])
def test_a_family_that_is_not_known_is_told(family):
    with pytest.raises(SettingError, match="no family of tags"):
        TagDetector(family)


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, 99.0])
def test_a_size_that_no_tag_has_is_told(size):
    with pytest.raises(SettingError, match="tag's size"):
        TagDetector("36h11", size)
