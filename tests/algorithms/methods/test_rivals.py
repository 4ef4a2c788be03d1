"""The methods to compare with: each finds what is easy to find, and says so where it finds nothing."""

import sys
from dataclasses import replace
from functools import cache
from math import degrees

import cv2
import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, T_MOV_WORLD, T_REF_MOV, T_REF_WORLD, drawn_map, seeds, sighting
from hypothesis import given, settings
from hypothesis import strategies as st
from skimage.feature import match_descriptors

from algorithms.common.errors import NoAnswerError, SettingError
from algorithms.common.pose import Pose2, pose_error
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.methods.baselines import feature_detectors as detectors
from algorithms.methods.baselines import phase_correlation as phase
from algorithms.methods.baselines.distance_image import (
    MARGIN,
    Turn,
    common_cell,
    known_cells,
    picture,
    pose_of,
)
from algorithms.methods.baselines.distance_image import drawn as coarsened
from algorithms.methods.baselines.feature_detectors import (
    HarrisConfig,
    OrbConfig,
    ShiTomasiConfig,
    SiftConfig,
    SurfConfig,
    describe,
)
from algorithms.methods.baselines.feature_matching import FeatureConfig, MatchConfig, agreeing, fit_covariance
from algorithms.methods.baselines.overlap_error import OverlapError
from algorithms.methods.baselines.phase_correlation import DIRECTIONS, turn_correlation
from algorithms.methods.registry import METHODS, merge, run
from algorithms.methods.steps import MatchesDetail, ObservationDetail, TurnsDetail
from app.model import chart_data as charts
from app.model import verdict_text as words

# Both robots have seen the whole flat.
REF, MOV = drawn_map(T_REF_WORLD, name="ref"), drawn_map(T_MOV_WORLD, name="mov")
SEEN = sighting(T_REF_WORLD, T_MOV_WORLD, OBSERVER, OBSERVED)
SEEN_BACK = sighting(T_MOV_WORLD, T_REF_WORLD, OBSERVED, OBSERVER)
# metres and degrees within which a method is expected; what only looks on a raster is given a cell or two
WITHIN = dict.fromkeys(METHODS, (0.1, 1.0)) | {"surf": (0.15, 1.5), "smm-only": (0.15, 1.0)}
FEATURES = [name for name, method in METHODS.items() if isinstance(method.defaults, FeatureConfig)]
RIVALS = [name for name, method in METHODS.items() if not method.uses_observation]
KINDS = [SiftConfig(), OrbConfig(), SurfConfig(), ShiTomasiConfig(), HarrisConfig()]


@cache
def steps_of(method):
    return [step.detail for step in run(method, REF, MOV, SEEN)]


def there(method):
    return steps_of(method)[-1]


def empty(like):
    return GridMap(np.full(like.cells.shape, UNKNOWN, dtype=np.int8), like.resolution, like.origin, "empty")


# ---- every method of the table


@pytest.mark.parametrize("method", METHODS)
def test_every_method_finds_an_easy_pose(method):
    distance, angle = pose_error(there(method).T_ref_mov, T_REF_MOV, there(method).pivot)
    assert distance <= WITHIN[method][0]
    assert degrees(angle) <= WITHIN[method][1]
    assert there(method).verdict.accepted


@pytest.mark.parametrize("method", METHODS)
def test_swapping_the_two_maps_inverts_the_answer_of_every_method(method):
    back = merge(MOV, REF, SEEN_BACK, method).T_ref_mov.inverse()
    distance, angle = pose_error(back, there(method).T_ref_mov, there(method).pivot)
    if method == "paper-argmax":
        # looks for turns from 0° to 180° alone: of a turn and its inverse it can find only one
        assert degrees(np.pi - angle) <= 2 * WITHIN[method][1]
        return
    assert distance <= 2 * WITHIN[method][0]
    assert degrees(angle) <= 2 * WITHIN[method][1]


@pytest.mark.parametrize("method", RIVALS)
def test_a_rival_does_not_look_at_the_sighting(method):
    elsewhere = replace(SEEN, observed_x=SEEN.observed_x + 3.0, range=SEEN.range + 0.5)
    told = merge(REF, MOV, elsewhere, method)
    assert told.T_ref_mov == there(method).T_ref_mov
    assert told.value == there(method).value
    assert not told.verdict.accepted  # but the verdict does
    assert "from where it was seen" in told.verdict.reason


