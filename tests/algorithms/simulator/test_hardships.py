"""What makes simulated maps hard: wear, another day, bends, other floors, and pairs that are no pairs."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from drawn import drawn_map
from hypothesis import given, settings
from hypothesis import strategies as st
from training_pairs import FROM, TO, training_pairs, with_pillars, wrongly_seen

from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN
from algorithms.observations.observation import encounter
from algorithms.simulator.buildings.building_types import BUILDINGS, build
from algorithms.simulator.buildings.floor_plan import WALL
from algorithms.simulator.changes import AROUND, rearranged
from algorithms.simulator.odometry_drift import OdometryDrift
from algorithms.simulator.portable_random import stream
from algorithms.simulator.robot import Conditions
from algorithms.simulator.scenario import simulate
from algorithms.simulator.wear import Wear, worn
from algorithms.simulator.wrong_pairs import crossed, mirrored

FLAT = drawn_map(Pose2())
wears = st.builds(
    Wear, st.integers(0, 3), *(st.floats(0, 0.5) for _ in range(4))
)  # thicker, lost, dotted, holes, specks


@pytest.fixture(scope="module")
def flat():
    return simulate("apartment", 5, 0.4, both_ways=True, conditions=(Conditions(resolution=0.05),) * 3)


# ---- wear


def test_a_map_that_is_not_worn_is_the_same_map():
    assert worn(FLAT, Wear(), stream(0, "wear")) is FLAT


@given(wears, st.integers(0, 99))
@settings(max_examples=30)
def test_wear_changes_what_cells_show_and_not_where_they_lie(wear, seed):
    told = worn(FLAT, wear, stream(seed, "wear"))
    assert told.cells.shape == FLAT.cells.shape
    assert (told.origin, told.resolution) == (FLAT.origin, FLAT.resolution)
    assert set(np.unique(told.cells)) <= {UNKNOWN, FREE, OCCUPIED}
    assert np.array_equal(told.cells, worn(FLAT, wear, stream(seed, "wear")).cells)


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("lost", OCCUPIED, FREE),
        ("dotted", OCCUPIED, UNKNOWN),
        ("holes", FREE, UNKNOWN),
        ("specks", FREE, OCCUPIED),
    ],
)
def test_every_kind_of_wear_takes_its_share_of_its_own_cells(name, before, after):
    told = worn(FLAT, Wear(**{name: 0.3}), stream(1, "wear")).cells
    changed = told != FLAT.cells
    assert set(FLAT.cells[changed]) == {before}
    assert set(told[changed]) == {after}
    assert changed.sum() == pytest.approx(0.3 * np.count_nonzero(FLAT.cells == before), rel=0.1)


def test_thick_walls_grow_by_whole_cells_on_both_sides():
    thick = worn(FLAT, Wear(thicker=2), stream(1, "wear"))
    assert (thick.occupied >= FLAT.occupied).all()
    grown = np.argwhere(thick.occupied & ~FLAT.occupied)
    walls = np.argwhere(FLAT.occupied)
    nearest = np.abs(grown[:, None] - walls[None]).max(axis=2).min(axis=1)
    assert nearest.max() == 2


# ---- the building on another day


def test_on_another_day_the_building_differs_and_the_way_that_was_driven_stays_clear():
    building = build("apartment", 3)
    way = np.array([[x, 3.0] for x in np.arange(2.0, 8.0, 0.1)])
    other = rearranged(building, way, stream(3, "another day"))
    new = np.argwhere((other.surface == WALL) & (building.surface != WALL))
    assert len(new) > 50
    at = (new[:, ::-1] + 0.5) * building.resolution
    nearest = np.hypot(*(at[:, None] - way[None]).transpose(2, 0, 1)).min()
    assert nearest > AROUND
    assert np.array_equal(other.stops, building.stops)


def test_pillars_stand_before_walls_and_never_in_doors():
    building = build("office", 4)
    other = with_pillars(building, stream(4, "pillars"))
    new = np.argwhere((other.surface == WALL) & (building.surface != WALL))
    assert len(new) > 100
    at = (new[:, ::-1] + 0.5) * building.resolution
    middles = building.doors.reshape(-1, 2, 2).mean(axis=1)
    assert np.hypot(*(at[:, None] - middles[None]).transpose(2, 0, 1)).min() > 0.5


@pytest.mark.parametrize("kind", [kind for kind in BUILDINGS if kind != "warehouse"])
def test_another_floor_has_the_same_outer_walls_and_other_rooms(kind):
    ground, first = build(kind, 6), build(kind, 6, floor=1)
    assert np.array_equal(build(kind, 6, floor=1).surface, first.surface)
    assert ground.surface.shape == first.surface.shape
    walls, others = ground.surface == WALL, first.surface == WALL
    both = np.count_nonzero(walls & others)
    assert 0.2 < both / np.count_nonzero(walls | others) < 0.98


# ---- bent maps


def test_no_transform_lays_a_bent_map_on_a_straight_one_as_well_as_another_straight_one():
    bent = Conditions(drift=OdometryDrift(bend=1.0))
    straight = simulate("apartment", 2, (0.7, 0.7))
    curved = simulate("apartment", 2, (0.7, 0.7), conditions=(bent, Conditions(), Conditions()))
    assert curved.cases[0].truth_rms > straight.cases[0].truth_rms + 0.05


def test_the_usual_conditions_are_those_without_any(flat):
    usual = (Conditions(OdometryDrift(), wear=Wear(), resolution=0.05),) * 3
    again = simulate("apartment", 5, 0.4, both_ways=True, conditions=usual)
    assert np.array_equal(flat.cases[0].ref.cells, again.cases[0].ref.cells)
    assert flat.cases[0].observations == again.cases[0].observations


# ---- pairs that are none


def test_a_wrong_sighting_puts_robot_2_metres_away_and_changes_nothing_else(flat):
    case = flat.cases[0]
    wrong = wrongly_seen(case, stream(1, "wrong"))
    (seen,), (lie,) = case.observations, wrong.observations
    off = np.hypot(*(encounter(lie).x_ref - encounter(seen).x_ref))
    assert FROM <= off <= TO
    assert replace(lie, range=seen.range, bearing=seen.bearing) == seen
    assert wrong.T_ref_mov is None
    assert wrong.mov is case.mov


def test_a_mirrored_case_mirrored_again_is_the_case(flat):
    case = flat.cases[0]
    twice = mirrored(mirrored(case))
    assert np.array_equal(twice.mov.cells, case.mov.cells)
    assert pose_error(twice.mov.origin, case.mov.origin, np.zeros(2)) == pytest.approx((0, 0), abs=1e-9)
    for seen, again in zip(case.observations, twice.observations, strict=True):
        assert again.observed_heading == pytest.approx(seen.observed_heading)
        assert replace(again, observed_heading=seen.observed_heading) == seen
    assert mirrored(case).T_ref_mov is None


def test_a_crossed_sighting_is_what_one_saw_and_what_the_other_knows_of_itself(flat):
    a, b = (case.observations[0] for case in flat.cases)
    lie = crossed(a, b)
    assert (lie.observer, lie.range, lie.bearing) == (a.observer, a.range, a.bearing)
    assert (lie.observed_x, lie.observed_y, lie.bearing_back) == (b.observed_x, b.observed_y, b.bearing_back)
    assert crossed(a, a) == a


def test_training_pairs_are_the_same_every_time_and_of_every_kind():
    first, again = (list(islice(training_pairs(8100), 6)) for _ in range(2))
    assert [pair.kind for pair in first] == [pair.kind for pair in again]
    for one, other in zip(first, again, strict=True):
        assert np.array_equal(one.case.mov.cells, other.case.mov.cells)
        assert one.observations == other.observations
    kinds = [pair.kind for pair in first]
    assert kinds == ["right", "right", "wrong sighting", "mirrored", "same plan", "other building"]
    for pair in first:
        assert (pair.case.T_ref_mov is not None) == (pair.kind == "right")
        assert len(pair.buildings) == (2 if pair.kind == "other building" else 1)
        assert pair.buildings[0] == "8100"
