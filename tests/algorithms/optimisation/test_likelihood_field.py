from dataclasses import replace

import numpy as np
import pytest
from drawn import angles, encounters_in, flat_pair, poses, problems, small_maps
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap
from algorithms.maps.wall_distance import distance_to_walls, surface
from algorithms.observations.observation import Encounter, encounter
from algorithms.observations.search_window import WindowConfig, coupled_window
from algorithms.optimisation.likelihood_field import AgreementConfig, clear, make_agreement
from algorithms.optimisation.objective import PAD, Lookup
from algorithms.spectra.augmented_map import AugmentConfig

REF, MOV, SEEN, T = flat_pair()
AT = encounter(SEEN)
WIDE = AugmentConfig(spread=20.0)  # every wall of a small hall counts in full, or nearly
MIDDLE = Encounter(np.array([4.0, 4.0]), np.array([4.0, 4.0]), np.eye(2) * 0.01)


def hall(walls=(), side=8.0, cell=0.05, floor=FREE):
    """Floor with walls on it: (x0, y0, x1, y1) boxes in metres."""
    cells = np.full((round(side / cell),) * 2, floor, dtype=np.int8)
    for x0, y0, x1, y1 in walls:
        cells[round(y0 / cell) : round(y1 / cell), round(x0 / cell) : round(x1 / cell)] = OCCUPIED
    return GridMap(cells, cell)


def value(ref, mov, pose=None, config=None, lift=WIDE, encounters=(MIDDLE,), window=None):
    objective = make_agreement(
        ref, mov, encounters, lift, config or AgreementConfig(), window, Lookup.NEAREST
    )
    return float(objective((pose or Pose2()).array()[None])[0])


def test_two_equal_maps_agree_in_all_the_wall_that_either_has():
    wall = hall([(2.0, 4.0, 6.0, 4.05)])  # one cell thick: every cell of it can be seen
    assert value(wall, wall) == pytest.approx(2 * 4.0, rel=0.01)


def test_a_wall_in_the_others_free_floor_takes_back_the_penalty_times_its_length():
    wall, bare = hall([(2.0, 4.0, 6.0, 4.05)]), hall()
    for penalty in (0.0, 1.0, 2.5):
        assert value(wall, bare, config=AgreementConfig(penalty=penalty)) == pytest.approx(
            -penalty * 4.0, rel=0.01, abs=1e-6
        )


def test_robots_that_stand_in_each_others_maps_say_nothing():
    """Map 1 shows robot 2 at (4, 4), map 2 shows robot 1 at (2, 4); their walls are the same."""
    walls = [(1.0, 6.0, 7.0, 6.05)]
    at = replace(MIDDLE, observer=np.array([2.0, 4.0]))
    ring_1, ring_2 = (hall([*walls, (x - 0.2, 3.8, x + 0.2, 4.2)]) for x in (4.0, 2.0))

    def weigh(ref, mov, size):
        return float(
            make_agreement(ref, mov, [at], WIDE, AgreementConfig(), None, Lookup.NEAREST, size)(
                Pose2().array()[None]
            )[0]
        )

    assert weigh(ring_1, ring_2, 0.5) == pytest.approx(weigh(hall(walls), hall(walls), 0.5), rel=1e-6)
    assert weigh(ring_1, ring_2, 0.0) < weigh(ring_1, ring_2, 0.5) - 1


def test_the_unknown_says_nothing():
    wall, blind = hall([(2.0, 4.0, 6.0, 4.05)]), hall(floor=UNKNOWN)
    assert value(wall, blind) == 0
    assert value(blind, wall) == 0


def test_a_wall_a_blur_beside_another_counts_as_much_as_a_normal_says():
    ref = hall([(2.0, 4.0, 6.0, 4.05)], floor=UNKNOWN)
    ref_seen = GridMap(np.where(ref.cells == OCCUPIED, OCCUPIED, FREE).astype(np.int8), ref.resolution)
    config = AgreementConfig(blur=0.1, penalty=0.0)
    beside = value(ref_seen, ref_seen, Pose2(0.0, 0.1, 0.0), config)
    assert beside == pytest.approx(np.exp(-0.5) * 8.0, rel=0.02)


