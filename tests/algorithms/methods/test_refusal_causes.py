"""After a refusal the simple change under which the maps would agree is named, if there is one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import GridMap, remarks_on
from algorithms.methods.refusal_causes import find_cause
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, PLANE_METHOD, merge, run_explained
from algorithms.methods.steps import CauseDetail, TriedDetail
from algorithms.observations.observation import mirrored
from algorithms.observations.pair_problem import PairProblem

CONFIG, PLANE = (METHODS[name].defaults for name in (DEFAULT_METHOD, PLANE_METHOD))


def explained(case, method=DEFAULT_METHOD, config=CONFIG):
    """The last of what merging and asking for a cause yields."""
    *_, last = run_explained(method, case.ref, case.mov, case.observations, config, 0)
    return last.detail


def problem_of(case):
    return PairProblem(case.ref, case.mov, case.observations)


def with_mov(case, mov, observations=None):
    return replace(case, mov=mov, observations=case.observations if observations is None else observations)


def scaled(case, factor):
    """Map 2 as drawn by one who was mistaken about the size of its cells, frame and all."""
    mov = case.mov
    origin = Pose2(mov.origin.x * factor, mov.origin.y * factor, mov.origin.theta)
    (o,) = case.observations
    there = replace(o, observed_x=o.observed_x * factor, observed_y=o.observed_y * factor)
    return with_mov(case, replace(mov, resolution=mov.resolution * factor, origin=origin), (there,))


def test_a_mirrored_map_is_told_to_be_one(small_case):
    (seen,) = small_case.observations
    found = explained(with_mov(small_case, small_case.mov.mirrored(), (mirrored(seen),)))
    assert not found.verdict.accepted
    assert found.verdict.hint.startswith("Mirrored, map 2 agrees on ")
    assert "upside down" in found.verdict.hint


@pytest.mark.parametrize(("axis", "said"), [(1, "left to right"), (0, "top to bottom")])
def test_a_flipped_image_is_told_with_the_way_it_was_flipped(axis, said, small_case):
    mov = small_case.mov
    flipped = replace(mov, cells=np.ascontiguousarray(np.flip(mov.cells, axis)))
    assert said in explained(with_mov(small_case, flipped)).verdict.hint


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_cells_of_a_wrong_size_are_told_with_the_right_one(factor, small_case):
    told = explained(scaled(small_case, factor)).verdict.hint
    assert f"with cells of {small_case.mov.resolution:g} m" in told.lower()
    assert f"resolution: {small_case.mov.resolution:g}" in told


def test_without_a_sighting_a_mirrored_map_and_cells_of_a_wrong_size_are_told_as_well(small_case):
    alone = replace(small_case, observations=())
    mirrored_told = explained(with_mov(alone, small_case.mov.mirrored()), None, None)
    assert mirrored_told.verdict.hint.startswith("Mirrored, map 2 agrees on ")
    larger = replace(small_case.mov, resolution=2 * small_case.mov.resolution)
    assert (
        f"resolution: {small_case.mov.resolution:g}"
        in explained(with_mov(alone, larger), None, None).verdict.hint
    )


def test_a_map_that_was_put_right_when_it_was_read_and_is_mirrored_is_told_to_be_mirrored(small_case):
    odd = replace(small_case.mov.mirrored(), remarks=("grey 205 is read as unknown",))
    (seen,) = small_case.observations
    assert "irrored" in explained(with_mov(small_case, odd, (mirrored(seen),))).verdict.hint


def test_cells_that_would_be_too_fine_or_too_coarse_are_no_cause(strangers):
    for cell in (0.0002, 40.0):
        mov = replace(strangers.mov, resolution=cell)
        x, y = mov.corners().mean(axis=0).tolist()  # where robot 2 stands on its map, however small that is
        tiny = with_mov(strangers, mov, (replace(strangers.observations[0], observed_x=x, observed_y=y),))
        *_, last = find_cause(problem_of(tiny), CONFIG, PLANE)
        assert isinstance(last, CauseDetail)


def test_maps_of_two_buildings_have_no_simple_cause(strangers):
    found = explained(strangers)
    assert not found.verdict.accepted
    assert found.verdict.hint == ""


def test_how_a_map_was_read_is_told_where_no_change_helps(strangers):
    odd = with_mov(strangers, replace(strangers.mov, remarks=("no wall was read in it",)))
    *_, last = find_cause(problem_of(odd), CONFIG, PLANE)
    assert "no wall was read in it" in last.hint
    assert remarks_on((odd.ref, odd.mov)) == ("Map 2 (hall): no wall was read in it.",)


def test_every_change_is_told_before_it_is_tried(strangers):
    *tried, last = find_cause(problem_of(strangers), CONFIG, PLANE)
    assert all(isinstance(each, TriedDetail) for each in tried)
    assert [each.index for each in tried] == list(range(tried[0].total))
    assert last == CauseDetail("")


def test_an_accepted_merge_is_not_asked_for_a_cause(small_case, result):
    *steps, last = run_explained(
        DEFAULT_METHOD, small_case.ref, small_case.mov, small_case.observations, CONFIG, 0
    )
    assert "explain" not in {step.stage for step in steps}
    assert last.detail.T_ref_mov == result.T_ref_mov


def test_mirroring_a_map_twice_gives_it_back_and_walls_stay_at_their_places(small_case):
    mov: GridMap = small_case.mov
    once = mov.mirrored()
    assert np.array_equal(once.mirrored().cells, mov.cells)
    assert once.mirrored().corners() == pytest.approx(mov.corners())
    shown = once.points[np.lexsort(once.points.T)]
    flipped = mov.points * (-1, 1)
    assert shown == pytest.approx(flipped[np.lexsort(flipped.T)])


def test_the_mirrored_sighting_fits_the_mirrored_map(small_case):
    """Both mirrored is a building mirrored: it merges as well."""
    (seen,) = small_case.observations
    ref, mov = small_case.ref.mirrored(), small_case.mov.mirrored()
    T = merge(small_case.ref, small_case.mov, (seen,)).verdict
    both = replace(
        mirrored(seen),
        observer=Pose2(-seen.observer.x, seen.observer.y, np.pi - seen.observer.theta),
        bearing=-seen.bearing,
    )
    assert merge(ref, mov, (both,)).verdict.probability == pytest.approx(T.probability, abs=0.01)
