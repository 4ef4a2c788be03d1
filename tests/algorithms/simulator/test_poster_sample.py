"""A robot that takes a poster for another robot: what it saw, and the sighting that it makes of it."""

from __future__ import annotations

from math import hypot

import numpy as np
import pytest
from repository import ROOT

from algorithms.files.camera_file import read_camera
from algorithms.files.camera_picture import picture_from_bytes
from algorithms.files.encounter_table import encounters_from_bytes, read_encounters
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import read_known
from algorithms.files.scan_file import read_scan, scan_from_bytes
from algorithms.maps.wall_distance import distance_to_walls
from algorithms.simulator.poster_sample import (
    DISTANCE,
    FAR_FROM_TRUTH,
    POSTER_SAMPLE,
    poster_encounter,
    poster_files,
    taken_for_robot,
)
from algorithms.simulator.scenario import Scenario, simulate
from algorithms.simulator.views.pictured_encounters import PicturedEncounter

SHIPPED = ROOT / "sample_maps" / POSTER_SAMPLE


@pytest.fixture(scope="module")
def made() -> Scenario:
    return simulate("office", 3, 0.4)


@pytest.fixture(scope="module")
def taken_in(made) -> PicturedEncounter:
    return poster_encounter(made, 3)


def test_a_poster_is_in_view_and_no_robot_and_the_other_one_is_elsewhere(taken_in, made):
    view = taken_in.view
    assert view.robots == ()
    poster = view.scene.posters[-1]
    assert poster.robot
    middle = (np.array(poster.left) + np.array(poster.right)) / 2
    assert DISTANCE[0] <= hypot(*(middle - view.observer.xy)) <= DISTANCE[1]
    stood = made.pairs[0].observed.true.xy[made.pairs[0].meetings[0].observed]
    assert hypot(*(middle - stood)) >= FAR_FROM_TRUTH


def test_it_is_taken_for_a_robot_where_the_wall_is(taken_in):
    seen, view = taken_for_robot(taken_in), taken_in.view
    poster = view.scene.posters[-1]
    middle = view.observer.inverse().apply((np.array(poster.left) + np.array(poster.right)) / 2)
    place = seen.range * np.array([np.cos(seen.bearing), np.sin(seen.bearing)])
    assert hypot(*(place - middle)) < 0.25
    assert seen.observer == taken_in.observer


def test_its_files_read_back(taken_in):
    files = poster_files(taken_in)
    (row,) = encounters_from_bytes("table", files["encounters.csv"])
    assert row.observer == taken_in.observer
    assert picture_from_bytes("picture", files[row.image]).shape == taken_in.view.image.shape
    assert len(scan_from_bytes("scan", files[row.scan]).ranges) == len(taken_in.view.scan.ranges)


def test_what_ships_is_small_and_its_laser_points_lie_on_the_walls_of_map_1():
    (row,) = read_encounters(SHIPPED / "encounters.csv")
    assert (SHIPPED / row.image).stat().st_size < 80_000
    assert read_camera(SHIPPED / "camera.yaml").calibrated
    (seen,) = read_known(SHIPPED / "observation.yaml")
    assert seen.observer == row.observer
    grid, scan = read_map(SHIPPED.parent / "office_r2_r1" / "map1.yaml"), read_scan(SHIPPED / row.scan)
    away = distance_to_walls(grid.occupied) * grid.resolution
    points = row.observer.apply(scan.points()[scan.valid])
    cols, rows = np.floor(grid.grid_coordinates(points)).astype(int).T
    inside = (cols >= 0) & (cols < grid.width) & (rows >= 0) & (rows < grid.height)
    assert np.median(away[rows[inside], cols[inside]]) < 0.1