def test_a_wall_drawn_a_cell_beside_another_still_speaks_for_it():
    wall = hall([(2.0, 4.0, 6.0, 4.05)])
    assert value(wall, wall, Pose2(0.0, 0.05, 0.0)) > 0.7 * value(wall, wall)


@settings(max_examples=25)
@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-np.pi, np.pi))
def test_swapping_the_maps_and_inverting_the_transform_changes_nothing(x, y, turn):
    pose = T @ Pose2(x, y, turn)
    back = Encounter(AT.x_mov, AT.x_ref, AT.covariance)
    there = value(REF, MOV, pose, encounters=[AT])
    assert value(MOV, REF, pose.inverse(), encounters=[back]) == pytest.approx(there, abs=1e-3)


@given(st.floats(1, 1000))
def test_the_intensity_of_the_augmentation_does_not_matter(intensity):
    lift = AugmentConfig(spread=4.0)
    assert value(REF, MOV, T, lift=replace(lift, intensity=intensity), encounters=[AT]) == value(
        REF, MOV, T, lift=lift, encounters=[AT]
    )


def test_near_walls_count_more_than_far_ones_and_the_spread_says_what_is_near():
    near, far = hall([(3.0, 4.5, 5.0, 4.55)]), hall([(3.0, 7.5, 5.0, 7.55)])
    little, much = AugmentConfig(spread=1.5), AugmentConfig(spread=20.0)
    assert value(near, near, lift=little) > 4 * value(far, far, lift=little)
    assert value(near, near, lift=much) == pytest.approx(value(far, far, lift=much), rel=0.03)


@settings(max_examples=25)
@given(st.data())
def test_a_second_encounter_adds_weight_and_takes_none(data):
    grid = data.draw(small_maps())
    places = [
        grid.origin.apply(np.array(data.draw(st.tuples(st.floats(0, 3), st.floats(0, 3))))) for _ in range(2)
    ]
    met = [Encounter(place, place, np.eye(2) * 0.01) for place in places]
    lift = AugmentConfig(spread=0.5)
    alone = value(grid, grid, lift=lift, encounters=met[:1])
    assert value(grid, grid, lift=lift, encounters=met) >= alone - 1e-4


def test_what_deviates_from_a_sighting_costs_its_share_of_wall():
    window = coupled_window([MIDDLE], WindowConfig("coupled", margin=0.1, deviations=3.5))
    wall = hall([(2.0, 4.0, 6.0, 4.05)])
    config = AgreementConfig(evidence=0.25)
    sigma = np.sqrt(window.covariances[0][0, 0])
    moved = Pose2(2 * sigma, 0.0, 0.0)  # along the wall, so that the wall itself hardly changes its mind
    free = value(wall, wall, moved, config)
    assert value(wall, wall, moved, config, window=window) == pytest.approx(free - 0.25 * 0.5 * 4, abs=1e-6)
    assert value(wall, wall, window=window, config=config) == pytest.approx(value(wall, wall), abs=1e-6)


def test_a_thick_wall_has_two_sides_and_no_inside():
    cells = hall([(2.0, 3.0, 6.0, 5.0)])
    seen = surface(cells.occupied, cells.free)
    edge = 2 * (80 + 40) - 4  # cells
    assert np.count_nonzero(seen) == edge
    half = GridMap(np.where(np.arange(160)[:, None] < 80, cells.cells, UNKNOWN).astype(np.int8), 0.05)
    assert np.count_nonzero(surface(half.occupied, half.free)) < edge


