"""What the lesson looks at: a sample's own picture, or that of another, and what comes of it."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, degrees, hypot
from threading import Event, RLock
from unittest.mock import Mock

import numpy as np
import pytest
from looks import look_at, looked

from algorithms.common.pose import Pose2
from algorithms.detection.range_bearing import mean_of_points
from algorithms.files.camera_picture import picture_from_bytes
from algorithms.files.case_folder import read_case
from algorithms.files.truth_file import read_truth
from algorithms.methods.registry import METHODS
from app.jobs.runner import RunCallbacks, Runner
from app.model.merge_inputs import MergeInputs
from app.page.lesson.sighting_look import (
    STAND_IN,
    LookThread,
    SightingLook,
    SightingTask,
    has_pictures,
    pictured,
    sighting_runs,
)
from app.page.lesson.sighting_numbers import SIGHTING_NUMBERS
from app.system import data_paths as paths

CONFIG = METHODS["spectra-proven"].defaults
PICTURED = [name for name, folder in paths.samples().items() if has_pictures(folder)]


@pytest.fixture(scope="module", params=PICTURED)
def seen(request) -> SightingLook:
    return look_at(request.param)


def inputs_of(name: str) -> MergeInputs:
    return MergeInputs.of(read_case(paths.samples()[name]))


def test_robot_2_is_where_the_truth_of_the_maps_puts_it(seen):
    folder = paths.samples()[seen.name]
    case = read_case(folder)
    there = read_truth(folder / "truth.yaml").T_ref_mov.apply(
        np.array([case.observations[0].observed_x, case.observations[0].observed_y])
    )
    found = seen.observer.apply(seen.calibrated.seen.position.point())
    assert hypot(*(found - there)) < 0.25  # maps are bent by some centimetres, a heading by some tenths of 1°


def test_the_centre_lies_behind_the_mean_of_the_points_as_the_observer_sees_it(seen):
    one = seen.calibrated.one
    mean, centre = seen.scan.mounting.apply(mean_of_points(one.cluster)), one.position.point()
    behind = (centre - mean) @ mean / hypot(*mean)
    assert 0.1 < behind < seen.body.widest / 2
    assert abs(mean[0] * centre[1] - mean[1] * centre[0]) / hypot(*mean) < 0.15


def test_the_directions_of_the_box_hold_the_points_and_both_bearings_of_its_middle(seen):
    one = seen.calibrated.one
    box = one.detection
    row = box.middle[1]
    left, right = (seen.calibrated.bearing(edge, row) for edge in (box.left, box.right))
    assert left > right  # counter-clockwise is to the left
    in_camera = seen.scan.mounting.apply(one.cluster.points) - seen.calibrated.camera.mounting.xy
    bearings = np.arctan2(in_camera[:, 1], in_camera[:, 0])
    slack = 0.3 * (left - right)  # windows lie on a grid
    assert ((bearings < left + slack) & (bearings > right - slack)).all()


def test_counting_pixels_is_rough_but_off_by_less_than_half_the_box_and_finds_the_same_points(seen):
    box = seen.calibrated.one.detection
    by_calibration, by_counting = (each.bearing(*box.middle) for each in (seen.calibrated, seen.counted))
    row = box.middle[1]
    half = (seen.calibrated.bearing(box.left, row) - seen.calibrated.bearing(box.right, row)) / 2
    assert 0 < abs(by_calibration - by_counting) < half
    assert not seen.counted.camera.calibrated
    assert seen.counted.one.cluster.beams.tolist() == seen.calibrated.one.cluster.beams.tolist()


def test_of_what_the_laser_tells_apart_a_few_are_as_wide_as_a_robot_and_it_is_among_them(seen):
    assert len(seen.things) > len(seen.robot_sized) >= 1
    mine = set(seen.calibrated.one.cluster.beams.tolist())
    assert any(mine & set(thing.beams.tolist()) for thing in seen.robot_sized)


def test_the_numbers_of_the_text_are_those_of_the_look(seen):
    told = {name: words(seen) for name, words in SIGHTING_NUMBERS.items()}
    one = seen.calibrated.one
    mean = seen.scan.mounting.apply(mean_of_points(one.cluster))
    assert told["centre_range_m"] == f"{one.position.range:.3f}"
    assert told["mean_range_m"] == f"{hypot(*mean):.3f}"
    assert float(told["behind_cm"]) == pytest.approx(100 * (one.position.range - hypot(*mean)), abs=0.51)
    assert told["beams_on_it"] == str(len(one.cluster.beams))
    signed = float(told["camera_bearing"].rstrip("°").replace("−", "-"))
    assert signed == pytest.approx(degrees(seen.calibrated.bearing(*one.detection.middle)), abs=0.01)
    assert seen.name in told["whose_picture"]
    assert "nan" not in " ".join(told.values())


def test_the_photo_is_the_samples_own_and_small_enough_for_a_page(seen):
    photo = picture_from_bytes("photo", seen.photo)
    assert photo.shape[:2] == (seen.calibrated.camera.height, seen.calibrated.camera.width)
    assert len(seen.photo) < 120_000
    first, second = seen.window
    assert first.shape == second.shape


def test_a_picture_belongs_to_the_sample_of_its_folder_and_to_robots_where_they_were(tmp_path):
    samples = paths.samples()
    (sighting,) = read_case(samples[STAND_IN]).observations
    assert pictured(samples, STAND_IN, sighting) == samples[STAND_IN]
    turned = replace(sighting, observer=Pose2(sighting.observer.x, sighting.observer.y, 0.0), bearing=1.0)
    assert pictured(samples, STAND_IN, turned) == samples[STAND_IN]  # robot 1 turns to robot 2
    for moved in (replace(sighting, observed_x=sighting.observed_x + 0.1), None):
        assert pictured(samples, STAND_IN, moved) is None
    assert pictured(samples, "warehouse_r2_r1", sighting) is None
    assert pictured(samples, "my maps", sighting) is None


def test_maps_without_a_picture_are_told_so_and_shown_that_of_another_sample(small_case):
    runs = looked(MergeInputs.of(small_case), CONFIG)
    seen = runs.each[0].run.get(SightingLook)
    assert (seen.name, seen.own) == (STAND_IN, False)
    assert "without a camera's picture" in SIGHTING_NUMBERS["whose_picture"](seen)
    assert runs.next is None
    own = sighting_runs(inputs_of(STAND_IN), CONFIG).each[0].job.steps
    assert own == SightingTask(paths.samples()[STAND_IN], paths.samples()[STAND_IN], own=True)


def test_where_no_sample_is_installed_that_is_told(small_case, monkeypatch):
    monkeypatch.setattr(paths, "samples", dict)
    runs = sighting_runs(MergeInputs.of(small_case), CONFIG)
    assert runs.next is None
    assert "No sample" in runs.each[0].failed


class Here(Runner):
    """Does all in this process."""

    def steps(self, job, callbacks: RunCallbacks, aside=False):
        yield from job.run({})

    def close(self) -> None:
        """Nothing is open."""


def test_a_look_is_shown_once_it_is_over_and_what_went_wrong_is_told(inputs, tmp_path):
    over, show, failed = Event(), Mock(), Mock(side_effect=lambda _: over.set())
    show.side_effect = lambda _: over.set()
    thread = LookThread(Here(), RLock(), show, failed)
    try:
        (folder,) = paths.pictures().values()
        thread.ask(SightingTask(folder, paths.samples()[STAND_IN]), inputs, CONFIG)
        assert over.wait(60)
        assert show.call_args.args[0].name == folder.name
        over.clear()
        thread.ask(SightingTask(tmp_path, tmp_path), inputs, CONFIG)
        assert over.wait(60)
        assert "encounters.csv" in failed.call_args.args[0]
    finally:
        thread.close()


def test_bearings_are_counted_from_the_robots_heading(seen):
    """Of a place far ahead of the camera the pixel's bearing is the place's own."""
    camera = seen.calibrated.camera
    column = float(camera.columns(np.array([0.1]))[0])
    far = camera.mounting.apply(1e6 * np.array([np.cos(0.1), np.sin(0.1)]))
    assert seen.calibrated.bearing(column, camera.centre[1]) == pytest.approx(atan2(far[1], far[0]), abs=1e-4)
