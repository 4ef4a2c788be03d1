"""The pictures of a sighting hold to its geometry, in each of their parts, and drawn in another way."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape
from math import atan2, degrees, hypot
from xml.etree import ElementTree

import numpy as np
import pytest
from looks import looked

from algorithms.detection.range_bearing import mean_of_points
from algorithms.files.case_folder import read_case
from algorithms.methods.registry import METHODS
from app.drawing.palette import DARK, LIGHT, css
from app.drawing.scene_layout import lay_out
from app.model.merge_inputs import MergeInputs
from app.page.lesson.figures.camera_figure import angle_text
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.figures.poster_figure import NARROW, opinions, poster
from app.page.lesson.figures.sighting_figure import (
    BOTH,
    HOW_FAR,
    PARTS,
    TITLES,
    WHAT,
    WHICH_WAY,
    counted,
    mean_taken,
    runs_of,
    sighting,
)
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.sighting_look import STAND_IN, SightingLook, look
from app.system import data_paths as paths

CONFIG = METHODS["spectra-proven"].defaults
PICTURE = PICTURES["sighting"]
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def lesson() -> LessonRun:
    """At a sample with a picture, which was looked at."""
    inputs = MergeInputs.of(read_case(paths.samples()[STAND_IN]))
    return LessonRun(inputs, CONFIG, sides={"sighting": looked(inputs, CONFIG)})


@pytest.fixture(scope="module")
def deceived() -> SightingLook:
    """A look at the poster."""
    (folder,) = paths.pictures().values()
    return look(folder, paths.samples()[STAND_IN])


def words(svg: str) -> str:
    return unescape(" | ".join(re.findall(r"<text[^>]*>([^<]*)</text>", svg)))


def dots(svg: str, colour, least: float = 0.0) -> np.ndarray:
    """(N, 2) middles of filled dots of a colour."""
    found = re.findall(rf'<circle cx="([-\d.]+)" cy="([-\d.]+)" r="([\d.]+)" fill="{css(colour)}"', svg)
    return np.array([[float(x), float(y)] for x, y, r in found if float(r) > least]).reshape(-1, 2)


def box(svg: str) -> np.ndarray:
    """(4, 2) corners of the box over the image."""
    way = re.search(rf'<path d="M([^"]+)Z" fill="none"[^>]*stroke="{css(LIGHT.mov)}"', svg).group(1)
    return np.array([[float(value) for value in point.split()] for point in way.split("L")])


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
@pytest.mark.parametrize("part", range(PARTS))
def test_every_part_is_whole_and_stays_on_its_sheet(lesson, part, palette):
    svg = sighting(lesson, (part,), palette)
    root = ElementTree.fromstring(svg)
    _, _, wide, high = map(float, root.attrib["viewBox"].split())
    assert TITLES[part] in words(svg)
    assert STAND_IN in words(svg)
    assert "nan" not in re.sub(r'base64,[^"]*', "", svg)
    for each in root.iter(f"{SVG}circle"):
        assert -1 < float(each.attrib["cx"]) < wide + 1
        assert -1 < float(each.attrib["cy"]) < high + 1
    for each in root.iter(f"{SVG}text"):
        assert 0 < float(each.attrib["y"]) <= high


def test_before_the_look_is_over_and_where_it_failed_that_is_told(lesson, small_case, monkeypatch):
    fresh = LessonRun(lesson.inputs, CONFIG)
    assert "the detector looks" in words(sighting(fresh, (0,), LIGHT))
    assert runs_of(fresh) is not runs_of(fresh)  # nothing is kept that has not begun
    monkeypatch.setattr(paths, "samples", dict)
    assert "No sample" in words(sighting(LessonRun(MergeInputs.of(small_case), CONFIG), (0,), LIGHT))


def test_the_laser_points_on_the_robot_lie_below_the_box_in_its_columns(lesson):
    svg = sighting(lesson, (WHICH_WAY,), LIGHT)
    corners, points = box(svg), dots(svg, LIGHT.mov)[:-1]  # the last one is the legend's
    assert len(points) == len(lesson.look.calibrated.one.cluster.beams)
    slack = 0.3 * np.ptp(corners[:, 0])
    assert (points[:, 0] > corners[:, 0].min() - slack).all()
    assert (points[:, 0] < corners[:, 0].max() + slack).all()
    assert (points[:, 1] > corners[:, 1].max()).all()


def test_both_bearings_are_told_and_the_way_that_counts_is_bold(lesson):
    one, readings = lesson.look.calibrated.one, (lesson.look.calibrated, lesson.look.counted)
    by_calibration, by_counting = (angle_text(each.bearing(*one.detection.middle)) for each in readings)
    assert by_calibration != by_counting
    for svg, bold in (
        (sighting(lesson, (WHICH_WAY,), LIGHT), by_calibration),
        (counted(lesson, (WHICH_WAY,), LIGHT), by_counting),
    ):
        assert by_calibration in words(svg)
        assert by_counting in words(svg)
        heavy = " | ".join(re.findall(r'font-weight="600"[^>]*>([^<]*)<', svg))
        assert bold in heavy
        assert ({by_calibration, by_counting} - {bold}).pop() not in heavy


def test_the_window_is_drawn_around_the_robot_and_its_edges_beside_it(lesson):
    svg = sighting(lesson, (WHAT,), LIGHT)
    first, second = (
        np.array([float(each.attrib[key]) for key in ("x", "y", "width", "height")])
        for each in ElementTree.fromstring(svg).iter(f"{SVG}image")
    )
    assert first[0] + first[2] < second[0]
    frames = [
        np.array([float(each.attrib[key]) for key in ("x", "y", "width", "height")])
        for each in ElementTree.fromstring(svg).iter(f"{SVG}rect")
        if each.attrib["stroke"] == css(LIGHT.mov)
    ]
    for image, frame in zip((first, second), frames, strict=True):
        assert frame[:2] + frame[2:] / 2 == pytest.approx(image[:2] + image[2:] / 2, abs=1)


def test_seen_from_above_the_centre_lies_behind_the_mean_and_the_directions_of_the_box_hold_both(lesson):
    look = lesson.look
    svg = sighting(lesson, (HOW_FAR,), LIGHT)
    root = ElementTree.fromstring(svg)
    rings = [
        np.array([float(each.attrib["cx"]), float(each.attrib["cy"])])
        for each in root.iter(f"{SVG}circle")
        if each.attrib["stroke"] == css(LIGHT.ref) and each.attrib["fill"] == "none"
    ]
    far, near = rings  # in the overview, and from near by
    observer = dots(svg, LIGHT.ref)[0]
    # the rays to the centre are dashed: one a view, each from the centre towards the observer
    lines = [
        np.array([[float(v) for v in point.split()] for point in way.split("L")])
        for way in re.findall(
            rf'<path d="M([^"Z]+)" fill="none"[^>]*stroke="{css(LIGHT.best)}"[^>]*stroke-dasharray="4 4"', svg
        )
    ]
    assert len(lines) == 2
    (centre, end), (centre_near, _) = lines
    assert end == pytest.approx(observer, abs=1)
    assert hypot(*(centre - observer)) > hypot(*(far - observer))
    pixels = (centre_near - near) * (1, -1)  # up is ahead
    mean = look.scan.mounting.apply(mean_of_points(look.calibrated.one.cluster))
    off = look.calibrated.one.position.point() - mean
    assert atan2(pixels[1], pixels[0]) == pytest.approx(atan2(off[0], -off[1]), abs=0.15)
    assert f"{100 * (look.calibrated.one.position.range - hypot(*mean)):.0f} cm" in words(svg)


def test_the_mean_in_the_place_of_the_centre_hides_it_and_says_how_far_off_it_is(lesson):
    plain, bare = sighting(lesson, (HOW_FAR,), LIGHT), mean_taken(lesson, (HOW_FAR,), LIGHT)
    for told in ("the centre", "outline"):
        assert told in words(plain)
        assert told not in words(bare).replace("taken for the centre", "")
    assert "too near by" in words(bare)
    assert css(LIGHT.best) not in bare


def test_of_all_that_is_as_wide_as_a_robot_one_lies_in_the_directions_of_the_box(lesson):
    svg = sighting(lesson, (BOTH,), LIGHT)
    ringed = [
        each.attrib["stroke"]
        for each in ElementTree.fromstring(svg).iter(f"{SVG}circle")
        if each.attrib["r"] == "11"
    ]
    assert ringed.count(css(LIGHT.mov)) == 1
    assert len(ringed) == len(lesson.look.robot_sized)
    assert f"{len(lesson.look.robot_sized)} may be one" in words(svg)
    assert "not known" in words(svg)  # how far, by the camera alone


def test_the_map_shows_the_points_where_the_maps_are_the_pictures_own(lesson, small_case):
    i = lesson.inputs
    layout = lay_out(i.ref, i.mov, i.at)
    drawn = PICTURE.ink(lesson, (0,), layout, LIGHT)
    cross = next(item for item in drawn if item.get("s") == "cross")
    assert hypot(*(cross["p"] + layout.anchor_ref - i.at.x_ref)) < 0.3
    sector, *_ = drawn
    assert hypot(*(sector["p"][0] + layout.anchor_ref - i.observations[0].observer.xy)) < 0.3
    other = MergeInputs.of(small_case)
    borrowed = LessonRun(other, CONFIG, sides={"sighting": looked(other, CONFIG)})
    assert PICTURE.ink(borrowed, (0,), lay_out(other.ref, other.mov, other.at), LIGHT) == []


def test_an_image_in_which_nothing_is_found_is_shown_with_the_reason(lesson):
    seen = lesson.look
    nothing = replace(
        seen.calibrated, seen=replace(seen.calibrated.seen, sighted=(), chosen=None, reason="dark")
    )
    runs = looked(lesson.inputs, CONFIG)
    runs.each[0].run._newest[SightingLook] = replace(seen, calibrated=nothing, window=None)
    svg = sighting(LessonRun(lesson.inputs, CONFIG, sides={"sighting": runs}), (HOW_FAR,), LIGHT)
    assert "dark" in words(svg)


def test_a_refused_box_is_drawn_with_its_reason_in_every_part(deceived, lesson):
    runs = looked(lesson.inputs, CONFIG)
    runs.each[0].run._newest[SightingLook] = deceived
    refused = LessonRun(lesson.inputs, CONFIG, sides={"sighting": runs})
    for part in range(PARTS):
        ElementTree.fromstring(sighting(refused, (part,), LIGHT))
    assert "refused" in words(sighting(refused, (BOTH,), LIGHT))


def test_the_detector_believes_the_poster_and_laser_and_map_refuse_it(deceived):
    (_, detector), (_, laser), (_, own_map) = opinions(deceived)
    assert "a robot" in detector
    assert deceived.calibrated.one.detection.probability > 0.9
    assert "no step in depth" in laser
    assert "wall" in own_map
    assert deceived.calibrated.seen.position is None


def test_the_picture_of_the_poster_is_as_narrow_as_its_folder_and_its_box_is_refused(deceived):
    svg = poster(deceived, LIGHT)
    root = ElementTree.fromstring(svg)
    assert float(root.attrib["viewBox"].split()[2]) == NARROW
    assert css(LIGHT.conflict) in svg
    assert css(LIGHT.mov) not in svg


def test_an_angle_is_never_minus_nothing():
    assert angle_text(-1e-9) == "0.00°"
    assert angle_text(-0.1, 1) == f"−{degrees(0.1):.1f}°"