def test_the_distance_is_that_between_the_centres_of_cells():
    walls = np.zeros((5, 6), dtype=bool)
    walls[2, 1] = True
    distance = distance_to_walls(walls)
    assert distance[2, 1] == 0
    assert distance[2, 4] == 3
    assert distance[4, 3] == pytest.approx(np.hypot(2, 2))
    assert distance_to_walls(np.zeros((3, 3), dtype=bool)).min() > 1e5


@settings(max_examples=40)
@given(problems(), st.data())
def test_no_transform_agrees_in_more_wall_than_there_is(problem, data):
    objective = problem.objective
    if len(objective.sides) == 1:  # Γ
        return
    poses = np.array(
        [[data.draw(st.floats(-60, 60)), data.draw(st.floats(-60, 60)), data.draw(st.floats(-3, 3))]]
    )
    wall = sum(float(side.weights.sum()) for side in objective.sides)
    assert objective(poses)[0] <= wall * (1 + 1e-6)


def test_the_known_pose_beats_every_other_of_a_coarse_circle():
    objective = make_agreement(REF, MOV, [AT], AugmentConfig(spread=4.0), AgreementConfig())
    turns = T.theta + np.arange(5, 356, 5) * np.pi / 180
    others = [Pose2(theta=turn).apply(AT.x_mov) for turn in turns]
    poses = np.array([[*(AT.x_ref - there), turn] for there, turn in zip(others, turns, strict=True)])
    right = objective(T.array()[None])[0]
    assert right > 2 * objective(poses).max()