@pytest.mark.parametrize("method", RIVALS)
def test_a_rival_has_no_answer_for_a_map_without_walls(method):
    with pytest.raises(NoAnswerError, match=r"^Refused: .*\w\.$"):
        merge(REF, empty(MOV), SEEN, method)


@pytest.mark.parametrize("method", RIVALS)
def test_a_rival_says_how_sure_it_is(method):
    covariance = there(method).covariance
    assert np.allclose(covariance, covariance.T)
    assert (np.linalg.eigvalsh(covariance) > 0).all()


def test_the_table_tells_whose_a_method_is():
    assert {method.family for method in METHODS.values()} == {"ours", "paper", "rivals"}
    assert {name for name, method in METHODS.items() if not method.uses_observation} == {
        name for name, method in METHODS.items() if method.family == "rivals"
    }
    titles = [method.title for method in METHODS.values()]
    assert len(set(titles)) == len(titles)
    assert max(map(len, titles)) <= 36  # the menu is narrow


# ---- features


@pytest.mark.parametrize("method", FEATURES)
def test_the_matches_are_told_before_and_after_a_transform_was_found(method):
    before, after = (detail for detail in steps_of(method) if isinstance(detail, MatchesDetail))
    assert not before.inliers.any()
    assert np.array_equal(before.ref, after.ref)
    kept = after.inliers
    assert kept.sum() == there(method).value
    off = np.linalg.norm(T_REF_MOV.apply(after.mov[kept]) - after.ref[kept], axis=1)
    assert np.median(off) < 0.15  # in each map's own frame
    assert {tuple(at) for at in after.ref} <= {tuple(at) for at in after.ref_features}


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: type(kind).__name__)
@pytest.mark.parametrize("angle", [0.3, np.pi / 2, np.pi])
def test_features_are_known_again_in_a_turned_picture(kind, angle):
    straight = picture(REF, 0.05, 0.5, MARGIN)
    turn = Turn.of(straight.far.shape, angle)
    turned = replace(straight, far=turn(straight.far, 1.0))
    at, looks = describe(straight, kind)
    found, turned_looks = describe(turned, kind)
    pairs = match_descriptors(looks, turned_looks, cross_check=True, max_ratio=0.9)
    off = np.linalg.norm(turn.there(at[pairs[:, 0]]) - found[pairs[:, 1]], axis=1)
    assert (off < 3).sum() >= 8
    assert (off < 3).mean() > 0.5


def test_too_few_matches_are_no_answer_and_are_told_before_it():
    config = replace(METHODS["orb"].defaults, match=MatchConfig(least=50, tolerance=0.02))
    steps = run("orb", REF, MOV, SEEN, config)
    told = [next(steps).detail for _ in range(3)]
    assert [type(detail) for detail in told] == [ObservationDetail, MatchesDetail, MatchesDetail]
    assert told[-1].inliers.any()
    with pytest.raises(NoAnswerError, match=r"of \d+ matched features \d+ agree .* and 50 must"):
        next(steps)


def test_surf_without_mahotas_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "mahotas.features", None)
    detectors._mahotas_surf.cache_clear()
    with pytest.raises(SettingError, match=r"pip install 'mapmeld\[surf\]'"):
        merge(REF, MOV, SEEN, "surf")


def test_the_covariance_of_a_fit_is_that_of_its_scatter():
    rng = np.random.default_rng(0)
    mov = rng.uniform(-5, 5, (30, 2))
    fitted = []
    for _ in range(300):
        ref = T_REF_MOV.apply(mov) + rng.normal(0, 0.05, mov.shape)
        a, b = mov - mov.mean(axis=0), ref - ref.mean(axis=0)
        turn = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
        shift = ref.mean(axis=0) - Pose2(theta=turn).apply(mov.mean(axis=0))
        fitted.append((*shift, turn))
    ref = T_REF_MOV.apply(mov) + rng.normal(0, 0.05, mov.shape)
    matches = agreeing(MatchesDetail(ref, mov, ref, mov, np.zeros(30, dtype=bool)), T_REF_MOV, 1.0)
    told = fit_covariance(matches, T_REF_MOV)
    assert np.allclose(np.sqrt(np.diag(told)), np.std(fitted, axis=0), rtol=0.4)


