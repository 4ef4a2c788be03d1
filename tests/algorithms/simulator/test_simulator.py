"""The simulator: what it may not get wrong, and that it gives the same bits again."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from repository import ROOT
from scipy import ndimage

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2, pose_error, wrap_angle
from algorithms.files.camera_picture import picture_from_bytes
from algorithms.files.case_folder import read_case
from algorithms.observations.observation import bilateral_transform, encounter
from algorithms.simulator.buildings.building_types import BUILDINGS, build
from algorithms.simulator.buildings.floor_plan import AIR, DARK, WALL, Building, FloorPlan
from algorithms.simulator.fleets.sample_fleets import sample_fleets
from algorithms.simulator.lidar import Lidar, first_hit, scan, sees, true_ranges
from algorithms.simulator.path_planning import STEP, PathPlanner
from algorithms.simulator.portable_random import COSINES, SINES, TRIG_GRID, TURN, normals, radians, stream
from algorithms.simulator.poster_sample import POSTER_SAMPLE
from algorithms.simulator.robot import Conditions, drive, make_body
from algorithms.simulator.room_tours import TourPlanner
from algorithms.simulator.samples import SAMPLES, case_files, generate_cases, write_case
from algorithms.simulator.scenario import Scenario, simulate
from algorithms.simulator.sighting import APART, FURTHEST, NEAREST, measured_overlap
from algorithms.simulator.wrong_pairs import mismatch

SHIPPED = ROOT / "sample_maps"
ASKED = {
    name: overlap for sample in SAMPLES for name, overlap in zip(sample.names, sample.overlaps, strict=False)
}
KINDS = list(BUILDINGS)
NAMES = [name for sample in SAMPLES for name in sample.names]


@pytest.fixture(scope="module")
def flat() -> Scenario:
    return simulate("apartment", 5, 0.4, both_ways=True, conditions=(Conditions(resolution=0.05),) * 3)


@pytest.fixture(scope="module")
def two_rooms() -> Building:
    """Two rooms of 5 m x 5 m side by side, without a door, and a stop in each corner of the left."""
    plan = FloorPlan(11.2, 6.2, 0.025)
    plan.outline(0.6, 0.6, 5.6, 5.6, 0.2)
    plan.outline(5.6, 0.6, 10.6, 5.6, 0.2)
    plan.stops += [(1.6, 1.6), (4.6, 1.6), (4.6, 4.6), (1.6, 4.6)]
    return plan.finish("two rooms")


@pytest.fixture(scope="module")
def often() -> Scenario:
    """Robots that meet at four places, and at two."""
    return simulate("warehouse", 105, sightings=4)


# Bit for bit


@pytest.mark.parametrize("sample", [SAMPLES[1], SAMPLES[4]], ids=lambda sample: sample.names[0])
def test_regenerating_a_shipped_sample_gives_the_shipped_bytes(sample):
    for case in sample.cases():
        files = case_files(case)
        assert {path.name for path in (SHIPPED / case.name).iterdir()} == set(files)
        for name, data in files.items():
            shipped = (SHIPPED / case.name / name).read_bytes()
            if name.endswith(".jpg"):  # another version of libjpeg may write the same picture otherwise
                first, second = (picture_from_bytes(name, each).astype(int) for each in (data, shipped))
                assert np.abs(first - second).mean() < 0.5, f"{case.name}/{name}"
            else:
                assert shipped == data, f"{case.name}/{name}"


def test_every_picture_that_ships_is_small():
    pictures = list(SHIPPED.glob("*/*.jpg"))
    assert len(pictures) == sum(sample.pictured for sample in SAMPLES) + 1  # the poster
    assert max(path.stat().st_size for path in pictures) < 110_000


@pytest.fixture(scope="module")
def fleets() -> dict[str, dict[str, bytes]]:
    return sample_fleets(SAMPLES[0].cases())


def test_the_shipped_fleets_are_made_again_byte_for_byte(fleets):
    for folder, files in fleets.items():
        for name, data in files.items():
            assert (SHIPPED / folder / name).read_bytes() == data, f"{folder}/{name}"


def test_every_shipped_sample_is_there(fleets):
    assert {path.name for path in SHIPPED.iterdir() if path.is_dir()} == {*NAMES, *fleets, POSTER_SAMPLE}


def test_same_seed_gives_the_same_files(flat):
    again = simulate("apartment", 5, 0.4, both_ways=True, conditions=(Conditions(resolution=0.05),) * 3)
    assert [case_files(case) for case in again.cases] == [case_files(case) for case in flat.cases]


@pytest.mark.parametrize("kind", KINDS)
def test_different_seeds_give_different_buildings(kind):
    floors = [build(kind, seed).surface for seed in range(12)]
    assert len({floor.tobytes() for floor in floors}) == len(floors)
    assert np.array_equal(floors[3], build(kind, 3).surface)


def test_no_cosine_lies_where_another_library_would_round_it_otherwise():
    exact = np.cos(np.arange(TURN // 4) * (2 * np.pi / TURN)) * TRIG_GRID
    from_a_tie = np.abs(exact - np.floor(exact) - 0.5)
    assert from_a_tie.min() > 2e-6  # libraries differ by less than 2^-52, times 2^30: 2.4e-7


def test_table_of_angles_is_that_of_cosine_and_sine():
    angles = np.array([radians(tick) for tick in range(TURN)])
    assert np.abs(COSINES - np.cos(angles)).max() < 2**-30
    assert np.abs(SINES - np.sin(angles)).max() < 2**-30


def test_normal_draws_have_mean_0_and_deviation_1():
    draws = normals(stream(0, "test"), 200_000)
    assert abs(draws.mean()) < 0.01
    assert abs(draws.std() - 1) < 0.01
    assert 0.94 < (np.abs(draws) < 1.96).mean() < 0.96


# Beams


rasters = st.integers(0, 2**32 - 1).map(
    lambda seed: (np.random.default_rng(seed).random((40, 50)) < 0.06).astype(np.uint8)
)
inside = st.tuples(st.floats(0.01, 2.49), st.floats(0.01, 1.99))


@settings(max_examples=150, deadline=None)
@given(rasters, inside, st.integers(0, TURN - 1), st.floats(0.1, 3))
def test_a_beam_ends_at_the_first_wall_or_at_its_reach(raster, start, tick, reach):
    cell, (x, y), direction = 0.05, start, np.array([COSINES[tick], SINES[tick]])
    distance, kind = first_hit(raster, cell, x, y, *direction.tolist(), reach)

    def wall_at(t):
        col, row = np.floor((np.array([x, y]) + t * direction) / cell).astype(int)
        return 0 <= row < 40 and 0 <= col < 50 and raster[row, col] != 0

    # No wall is seen through: nothing solid before the end, sampled far finer than a cell.
    assert not any(wall_at(t) for t in np.arange(0, distance - 1e-6, 0.001))
    if kind == AIR:
        assert distance == reach
    else:
        assert distance <= reach
        # At the end stands a wall, within rounding of the boundary of two cells.
        end = np.array([x, y]) + distance * direction
        cells = {tuple(np.floor((end + off) / cell).astype(int)) for off in _around(1e-6)}
        assert any(0 <= r < 40 and 0 <= c < 50 and raster[r, c] for c, r in cells)


def _around(width):
    return [np.array([dx, dy]) for dx in (-width, 0, width) for dy in (-width, 0, width)]


def test_range_to_a_straight_wall_is_exact(two_rooms):
    ranges, kinds = true_ranges(
        two_rooms, np.array([[3.0, 3.0]]), np.array([0]), np.array([0, TURN // 8, TURN // 4]), 10.0
    )
    assert np.allclose(ranges[0], [2.5, 2.5 * np.sqrt(2), 2.5], atol=1e-6)
    assert (kinds == WALL).all()


def test_glass_returns_few_beams_and_open_space_none():
    plan = FloorPlan(20, 20, 0.05)
    plan.box(12, 0, 13, 20, DARK)
    lidar = Lidar(beams=2000, field=30, reach=8, lost=0.0, lost_on_dark=0.8)
    poses = np.array([[10.0, 10.0]]), np.array([0])
    towards = scan(plan.finish("glass"), *poses, lidar, stream(0, "test"))
    away = scan(plan.finish("glass"), poses[0], poses[1] + TURN // 2, lidar, stream(0, "test"))
    assert 0.75 < np.isnan(towards).mean() < 0.85
    assert np.isinf(away).all()


# Drives and maps


@pytest.mark.parametrize("kind", KINDS)
def test_robots_keep_off_the_walls_and_step_evenly(kind):
    building = build(kind, 2)
    planner = PathPlanner(building)
    track = planner.drive(list(range(0, len(planner.stops), 2)))
    room = ndimage.distance_transform_edt(~building.solid) * building.resolution
    cols, rows = (track.xy / building.resolution).astype(int).T
    assert room[rows, cols].min() > 0.2
    steps = np.array([np.hypot(*(b - a)) for a, b in pairwise(track.xy)])
    assert steps.max() <= STEP + 1e-6
    assert np.median(steps) > 0.99 * STEP


def test_drift_is_there_and_stays_small(flat):
    for robot in flat.robots:
        T_robot_world = Pose2(*robot.body.shift.tolist(), radians(robot.body.turn))
        off = np.hypot(*(T_robot_world.apply(robot.true.xy) - robot.believed.xy).T)
        assert 0.005 < off.max() < 0.2
        turned = robot.believed.heading - robot.true.heading - robot.body.turn
        assert 0 < np.abs([wrap_angle(radians(int(t))) for t in turned]).max() < np.deg2rad(2)


def test_a_map_shows_the_building_and_nothing_else(flat):
    solid = flat.building.solid
    to_wall = ndimage.distance_transform_edt(~solid) * flat.building.resolution
    into_wall = ndimage.distance_transform_edt(solid) * flat.building.resolution
    for robot in flat.robots:
        T_world_robot = Pose2(*robot.body.shift.tolist(), radians(robot.body.turn)).inverse()

        def at(cells, raster, T_world_robot=T_world_robot, grid=robot.grid):
            points = T_world_robot.apply(grid.centres(*np.nonzero(cells)))
            cols, rows = (points / flat.building.resolution).astype(int).T
            return raster[rows, cols]

        assert robot.grid.free.sum() > 5000
        assert (at(robot.grid.free, into_wall) < 0.15).mean() > 0.999
        assert (at(robot.grid.occupied, to_wall) < 0.15).mean() > 0.98


def test_what_no_beam_touched_stays_unknown(two_rooms):
    planner = PathPlanner(two_rooms)
    body = make_body("R1", 0, "test", 9.0, Conditions(resolution=0.05))
    tour = TourPlanner(two_rooms, planner, 9.0).tour([0, 1, 2, 3], 0)
    robot = drive(two_rooms, planner, tour, body)
    T_robot_world = Pose2(*body.shift.tolist(), radians(body.turn))
    x, y = np.meshgrid(np.arange(0.9, 10.4, 0.1), np.arange(0.9, 5.4, 0.1))
    points = np.stack([x.ravel(), y.ravel()], axis=-1)
    values = np.array([robot.grid.value_at(p) for p in T_robot_world.apply(points)])
    assert (values[points[:, 0] < 5.2] == 0).mean() > 0.95
    assert (values[points[:, 0] > 6.0] == -1).all()


def test_walls_are_thicker_than_one_cell_somewhere_and_ragged(flat):
    for robot in flat.robots:
        walls = robot.grid.occupied
        eroded = ndimage.binary_erosion(walls, np.ones((2, 2)))
        assert 0.05 < eroded.sum() / walls.sum() < 0.7


# Truth


@pytest.mark.parametrize("rough", [False, True], ids=["well", "badly"])
@pytest.mark.parametrize("name", NAMES)
def test_truth_puts_the_seen_robot_where_it_was_seen(name, rough):
    case = read_case(SHIPPED / name, rough=rough)
    at = encounter(case.observations[0])
    off = case.truth.T_ref_mov.apply(at.x_mov) - at.x_ref
    covariance = at.covariance + np.eye(2) * 0.08**2  # drift of both robots, which truth averages
    assert off @ np.linalg.solve(covariance, off) < 16  # four standard deviations
    assert np.hypot(*off) < (2.5 if rough else 0.6)


@pytest.mark.parametrize("name", NAMES)
def test_overlap_is_what_was_asked_and_what_the_files_show(name):
    case = read_case(SHIPPED / name)
    assert abs(case.truth.overlap - ASKED[name]) < 0.03
    measured = measured_overlap(case.ref, case.mov, case.truth.T_ref_mov)
    assert measured == pytest.approx(case.truth.overlap, abs=0.002)


@pytest.mark.parametrize("name", NAMES)
def test_walls_part_when_the_true_transform_is_turned_or_shifted(name):
    case = read_case(SHIPPED / name)
    T = case.truth.T_ref_mov
    pivot = T.apply(encounter(case.observations[0]).x_mov)

    def overlap_after(x, y, turn):
        moved = Pose2(*pivot, 0.0) @ Pose2(x, y, turn) @ Pose2(*(-pivot), 0.0) @ T
        return measured_overlap(case.ref, case.mov, moved)

    turned = [overlap_after(0, 0, turn) for turn in (-0.07, 0.07)]
    around = np.arange(8) * np.pi / 4
    shifted = [overlap_after(0.3 * np.cos(a), 0.3 * np.sin(a), 0.0) for a in around]
    assert max(turned) < 0.8 * case.truth.overlap
    # Along a corridor a shift changes little, so it is their mean that tells.
    assert np.mean(shifted) < 0.6 * case.truth.overlap


def test_bilateral_sighting_of_the_office_agrees_with_its_truth():
    case = read_case(SHIPPED / "office_r2_r1")
    at = encounter(case.observations[0])
    distance, angle = pose_error(bilateral_transform(case.observations[0]), case.truth.T_ref_mov, at.x_mov)
    assert distance < 0.4
    assert angle < np.deg2rad(9)  # three standard deviations of two bearings


# Several sightings


def test_more_sightings_leave_the_first_ones_and_all_else_as_they_are(often):
    for number in (1, 2):
        for few, many in zip(simulate("warehouse", 105, sightings=number).cases, often.cases, strict=True):
            assert few.observations == many.observations[:number]
            assert few.rough == many.rough[:number]
            files, others = case_files(few), case_files(many)
            assert {name for name in files if files[name] != others[name]} <= {
                "observation.yaml",
                "observation_rough.yaml",
            }


def test_robots_are_seen_as_often_as_they_meet_at_places_of_their_own(often):
    assert [len(case.observations) for case in often.cases] == [4, 2]
    for pair in often.pairs:
        places = pair.observed.true.xy[[meeting.observed for meeting in pair.meetings]]
        apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
        assert apart[~np.eye(len(places), dtype=bool)].min() >= APART
        for meeting in pair.meetings:
            here, there = pair.observer.true.xy[meeting.observer], pair.observed.true.xy[meeting.observed]
            assert NEAREST <= np.hypot(*(there - here)) <= FURTHEST
            assert sees(often.building, here, there)


def test_every_sighting_errs_in_its_own_way(often):
    for pair, case in zip(often.pairs, often.cases, strict=True):
        true = [
            np.hypot(*(pair.observed.true.xy[at.observed] - pair.observer.true.xy[at.observer]))
            for at in pair.meetings
        ]
        for seen in (case.observations, case.rough):
            errors = [(o.range - metres) / o.sigma_range for o, metres in zip(seen, true, strict=True)]
            assert np.abs(errors).max() < 4
            assert np.abs(np.subtract.outer(errors, errors) + np.eye(len(errors))).min() > 1e-3


def test_the_truth_fits_every_sighting(often):
    for case in often.cases:
        for o in (*case.observations, *case.rough):
            at = encounter(o)
            off = case.T_ref_mov.apply(at.x_mov) - at.x_ref
            covariance = at.covariance + np.eye(2) * 0.08**2  # drift of both robots
            assert off @ np.linalg.solve(covariance, off) < 16


@pytest.mark.parametrize("kind", ["apartment", "corridor"])
def test_overlap_follows_the_one_asked_for(kind):
    few, many = (simulate(kind, 4, overlap).cases[0].overlap for overlap in (0.1, 0.5))
    assert abs(few - 0.1) < 0.12
    assert abs(many - 0.5) < 0.12


# Files


def test_generated_cases_read_back(tmp_path):
    folders = generate_cases("corridor", [7], tmp_path, overlap=0.3)
    assert [folder.name for folder in folders] == ["corridor_0007_r2_r1", "corridor_0007_r3_r2"]
    for folder in folders:
        case = read_case(folder)
        assert case.truth.source == "mapmeld simulator, corridor seed 7"
        assert case.ref.occupied.any()
        assert case.mov.occupied.any()


def test_wrong_pairing_is_written_as_one_to_refuse(flat, tmp_path):
    other = simulate("corridor", 7, 0.3).cases[0]
    write_case(tmp_path / "wrong", mismatch(flat.cases[0], other))
    truth = read_case(tmp_path / "wrong").truth
    assert truth.expected == "refuse"
    assert truth.T_ref_mov is None


def test_a_wrong_pairing_forges_as_many_sightings_as_both_have(often):
    first, second = often.cases
    forged = mismatch(first, second)
    assert len(forged.observations) == len(forged.rough) == 2
    for lie, half, other in zip(forged.observations, first.observations, second.observations, strict=False):
        assert (lie.observer, lie.range) == (half.observer, half.range)
        assert (lie.observed_x, lie.observed_y) == (other.observed_x, other.observed_y)


def test_building_that_is_not_there_is_refused_by_name():
    with pytest.raises(SettingError, match=r"'castle'.*office, apartment, warehouse, corridor"):
        build("castle", 0)
