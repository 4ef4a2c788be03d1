"""Pictures of the meetings of two drives, and their files."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.common.pose import wrap_angle
from algorithms.files.camera_file import camera_from_bytes
from algorithms.files.camera_picture import picture_from_bytes
from algorithms.files.encounter_table import encounters_from_bytes
from algorithms.files.scan_file import scan_from_bytes
from algorithms.simulator.samples import case_files
from algorithms.simulator.scenario import Scenario, SimulatedCase, simulate
from algorithms.simulator.views.pictured_encounters import body_of, encounter_files
from algorithms.simulator.wrong_pairs import mirrored, mismatch


@pytest.fixture(scope="module")
def drives() -> Scenario:
    return simulate("home", 10, 0.4, sightings=2)


@pytest.fixture(scope="module")
def case(drives) -> SimulatedCase:
    return drives.pictured_case(0, 10)


def test_every_meeting_is_pictured_with_the_other_robot_in_it(drives, case):
    assert len(case.encounters) == len(drives.pairs[0].meetings) >= 1
    for encounter, seen in zip(case.encounters, case.observations, strict=True):
        (robot,) = encounter.view.robots
        assert robot.body == body_of("R1")
        assert abs(robot.bearing) < 0.25
        assert robot.range == pytest.approx(seen.range, abs=4 * seen.sigma_range)
        assert encounter.observer.xy.tolist() == seen.observer.xy.tolist()
        assert encounter.observed.xy.tolist() == [seen.observed_x, seen.observed_y]


def test_who_turns_to_the_other_believes_so_too(case):
    """In the observer's own frame, what the picture shows lies where the sighting says."""
    for encounter, seen in zip(case.encounters, case.observations, strict=True):
        there = encounter.observer.theta + encounter.view.robots[0].bearing
        assert abs(wrap_angle(there - seen.observer.theta - seen.bearing)) < 4 * seen.sigma_bearing


def test_the_robots_have_tags_of_their_own():
    tags = [tag for name in ("R1", "R2", "R3") for tag in body_of(name).tags]
    assert sorted(tags) == list(range(12))


def test_its_files_read_back(case):
    files = encounter_files(case.encounters)
    rows = encounters_from_bytes("table", files["encounters.csv"])
    assert len(rows) == len(case.encounters)
    camera = camera_from_bytes("camera", files["camera.yaml"])
    for row, encounter in zip(rows, case.encounters, strict=True):
        assert camera == encounter.view.camera
        assert row.observer == encounter.observer
        scan, other = scan_from_bytes("scan", files[row.scan]), encounter.view.scan
        assert scan.mounting == other.mounting
        assert np.nanmax(np.abs(np.where(scan.valid, scan.ranges - other.ranges, 0))) < 1e-3
        picture = picture_from_bytes("picture", files[row.image]).astype(int)
        assert np.abs(picture - encounter.view.image).mean() < 6
        assert len(files[row.image]) < 110_000


def test_a_case_nobody_looked_at_and_one_of_two_buildings_have_no_pictures(drives, case):
    assert set(case_files(case)) - set(case_files(drives.cases[0])) == set(encounter_files(case.encounters))
    assert encounter_files(drives.cases[0].encounters) == {}
    assert mirrored(case).encounters == mismatch(case, case).encounters == ()
