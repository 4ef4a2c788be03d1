"""What a picture shows: the right things, at the right place, the same every time."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sights import CAMERA, HEIGHT, OBSERVER, STILL, bare_room, extent, scene_with, seen

from algorithms.common.pose import Pose2
from algorithms.sensors.camera import Camera
from algorithms.simulator.portable_random import stream
from algorithms.simulator.views.camera_image import camera_rays, viewpoint
from algorithms.simulator.views.light import Light, draw_light
from algorithms.simulator.views.projection import box_of, face_seen, projected, seen_share
from algorithms.simulator.views.robot_body import FRONT_BACK, SIDE, RobotBody
from algorithms.simulator.views.solids import Solid
from algorithms.simulator.views.surfaces.materials import Material
from algorithms.simulator.views.view_scene import Mirror, Poster

BARE = RobotBody(top="bare")
places = st.tuples(st.floats(1.2, 5.0), st.floats(-0.4, 0.4), st.floats(-3.1, 3.1))


def robot_at(far: float, off: float, turn: float) -> Pose2:
    """A robot at a distance and a bearing of the observer."""
    return OBSERVER @ Pose2(far * np.cos(off), far * np.sin(off), turn)


@settings(max_examples=15)
@given(places)
def test_a_robot_fills_the_box_of_its_projected_corners_and_its_middle_lies_in_it(place):
    pose = robot_at(*place)
    shown = seen(scene_with((pose, BARE)))
    u0, v0, u1, v1 = box_of(viewpoint(OBSERVER, CAMERA, HEIGHT), CAMERA, BARE, pose)
    left, top, right, bottom = extent(shown.robot == 0)
    assert max(abs(left - u0), abs(top - v0), abs(right - u1)) < 2.5
    assert v1 - 10 < bottom < v1 + 1  # its wheels stand under its boards
    middle = projected(viewpoint(OBSERVER, CAMERA, HEIGHT), CAMERA, np.array([[pose.x, pose.y, 0.25]]))[0]
    assert u0 < middle[0] < u1
    assert v0 < middle[1] < v1


@settings(max_examples=15)
@given(st.floats(1.5, 3.5))
def test_a_robot_twice_as_far_is_half_as_tall(far):
    tall = []
    for face in (far, 2 * far):  # of its front, which looks at the camera
        pose = robot_at(face + BARE.length / 2, 0.0, np.pi)
        _, top, _, bottom = extent(seen(scene_with((pose, BARE))).robot == 0)
        tall.append(bottom - top + 1)
    assert tall[0] == pytest.approx(2 * tall[1], abs=2.5)


def test_a_robot_to_the_left_is_at_the_left_of_the_image_and_upright():
    shown = seen(scene_with((robot_at(2.5, 0.3, np.pi), RobotBody())))
    left, top, right, bottom = extent(shown.robot == 0)
    assert right < 160
    assert top < 119 < bottom  # the camera's height is below its boards' upper edge, and above the floor
    board = shown.image[119, left:right]
    assert board.min() < 60  # the tag
    assert board.max() > 150  # the paper


def test_distortion_moves_a_robot_as_it_moves_its_projection():
    camera = Camera(320, 240, (240.0, 240.0), (159.5, 119.5), (-0.2, 0.03, 0.0, 0.0))
    pose = robot_at(2.0, 0.42, 0.5)
    shown = seen(scene_with((pose, BARE)), camera=camera)
    box = box_of(viewpoint(OBSERVER, camera, HEIGHT), camera, BARE, pose)
    assert np.abs(np.array(extent(shown.robot == 0)) - box)[:3].max() < 2.5
    straight = box_of(viewpoint(OBSERVER, CAMERA, HEIGHT), CAMERA, BARE, pose)
    assert abs(straight[0] - box[0]) > 5


def test_the_rays_between_those_that_the_camera_is_asked_for_are_its_own():
    camera = Camera(160, 120, (110.0, 112.0), (80.0, 61.0), (-0.2, 0.03, 0.001, -0.002))
    rays = camera_rays(camera)
    v, u = np.indices((120, 160))
    exact = camera.rays(np.stack([u, v], axis=-1).reshape(-1, 2).astype(float)).reshape(120, 160, 2)
    assert np.abs(np.stack([rays.right, rays.down], axis=-1) - exact).max() * 110 < 0.05  # pixels


def test_what_a_wall_hides_is_not_in_the_image():
    pose = robot_at(3.0, 0.0, 0.3)
    wall = bare_room((3.4, 3.0, 3.6, 5.0))
    assert not (seen(scene_with((pose, BARE), building=wall)).robot == 0).any()
    half = bare_room((3.4, 4.0, 3.6, 5.0))
    share, pixels = seen_share(scene_with((pose, BARE), building=half), 0, OBSERVER, CAMERA, HEIGHT)
    assert 0.3 < share < 0.7
    shown = seen(scene_with((pose, BARE), building=half)).robot == 0
    assert shown.sum() == pytest.approx(pixels, rel=0.1)
    assert not shown[:, :158].any()  # the wall is at the left


def test_a_box_before_a_robot_hides_what_lies_behind_it():
    pose = robot_at(3.0, 0.0, 0.3)
    low = Solid(3.5, 4.0, 0.3, 1.0, 0.0, 0.25, (Material("carton"),))
    free, hidden = seen(scene_with((pose, BARE))), seen(scene_with((pose, BARE), things=(low,)))
    assert 0.2 < (hidden.robot == 0).sum() / (free.robot == 0).sum() < 0.8
    assert extent(hidden.robot == 0)[1] == extent(free.robot == 0)[1]  # its upper edge


def test_a_mirror_shows_a_robot_at_the_mirrored_place():
    mirror = Mirror((4.5, 7.4), (6.5, 7.4), top=2.4)
    assert np.allclose(mirror.normal(), [0, -1])
    observer, pose = Pose2(4.0, 5.4, 0.9), Pose2(6.3, 4.9, 0.4)
    shown = seen(scene_with((pose, BARE), mirrors=(mirror,)), observer)
    assert not (shown.robot == 0).any()
    line = 7.4 - 0.02  # the mirror's face
    image = Pose2(pose.x, 2 * line - pose.y, -pose.theta)
    box = box_of(viewpoint(observer, CAMERA, HEIGHT), CAMERA, BARE, image)
    assert np.abs(np.array(extent(shown.mirrored_robot == 0)) - box)[:3].max() < 2.5


def test_writing_in_a_mirror_is_the_wrong_way_round():
    mirror, body = Mirror((3.4, 7.4), (6.6, 7.4), top=2.4), RobotBody(tags=(5, 5, 5, 5), top="bare")
    camera = Camera(640, 480, (520.0, 520.0), (319.5, 239.5))
    scene = scene_with((Pose2(5.0, 5.6, np.pi / 2), body), mirrors=(mirror,))
    picture = seen(scene, Pose2(4.4, 6.0, 1.1), camera).image
    found = [detected(np.ascontiguousarray(image)) for image in (picture, picture[:, ::-1])]
    assert found == [[], [5]]


def test_a_picture_of_a_robot_on_a_wall_is_no_robot():
    picture = RobotBody().board(0)
    poster = Poster((11.4, 4.5), (11.4, 3.5), 0.1, 1.0, picture)
    shown = seen(scene_with(posters=(poster,)), Pose2(8.5, 4.0, 0.0))
    plain = seen(scene_with(), Pose2(8.5, 4.0, 0.0))
    assert (shown.robot == -1).all()
    assert np.abs(shown.image.astype(int) - plain.image).max() > 100
    middle = detected(np.ascontiguousarray(np.kron(shown.image, np.ones((2, 2, 1), dtype=np.uint8))))
    assert middle == [0]  # it is not the wrong way round


@pytest.mark.parametrize("face", range(4))
def test_the_tags_of_a_near_robot_are_read(face):
    turn = (np.pi, 0.0, np.pi / 2, -np.pi / 2)[face]
    camera = Camera(640, 480, (520.0, 520.0), (319.5, 239.5), (-0.15, 0.02, 0.0, 0.0))
    light = replace(STILL, blur=0.8, noise=3.0, vignetting=0.2)
    body = RobotBody(tags=(30, 31, 32, 33))
    picture = seen(scene_with((robot_at(2.0, 0.1, turn + 0.1), body), light=light), camera=camera).image
    assert 30 + face in detected(picture)


def detected(picture) -> list[int]:
    """Ids of the tags of a robot's family in an image."""
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    _, ids, _ = cv2.aruco.ArucoDetector(family).detectMarkers(picture)
    return [] if ids is None else sorted(ids.ravel().tolist())


