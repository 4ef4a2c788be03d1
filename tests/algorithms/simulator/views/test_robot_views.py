"""Views that are drawn, and whether their truth is true."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.common.errors import SettingError
from algorithms.simulator.views.camera_image import viewpoint
from algorithms.simulator.views.hardships import HARDSHIPS
from algorithms.simulator.views.interiors.free_floor import free_floor
from algorithms.simulator.views.projection import projected
from algorithms.simulator.views.robot_views import RobotView, draw_view


def check_truth(view: RobotView) -> None:
    """Range, bearing and box belong to one another, and to the pose."""
    height, width = view.image.shape[:2]
    for robot in (*view.robots, *view.reflections):
        there = view.observer.inverse().apply(robot.pose.xy)
        assert np.hypot(*there) == pytest.approx(robot.range)
        assert np.arctan2(there[1], there[0]) == pytest.approx(robot.bearing)
        u0, v0, u1, v1 = robot.box
        assert 0 <= u0 < u1 <= width - 1
        assert 0 <= v0 < v1 <= height - 1
        eye = viewpoint(view.observer, view.camera, view.camera_height)
        middle = projected(eye, view.camera, np.array([[*robot.pose.xy, 0.25]]))[0]
        assert u0 < middle[0] < u1
        assert v0 < middle[1] < v1 or v1 == height - 1
        assert robot.face in ("front_back", "side")
        assert 0 < robot.share <= 1


def hit_robot(view: RobotView) -> int:
    """How many beams end at the first robot or its mirror image."""
    robot = (*view.robots, *view.reflections)[0]
    points = robot.pose.inverse().apply(view.observer.apply(view.scan.points()))
    off = np.abs(points) - [robot.body.length / 2, robot.body.width / 2]
    return int((np.abs(off.max(axis=1)) < 0.1).sum())


@pytest.mark.parametrize(("kind", "seed"), [("apartment", 1), ("home", 30), ("corridor", 14)])
def test_a_plain_view_shows_one_robot_that_stands_free(kind, seed):
    view = draw_view(seed, kind, robot=True, distance=(1.5, 4.0))
    check_truth(view)
    (robot,) = view.robots
    assert 1.5 <= robot.range <= 4.0
    assert robot.share > 0.9
    assert free_floor(view.scene.building).clear_of_walls(robot.pose.x, robot.pose.y) >= 0.5
    assert free_floor(view.scene.building).clear_of_walls(view.observer.x, view.observer.y) >= 0.35
    assert hit_robot(view) >= 4
    again = draw_view(seed, kind, robot=True, distance=(1.5, 4.0))
    assert np.array_equal(view.image, again.image)
    assert np.array_equal(view.scan.ranges, again.scan.ranges, equal_nan=True)


def test_a_view_without_a_robot_shows_none():
    view = draw_view(2, "home", robot=False)
    assert view.robots == view.reflections == ()
    assert view.image.std() > 5


@pytest.mark.parametrize("hardship", HARDSHIPS)
def test_each_hardship_is_what_it_is_called(hardship):
    view = draw_view(3, "apartment", robot=True, hardship=hardship)
    check_truth(view)
    counts = len(view.robots), len(view.reflections)
    assert counts == {"two robots": (2, 0), "mirror": (0, 1), "poster": (0, 0)}.get(hardship, (1, 0))
    building = view.scene.building
    if hardship == "beside wall":
        pose, body = view.robots[0].pose, view.robots[0].body
        wider = type(body)(length=body.length + 0.08, width=body.width + 0.08)
        assert free_floor(building).footprint_clear(body.footprint(pose))
        assert not free_floor(building).footprint_clear(wider.footprint(pose))
    elif hardship == "half hidden":
        assert 0.3 <= view.robots[0].share <= 0.7
    elif hardship == "night":
        assert view.image.mean() < 60
    elif hardship == "mirror":
        assert hit_robot(view) >= 1
    elif hardship == "poster":
        assert any(poster.robot for poster in view.scene.posters)


def test_views_of_one_building_differ():
    first, second = (draw_view(seed, "home", robot=False) for seed in (24, 25))
    assert first.scene.building is second.scene.building
    assert first.observer != second.observer


def test_what_cannot_be_drawn_is_told():
    with pytest.raises(SettingError, match="no hardship is called 'fog'"):
        draw_view(0, "home", robot=True, hardship="fog")
    with pytest.raises(SettingError, match="no building is called 'castle'"):
        draw_view(0, "castle", robot=True)
