from dataclasses import fields, replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from drawn import OBSERVED, OBSERVER, drawn_map, flat_pair, poses, problems, sighting
from hypothesis import assume, event, given, settings
from hypothesis import strategies as st

from algorithms.common import parallel_kernels as kernels
from algorithms.common.pose import Pose2, pose_error, wrap_angles
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.observations.observation import Encounter, encounter
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.optimisation import branch_and_bound as certificate
from algorithms.optimisation import open_blocks
from algorithms.optimisation.branch_and_bound import MOST_RIVALS, ProofConfig, prove
from algorithms.optimisation.likelihood_field import AgreementConfig, make_agreement
from algorithms.optimisation.objective import Lookup, make_objective
from algorithms.optimisation.transform_lattice import TransformLattice
from algorithms.optimisation.upper_bounds import UpperBounds
from algorithms.spectra.augmented_map import AugmentConfig, augment

NEAR = ProofConfig(angle=20, distance=0.3)
configs = st.builds(
    ProofConfig, angle=st.sampled_from([5.0, 20.0, 60.0]), distance=st.sampled_from([0.1, 0.3, 5.0])
)


class Everything:
    """All the transforms of a lattice, looked at one by one."""

    def __init__(self, objective, window):
        lattice = TransformLattice(objective, window)
        numbers = np.indices((lattice.turns, lattice.side, lattice.side)).reshape(3, -1).T
        self.coordinates = lattice.coordinates(numbers, 0)
        self.poses = lattice.poses(self.coordinates)
        self.values = np.where(window.contains(self.poses), objective(self.poses), -np.inf)
        self.best = float(self.values.max())
        self.sectors = numbers[:, 0] >> lattice.levels

    @classmethod
    def few_of(cls, problem):
        """Those of a problem that has not too many of them; of another, hypothesis makes another problem."""
        lattice = TransformLattice(problem.objective, problem.window)
        assume(lattice.turns * lattice.side**2 <= 40_000)
        return cls(problem.objective, problem.window)

    def index(self, pose):
        """Which of the transforms a pose is."""
        off = np.abs(self.poses - pose)
        off[:, 2] = np.abs(wrap_angles(off[:, 2]))
        assert off.max(axis=1).min() < 1e-9
        return int(off.max(axis=1).argmin())

    def elsewhere(self, answers, config):
        """Which transforms are another answer than any of these."""
        apart = np.ones(len(self.poses), dtype=bool)
        for answer in answers:
            off = self.coordinates - self.coordinates[self.index(answer)]
            turned = np.rad2deg(np.abs(wrap_angles(off[:, 2])))
            apart &= (np.hypot(off[:, 0], off[:, 1]) > config.distance) | (turned > config.angle)
        return self.values[apart].max(initial=-np.inf)

    def best_by_sector(self):
        top = np.full(self.sectors.max() + 1, -np.inf)
        np.maximum.at(top, self.sectors, self.values)
        return top


def dust(seed, size=36, share=0.15):
    """Walls strewn at random: a place is like any other, so that little can be ruled out."""
    cells = np.where(np.random.default_rng(seed).random((size, size)) < share, OCCUPIED, FREE)
    return GridMap(cells.astype(np.int8), 0.1)


def dusty(first=0, second=1):
    middle = np.array([1.8, 1.8])
    met = [Encounter(middle, middle, np.eye(2) * 0.1**2)]
    window = coupled_window(met, WindowConfig("coupled"))
    pair = dust(first), dust(second)
    lift = AugmentConfig(spread=0.5)
    return make_agreement(*pair, met, lift, AgreementConfig(), window, Lookup.NEAREST), window


def coarse_flat(T_ref_world, T_mov_world, gamma=False, config=None, **noise):
    """The flat in cells of 0.1 m, both ways of weighing it, and a sighting that may be off."""
    ref = drawn_map(T_ref_world, 0.1, seen=(-1, -1, 6.7, 8))
    mov = drawn_map(T_mov_world, 0.1, seen=(2.5, -1, 10, 8))
    at = encounter(sighting(T_ref_world, T_mov_world, OBSERVER, OBSERVED, **noise))
    window = coupled_window([at], WindowConfig("coupled"))
    lift = AugmentConfig(spread=3.0)
    if gamma:
        levels = [
            augment(grid, x, lift.covariance(), 100.0) for grid, x in ((ref, at.x_ref), (mov, at.x_mov))
        ]
        return make_objective(*levels, Lookup.NEAREST), window
    return make_agreement(ref, mov, [at], lift, config or AgreementConfig(), None, Lookup.NEAREST), window