@pytest.mark.parametrize("method", FEATURES)
def test_the_seed_chooses_the_luck_of_ransac_alone(method):
    again = merge(REF, MOV, SEEN, method)
    assert again.T_ref_mov == there(method).T_ref_mov
    other = merge(REF, MOV, SEEN, method, seed=7)
    assert pose_error(other.T_ref_mov, T_REF_MOV, other.pivot)[0] <= WITHIN[method][0]


def test_the_threads_of_opencv_do_not_change_an_answer():
    before = cv2.getNumThreads()
    try:
        cv2.setNumThreads(1)
        alone = [merge(REF, MOV, SEEN, method).T_ref_mov for method in ("sift", "orb")]
    finally:
        cv2.setNumThreads(before)
    assert alone == [there("sift").T_ref_mov, there("orb").T_ref_mov]


# ---- every turn, every shift


def test_the_squared_error_is_told_turn_by_turn_and_the_best_turn_in_the_end():
    told = [detail for detail in steps_of("mse") if isinstance(detail, TurnsDetail)]
    tried = [int(np.isfinite(detail.scores).sum()) for detail in told]
    assert tried == sorted(tried)
    assert len(set(tried)) > 5
    assert told[-1].best == pytest.approx(T_REF_MOV.theta, abs=np.radians(1))
    best = told[-1].turns[np.nanargmax(told[-1].scores)]
    assert best == pytest.approx(T_REF_MOV.theta, abs=np.radians(3))


def test_the_error_of_a_map_on_itself_is_nothing_and_grows_with_every_step_away():
    same = picture(REF, 0.05, 0.5)
    overlap = OverlapError.of(same, same, 0.2, seed=0)
    errors = [overlap.error(Pose2(step, 0.0, 0.0)) for step in (0.0, 0.05, 0.1, 0.2)]
    assert errors[0] == pytest.approx(0.0, abs=1e-9)
    assert errors == sorted(errors)
    assert overlap.error(Pose2(100.0)) > 1.0  # nothing is compared


@settings(max_examples=15)
@given(x=st.floats(-0.15, 0.15), y=st.floats(-0.15, 0.15), turn=st.floats(-0.03, 0.03))
def test_from_nearby_the_least_error_is_found_below_a_cell(x, y, turn):
    overlap = OverlapError.of(picture(REF, 0.05, 0.5), picture(MOV, 0.05, 0.5), 0.2, seed=0)
    start = Pose2(x, y, 0.0) @ T_REF_MOV @ Pose2(0.0, 0.0, turn)
    middle = overlap.points.mean(axis=0)
    x_off, y_off = (T_REF_MOV.apply(middle) - start.apply(middle)).tolist()
    start = Pose2(start.x + x_off + x, start.y + y_off + y, start.theta)
    found, _ = overlap.best_near(start, 0.1)
    distance, angle = pose_error(found, T_REF_MOV, middle)
    assert distance < 0.025
    assert angle < np.radians(0.3)


@settings(max_examples=15)
@given(turn=st.floats(-np.pi, np.pi), rows=st.integers(-40, 40), cols=st.integers(-40, 40))
def test_a_turn_and_a_shift_of_a_picture_are_one_pose(turn, rows, cols):
    ref, mov = picture(REF, 0.05, 0.5), picture(MOV, 0.05, 0.5)
    turned, shift = Turn.of(mov.far.shape, turn), np.array([cols, rows])
    at = np.array([[0.0, 0.0], [31.0, 8.0], [5.0, 77.0]])
    T = pose_of(ref, mov, turned, shift)
    assert np.allclose(T.apply(mov.places(at)), ref.places(turned.there(at) + shift))
    assert np.allclose(turned.back(turned.there(at)), at)


@settings(max_examples=15)
@given(rows=st.integers(-90, 90), cols=st.integers(-90, 90))
def test_the_phases_of_a_moved_picture_tell_how_far_it_was_moved(rows, cols):
    still = picture(REF, 0.1, 0.3, 100)
    moved = replace(still, far=np.roll(still.far, (-rows, -cols), axis=(0, 1)))
    size = 2 * max(still.far.shape) + 8
    turn = Turn.of(moved.far.shape, 0.0)
    shift = phase._shift(still, moved, turn, size) + turn.matrix[:, 2]
    assert np.allclose(shift, [cols, rows], atol=0.3)