@settings(max_examples=40)
@given(small_maps(side=12), st.floats(0, 5))
def test_a_map_laid_on_itself_agrees_in_every_wall_that_was_seen_from_somewhere(grid, penalty):
    middle = grid.centres(np.array([grid.height // 2]), np.array([grid.width // 2]))[0]
    met = [Encounter(middle, middle, np.eye(2) * 0.01)]
    seen = 0
    for row, col in np.argwhere(grid.occupied):
        seen += grid.free[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2].any()
    found = value(grid, grid, config=AgreementConfig(penalty=penalty), encounters=met)
    assert found == pytest.approx(2 * seen * grid.resolution, rel=0.02, abs=1e-6)


@settings(max_examples=30)
@given(st.data(), st.sampled_from(list(Lookup)))
def test_swapping_any_two_maps_changes_nothing_either(data, lookup):
    ref, mov = data.draw(small_maps()), data.draw(small_maps())
    met = data.draw(encounters_in(ref, mov))
    back = [Encounter(at.x_mov, at.x_ref, at.covariance) for at in met]
    turn = data.draw(angles)
    T_turned = Pose2(theta=turn)
    T_ref_mov = Pose2(*(met[0].x_ref - T_turned.apply(met[0].x_mov)).tolist(), turn)
    lift, config = AugmentConfig(spread=1.0, aspect=2.0, tilt=20.0), AgreementConfig()
    there = make_agreement(ref, mov, met, lift, config, lookup=lookup)(T_ref_mov.array()[None])
    again = make_agreement(mov, ref, back, lift, config, lookup=lookup)(T_ref_mov.inverse().array()[None])
    assert there == pytest.approx(again, rel=1e-3, abs=1e-3)


@settings(max_examples=25)
@given(st.floats(-1, 1), st.floats(-1, 1), angles, st.floats(0, 5), st.sampled_from([0.05, 0.1, 0.2]))
def test_a_wall_in_free_floor_takes_back_the_same_wherever_it_lies_and_however(x, y, turn, penalty, cell):
    bare, wall = hall(), hall([(3.0, 4.0, 5.0, 4.0 + cell)], cell=cell)
    at_middle = Pose2(4.0 + x, 4.0 + y, turn) @ Pose2(-4.0, -4.0)
    config = AgreementConfig(penalty=penalty)
    assert value(bare, wall, at_middle, config) == pytest.approx(-2.0 * penalty, rel=0.02, abs=1e-6)
    assert value(wall, bare, at_middle, config) == pytest.approx(-2.0 * penalty, rel=0.02, abs=1e-6)


@settings(max_examples=25)
@given(small_maps())
def test_what_the_other_robot_saw_beyond_says_nothing(annex):
    known = hall([(0.0, 0.0, 3.0, 0.05), (1.0, 1.0, 1.05, 2.5)], side=3.0)
    ref = np.full((160, 160), UNKNOWN, dtype=np.int8)
    ref[:60, :60] = known.cells
    mov = ref.copy()
    mov[100 : 100 + annex.height, 100 : 100 + annex.width] = annex.cells  # 2 m on, 20 blurs
    without, beyond = GridMap(ref, 0.05), GridMap(mov, 0.05)
    for pose in (Pose2(), Pose2(0.07, -0.03, 0.02)):
        assert value(without, beyond, pose) == pytest.approx(value(without, without, pose), abs=1e-4)
        assert value(beyond, without, pose) == pytest.approx(value(without, without, pose), abs=1e-4)


@settings(max_examples=20)
@given(st.tuples(*4 * [st.integers(0, 40)]), poses)
def test_unknown_ground_around_a_map_changes_nothing(margins, T_new):
    bottom, top, left, right = margins
    cells = np.pad(REF.cells, ((bottom, top), (left, right)), constant_values=UNKNOWN)
    corner = Pose2(-left * REF.resolution, -bottom * REF.resolution)
    wide = GridMap(cells, REF.resolution, T_new @ REF.origin @ corner)
    at = Encounter(T_new.apply(AT.x_ref), AT.x_mov, AT.covariance)
    lift = AugmentConfig(spread=0.6)  # a part of the map, so that where that part lies matters
    plain = make_agreement(REF, MOV, [AT], lift, AgreementConfig())(T.array()[None])
    moved = make_agreement(wide, MOV, [at], lift, AgreementConfig())((T_new @ T).array()[None])
    assert moved == pytest.approx(plain, rel=1e-3)


@pytest.mark.parametrize("cells", [2, 3, 8])
def test_both_sides_of_a_thick_wall_agree_and_of_a_thin_one_the_only_one_it_has(cells):
    thin = hall([(4.0, 0.0, 4.05, 8.0)])
    thick = hall([(4.0, 0.0, 4.0 + 0.05 * cells, 8.0)])
    assert value(thick, thick) == pytest.approx(2 * value(thin, thin), rel=0.01)


@settings(max_examples=30)
@given(st.floats(-40, 40), st.floats(-40, 40), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), angles)
def test_the_sightings_pull_is_the_same_wherever_the_sighting_is(x, y, dx, dy, turn):
    def pull(x_ref):
        at = Encounter(x_ref, AT.x_mov, np.diag([0.2, 0.05]) ** 2)
        window = coupled_window([at], WindowConfig("coupled"))
        there = x_ref + (dx, dy) - Pose2(theta=turn).apply(AT.x_mov)
        poses = np.array([[*there, turn]])
        lift, config = AugmentConfig(), AgreementConfig()
        with_it, without = (make_agreement(REF, MOV, [at], lift, config, w)(poses) for w in (window, None))
        return float(with_it[0] - without[0])

    moved = pull(AT.x_ref + (x, y))
    assert moved == pytest.approx(pull(AT.x_ref), abs=1e-6)
    assert moved <= 0


@given(arrays(bool, st.tuples(st.integers(1, 8), st.integers(1, 8))))
def test_no_wall_is_nearer_than_the_distance_says_and_one_is_as_near(walls):
    distance = distance_to_walls(walls)
    at = np.argwhere(walls)
    for row, col in np.ndindex(walls.shape):
        nearest = np.hypot(*(at - (row, col)).T).min() if len(at) else 1e6
        assert distance[row, col] == pytest.approx(nearest, abs=1e-4)


def test_a_wall_at_the_edge_of_what_counts_is_looked_up_as_far_again_from_the_encounter():
    """Where the search has moved map 2 by much, its walls land where map 1 has its own."""
    lift = AugmentConfig(spread=1.5)  # walls farther off than 3.7 m do not count
    ref, mov = (hall([(x, 7.0, x + 0.05, 9.0)], side=16.0) for x in (13.0, 10.5))
    at = Encounter(np.array([8.0, 8.0]), np.array([8.0, 8.0]), np.eye(2) * 0.01)
    for pair, pose in (((ref, mov), Pose2(2.5, 0.0)), ((mov, ref), Pose2(-2.5, 0.0))):
        assert value(*pair, pose, lift=lift, encounters=[at]) > 0.3
        assert value(*pair, lift=lift, encounters=[at]) < 0


def test_a_wall_as_near_to_a_robot_as_its_size_is_the_robot_and_one_beyond_is_a_wall():
    def weigh(away, size):
        wall = hall([(4.0 - away, 3.9, 4.05 - away, 4.1)])
        objective = make_agreement(
            wall, wall, [MIDDLE], WIDE, AgreementConfig(), None, Lookup.NEAREST, robot_size=size
        )
        return float(objective(Pose2().array()[None])[0])

    assert weigh(0.5, 0.4) == pytest.approx(weigh(0.5, 0.0), rel=0.01)
    assert weigh(0.5, 0.4) == pytest.approx(2 * 0.2, rel=0.01)
    assert weigh(0.3, 0.4) == 0


def test_what_one_transform_costs_is_counted_over_both_directions():
    near, far = hall([(3.0, 4.5, 5.0, 4.55)]), hall([(3.0, 4.5, 4.0, 4.55)])
    objective = make_agreement(near, far, [MIDDLE], WIDE, AgreementConfig())
    assert [len(side.points) for side in objective.sides] == [20, 40]


def test_walls_that_count_next_to_nothing_are_left_out_and_cost_nothing():
    lift = AugmentConfig(spread=1.0)  # a wall at 2.4 m counts as 5% of one at the encounter
    for away, cells in ((2.3, 4), (2.6, 0)):
        wall = hall([(4.0 + away, 3.9, 4.05 + away, 4.1)])
        sides = make_agreement(wall, hall(), [MIDDLE], lift, AgreementConfig()).sides
        assert sum(len(side.points) for side in sides) == cells


def test_of_an_uneven_spread_the_longer_axis_says_how_far_walls_are_looked_up():
    """Along it a wall counts that lies far beyond what counts across it."""
    lift = AugmentConfig(spread=1.0, aspect=5.0, tilt=0.0)
    axis = np.argmax(np.diag(lift.covariance()))
    far = 1.8 * np.sqrt(lift.covariance()[axis, axis])
    box = [8.0 - 0.5, 8.0 - 0.5, 8.0 + 0.5, 8.0 + 0.5]
    box[axis], box[axis + 2] = 8.0 + far, 8.05 + far
    wall = hall([tuple(box)], side=16.0)
    at = Encounter(np.array([8.0, 8.0]), np.array([8.0, 8.0]), np.eye(2) * 0.01)
    assert value(wall, wall, lift=lift, encounters=[at]) > 0.25


@given(st.floats(1.0, 3.0), st.floats(1.0, 3.0), st.floats(0.2, 0.6))
def test_what_says_nothing_around_a_robot_is_a_disc_with_the_robot_in_its_middle(x, y, radius):
    grid = hall(side=4.0)
    table = np.ones((80 + 2 * PAD, 80 + 2 * PAD), dtype=np.float32)
    clear(table, grid, np.zeros(2), np.array([[x, y]]), radius)
    rows, cols = np.indices(grid.cells.shape)
    away = np.hypot(*(grid.centres(rows.ravel(), cols.ravel()) - (x, y)).T).reshape(rows.shape)
    inside = table[PAD:-PAD, PAD:-PAD] == 0
    assert (away[inside] < radius + 1e-9).all()
    assert (away[~inside] > radius - 1e-9).all()
    assert table.size - table.sum() == inside.sum()