def last(states):
    *_, state = states
    return state


@pytest.fixture(scope="module", autouse=True)
def small_batches():
    """A small map has few blocks; opened a few hundred at a time, none would ever be left out."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(open_blocks, "BATCH", 16)
        yield


def check_answers(every, state, config, floor):
    """Best and rivals against looking at every transform."""
    assert state.proven
    assert state.best_value == every.best == every.values[every.index(state.best)]
    answers = [state.best]
    for rival, value in zip(state.rivals, state.rival_values, strict=True):
        assert value == every.elsewhere(answers, config) == every.values[every.index(rival)]
        answers.append(rival)
    if len(state.rivals) < MOST_RIVALS:
        assert every.elsewhere(answers, config) <= floor * every.best


def check_told(every, states, config):
    """Every bound that is told on the way against looking at every transform."""
    top = every.best_by_sector()
    elsewhere = {0: every.best}
    for state in states:
        assert np.all(state.ceilings >= top)
        assert np.all(state.found <= top)
        told = [state.best, *state.rivals] if state.proven and state.best_value > 0 else []
        if state.stopped or len(told) not in elsewhere:
            elsewhere[len(told)] = every.elsewhere(told, config)
        assert state.ceiling >= elsewhere[len(told)]


@settings(max_examples=50)
@given(problems(side=16), configs, st.sampled_from([0.0, 0.5, 0.9]))
def test_best_and_rivals_are_those_that_looking_at_every_transform_finds(problem, config, floor):
    every = Everything.few_of(problem)
    state = last(prove(problem.objective, problem.window, config, floor))
    event(f"{state.stopped.split(':')[0]}, rivals: {len(state.rivals)}")
    if every.best > 0:
        check_answers(every, state, config, floor)
    elif np.isfinite(every.best):
        assert state.proven
        assert state.best_value == every.best
    else:
        assert state.best is None
        assert state.empty
        assert not state.proven


@settings(max_examples=30)
@given(problems(side=12), configs)
def test_what_is_told_on_the_way_is_never_too_low(problem, config):
    check_told(Everything.few_of(problem), prove(problem.objective, problem.window, config), config)


@cache
def smooth():
    """A problem whose best rivals are those that are only just far enough from the best."""
    objective, window = coarse_flat(Pose2(3, -4, 0.3), Pose2(-12, 5, -1.7), config=AgreementConfig(0.3, 0.0))
    rough = replace(window, covariances=np.eye(2)[None] * 0.2**2)
    return objective, rough, Everything(objective, rough)


@pytest.mark.parametrize(("angle", "distance"), [(25.0, 5.0), (90.0, 0.5)])
def test_nor_does_a_rival_hide_right_beside_the_best(angle, distance):
    objective, window, every = smooth()
    config = ProofConfig(angle=angle, distance=distance)
    states = list(prove(objective, window, config, floor=0.5))
    check_answers(every, states[-1], config, floor=0.5)
    check_told(every, states, config)


@settings(max_examples=40)
@given(problems(side=16), configs)
def test_the_gap_only_shrinks_and_is_nothing_at_the_end(problem, config):
    states, found = [], []
    for state in prove(problem.objective, problem.window, config):
        states.append(state)
        found.append(state.found.copy())
    assert all(np.array_equal(state.found, then) for state, then in zip(states, found, strict=True))
    assert all(later.gap <= earlier.gap for earlier, later in pairwise(states))
    assert all(np.all(later.ceilings <= earlier.ceilings) for earlier, later in pairwise(states))
    assert [state.stopped is None for state in states] == [True] * (len(states) - 1) + [False]
    assert states[-1].best is None or states[-1].gap == 0


def test_a_flat_is_proven_from_a_small_share_of_its_transforms():
    objective, window = coarse_flat(Pose2(3, -4, 0.3), Pose2(-12, 5, -1.7), range=0.05)
    rough = replace(window, covariances=np.eye(2)[None] * 0.3**2)
    lattice = TransformLattice(objective, rough)
    numbers = np.indices((lattice.turns, lattice.side, lattice.side)).reshape(3, -1).T
    all_of_them = np.count_nonzero(rough.contains(lattice.poses(lattice.coordinates(numbers, 0))))
    state = next(state for state in prove(objective, rough, NEAR) if state.proven)
    assert state.nodes < 0.1 * all_of_them


@pytest.mark.parametrize("nodes", [1, 1000, 3000, 5000])
def test_stopped_early_it_says_so_and_its_gap_covers_the_best(nodes, monkeypatch):
    objective, window = dusty()
    every = Everything(objective, window)
    monkeypatch.setattr(certificate, "NODES", nodes)
    state = last(prove(objective, window, ProofConfig(patience=1)))
    assert "not all searched" in state.stopped
    assert not state.proven
    assert state.ceiling >= every.best
    assert state.gap >= every.best - state.best_value
    assert np.all(state.ceilings >= every.best_by_sector())


def test_with_more_patience_more_is_searched_before_it_stops(monkeypatch):
    objective, window = dusty()
    monkeypatch.setattr(certificate, "NODES", 1000)
    nodes = [last(prove(objective, window, ProofConfig(patience=n))).nodes for n in (1, 2, 4)]
    assert all(n * 1000 < count < n * 1000 + 500 for n, count in zip((1, 2, 4), nodes, strict=True))


@settings(max_examples=40)
@given(problems(side=16), configs)
def test_the_best_turn_lies_within_half_a_sector_of_that_which_holds_it(problem, config):
    state = last(prove(problem.objective, problem.window, config))
    if state.best is None or state.best_value <= 0:
        return
    middle = state.turns[np.argmax(state.found)]
    assert abs(wrap_angles(state.best[2] - middle)) <= np.pi / len(state.turns) + 1e-9


def test_stopped_among_the_rivals_the_best_stays_proven_and_the_ceiling_covers_the_rest(monkeypatch):
    objective, window = dusty(first=0, second=0)
    every = Everything(objective, window)
    proven = next(state for state in prove(objective, window, NEAR) if state.proven)
    monkeypatch.setattr(certificate, "NODES", proven.nodes)
    state = last(prove(objective, window, replace(NEAR, patience=1)))
    assert "rivals not all searched" in state.stopped
    assert state.proven
    assert state.best_value == every.best
    assert state.gap == 0
    assert state.ceiling >= every.elsewhere([state.best], NEAR)


def test_of_many_rivals_the_best_are_told_and_the_ceiling_covers_the_others():
    objective, window = dusty()
    every = Everything(objective, window)
    state = last(prove(objective, window, NEAR, floor=0.2))
    assert len(state.rivals) == MOST_RIVALS
    left = every.elsewhere([state.best, *state.rivals], NEAR)
    assert state.floor < left <= state.ceiling


def test_nothing_is_bounded_before_it_is_asked_for_or_after_the_caller_has_left(monkeypatch):
    bounded = []
    plain = UpperBounds.__call__

    def counting(self, nodes, level):
        values = plain(self, nodes, level)
        bounded.append(int(np.isfinite(values).sum()))
        return values

    monkeypatch.setattr(UpperBounds, "__call__", counting)
    for wanted in (1, 3):
        bounded.clear()
        states = prove(*dusty(), ProofConfig())
        assert not bounded
        seen = [next(states) for _ in range(wanted)]
        states.close()
        assert sum(bounded) == seen[-1].nodes


@pytest.mark.parametrize("threads", [1, 2])
def test_the_same_states_again_and_on_any_number_of_threads(threads, monkeypatch):
    objective, window = coarse_flat(Pose2(3, -4, 0.3), Pose2(-12, 5, -1.7))
    monkeypatch.setattr(kernels, "cores", lambda: 1)
    alone = list(prove(objective, window, NEAR))
    monkeypatch.setattr(kernels, "cores", lambda: threads)
    again = list(prove(objective, window, NEAR))
    assert len(alone) == len(again)
    for one, other in zip(alone, again, strict=True):
        for field in fields(one):
            assert np.array_equal(getattr(one, field.name), getattr(other, field.name)), field.name


@pytest.mark.parametrize("gamma", [False, True])
@settings(max_examples=6)
@given(poses, poses, st.floats(-0.1, 0.1), st.floats(-0.05, 0.05))
def test_a_known_pose_is_found_from_anywhere_on_the_circle(gamma, T_ref_world, T_mov_world, far, aside):
    objective, window = coarse_flat(T_ref_world, T_mov_world, gamma, range=far, bearing=aside)
    state = last(prove(objective, window, NEAR, floor=0.5))
    truth = T_ref_world @ T_mov_world.inverse()
    distance, angle = pose_error(Pose2.from_array(state.best), truth, window.pivot)
    assert distance < 0.15  # a cell and a half
    assert angle < 0.03  # what turns the walls at 3 m by a cell


@settings(max_examples=6)
@given(poses, poses)
def test_swapping_the_maps_inverts_the_answer(T_ref_world, T_mov_world):
    ref = drawn_map(T_ref_world, 0.1, seen=(-1, -1, 6.7, 8))
    mov = drawn_map(T_mov_world, 0.1, seen=(2.5, -1, 10, 8))
    at = encounter(sighting(T_ref_world, T_mov_world, OBSERVER, OBSERVED))
    answers = []
    for first, second, x_first, x_second in ((ref, mov, at.x_ref, at.x_mov), (mov, ref, at.x_mov, at.x_ref)):
        met = [Encounter(x_first, x_second, np.eye(2) * 0.05**2)]
        window = coupled_window(met, WindowConfig("coupled"))
        lift = AugmentConfig(spread=3.0)
        objective = make_agreement(first, second, met, lift, AgreementConfig(), window, Lookup.NEAREST)
        answers.append(last(prove(objective, window, NEAR, floor=0.5)))
    there, back = (Pose2.from_array(answer.best) for answer in answers)
    distance, angle = pose_error(there.inverse(), back, at.x_ref)
    assert distance < 0.15
    assert angle < 0.03
    assert answers[0].best_value == pytest.approx(answers[1].best_value, rel=0.1)


EMPTY = GridMap(np.full((30, 20), FREE, dtype=np.int8), 0.1)
BLIND = GridMap(np.full((30, 20), UNKNOWN, dtype=np.int8), 0.1)
SOLID = GridMap(np.full((30, 20), OCCUPIED, dtype=np.int8), 0.1)
SPECK = GridMap(np.full((1, 1), FREE, dtype=np.int8), 0.1)


@pytest.mark.parametrize("kind", ["gamma", "agreement", "agreement and sighting"])
@pytest.mark.parametrize(
    "other", [EMPTY, BLIND, SOLID, SPECK, dust(0)], ids=lambda grid: str(grid.cells.shape)
)
@pytest.mark.parametrize("nothing", [EMPTY, BLIND, SPECK], ids=lambda grid: str(grid.cells.shape))
def test_a_map_without_walls_ends_with_nothing_that_speaks_for_any_transform(nothing, other, kind):
    met = [Encounter(np.array([1.0, 1.5]), np.array([1.2, 0.7]), np.eye(2) * 0.01)]
    window = coupled_window(met, WindowConfig("coupled"))
    lift = AugmentConfig(spread=0.5)
    for pair in ((nothing, other), (other, nothing)):
        if kind == "gamma":
            x = (met[0].x_ref, met[0].x_mov)
            levels = [augment(g, at, lift.covariance(), 100.0) for g, at in zip(pair, x, strict=True)]
            objective = make_objective(*levels, Lookup.NEAREST)
        else:
            counted = window if kind == "agreement and sighting" else None
            objective = make_agreement(*pair, met, lift, AgreementConfig(), counted, Lookup.NEAREST)
        state = last(prove(objective, window, ProofConfig()))
        assert state.stopped == "proven, but nothing speaks for it"
        assert state.best_value <= 0
        assert len(state.rivals) == 0


def test_sightings_that_exclude_each_other_leave_no_transform():
    ref, mov, seen, _ = flat_pair()
    at = encounter(seen)
    liar = replace(at, x_ref=at.x_ref + (30.0, 0.0))
    window = coupled_window([at, liar], WindowConfig("coupled"))
    objective = make_agreement(
        ref, mov, [at, liar], AugmentConfig(), AgreementConfig(), window, Lookup.NEAREST
    )
    state = last(prove(objective, window, ProofConfig()))
    assert state.best is None
    assert state.empty
    assert state.stopped == "the window holds no transform of the lattice"


def test_what_is_of_no_interest_as_the_best_is_of_none_as_a_rival_either():
    objective, window = dusty()
    usual = last(prove(objective, window, NEAR))
    worth = float(usual.rival_values[1])
    state = last(prove(objective, window, NEAR, worth=worth))
    assert state.floor == worth
    assert state.best_value == usual.best_value
    assert state.rival_values.tolist() == usual.rival_values[:1].tolist()


def test_once_the_best_is_proven_no_part_of_the_circle_is_told_to_hold_a_better_one():
    proven = [state for state in prove(*dusty(0, 0), NEAR) if state.proven]
    assert len(proven) > 1
    assert all((state.ceilings <= state.best_value).all() for state in proven)