def test_the_larger_face_is_told():
    view = viewpoint(OBSERVER, CAMERA, HEIGHT)
    for turn, kind in ((np.pi, FRONT_BACK), (0.2, FRONT_BACK), (np.pi / 2, SIDE), (-np.pi / 2 + 0.2, SIDE)):
        assert face_seen(view, CAMERA, BARE, robot_at(2.0, 0.0, turn)) == kind


def test_night_is_dark_and_good_light_is_not():
    scene = scene_with((robot_at(2.0, 0.0, 0.5), BARE))
    day, night = (
        seen(replace(scene, light=light)).image.mean()
        for light in (Light(), draw_light(stream(1, "x"), night=True))
    )
    assert night < 60 < 90 < day < 220


def test_one_seed_gives_one_picture_and_noise_is_all_that_another_changes():
    scene = scene_with((robot_at(2.0, 0.1, 0.5), BARE), light=Light(noise=3.0))
    first, again, other = (seen(scene, seed=seed).image for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert 0.5 < np.abs(first.astype(int) - other).mean() < 8


def test_the_floor_is_below_and_a_robot_throws_a_shadow_on_it():
    with_robot, without = (seen(scene_with(*robots)) for robots in ([(robot_at(2.0, 0.0, np.pi), BARE)], []))
    bottom = extent(with_robot.robot == 0)[3]
    below = np.s_[bottom + 2 : bottom + 5, 150:170]
    assert with_robot.image[below].mean() < without.image[below].mean() - 8
    above = np.s_[:60]
    assert np.array_equal(with_robot.image[above], without.image[above])