@pytest.mark.parametrize("step", [0, 37, 200, 359])
def test_the_amplitudes_of_a_turned_picture_tell_the_turn_but_for_half_a_circle(step):
    still = picture(REF, 0.1, 0.3)
    turn = Turn.of(still.far.shape, -2 * np.pi * step / DIRECTIONS)
    turned = replace(still, far=turn(still.far, 1.0))
    told = turn_correlation(still, turned, 2 * turn.side, 0.5)
    assert len(told) == DIRECTIONS // 2
    off = (int(told.argmax()) - step) % (DIRECTIONS // 2)
    assert min(off, DIRECTIONS // 2 - off) <= 1


# ---- pictures


def test_a_picture_holds_what_is_known_and_no_more():
    cells = np.full((90, 120), UNKNOWN, dtype=np.int8)
    cells[20:50, 60:100] = FREE
    cells[20, 60:100] = OCCUPIED
    grid = GridMap(cells, 0.1, Pose2(3.0, -2.0, 0.7))
    assert known_cells(grid) == (slice(20, 50), slice(60, 100))
    drawn_coarse = picture(grid, 0.2, 1.0)
    assert drawn_coarse.far.shape == (15, 20)
    assert drawn_coarse.known.all()
    assert (drawn_coarse.far[0] == 0).all()
    assert drawn_coarse.far[3, 5] == pytest.approx(0.6)
    corner = drawn_coarse.places(np.array([[-0.5, -0.5]]))
    assert np.allclose(corner, grid.origin.apply(np.array([[6.0, 2.0]])))
    margin = picture(grid, 0.2, 1.0, margin=7)
    assert np.allclose(margin.places(np.array([[7.0, 7.0]])), drawn_coarse.places(np.zeros((1, 2))))


@given(seeds, st.sampled_from([1.0, 1.25, 2.0, 3.7]))
def test_no_wall_is_lost_where_it_is_drawn_coarser(seed, coarser):
    rng = np.random.default_rng(seed)
    mask = rng.random(rng.integers(1, 60, 2)) < 0.2
    out = coarsened(mask, 0.05, 0.05 * coarser, 2)
    assert out.sum() == out[2:-2, 2:-2].sum()
    assert out.sum() <= mask.sum()
    far = np.linalg.norm(
        (np.argwhere(mask)[:, None] + 0.5) / coarser - (np.argwhere(out)[None] - 1.5), axis=2
    )
    assert (far.min(axis=1, initial=np.inf) < 0.75).all()
    assert coarsened(np.ones_like(mask), 0.05, 0.05 * coarser, 0)[:-1, :-1].all()


def test_pictures_of_large_maps_are_bounded():
    large = GridMap(np.zeros((40, 4000), dtype=np.int8), 0.05)
    assert common_cell(large, REF, 1500) == pytest.approx(0.05 * 4000 / 1500)
    assert common_cell(REF, MOV, 1500) == 0.05
    assert max(picture(large, common_cell(large, REF, 400), 1.0).far.shape) == 400


def test_what_helps_after_a_rival_was_refused_is_a_method_that_looks_at_the_sighting():
    elsewhere = replace(SEEN, observed_x=SEEN.observed_x + 3.0)
    refused = merge(REF, MOV, elsewhere, "orb")
    assert words.remedy(refused) == "This method does not look at the observation: take one that does."
    assert words.remedy(there("orb")) == ""


def test_a_chart_of_every_turn_marks_the_best_and_holds_what_is_not_tried_yet():
    turns = np.radians(np.arange(-180, 180, 10.0))
    scores = np.where(np.arange(36) < 20, np.cos(turns - turns[12]), np.nan)
    x, y, best = charts.circle(TurnsDetail(turns, scores)).columns
    assert np.flatnonzero(np.isfinite(best)).tolist() == [12]
    assert (y[20:] == np.nanmin(scores)).all()
    assert np.allclose(x, np.degrees(turns))
    _, _, best = charts.circle(TurnsDetail(turns, scores, best=float(turns[3]) + 2 * np.pi)).columns
    assert np.flatnonzero(np.isfinite(best)).tolist() == [3]
    low, high = charts.circle(TurnsDetail(turns, scores)).up
    assert low < np.nanmin(scores) < np.nanmax(scores) < high
    nothing = TurnsDetail(turns, np.full(36, np.nan))
    assert np.isfinite(charts.circle(nothing).columns[1]).all()
    assert charts.circle(nothing).up[0] < charts.circle(nothing).up[1]
