"""What a building looks like, and that it is the building."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.simulator.buildings.building_types import BUILDINGS, build
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.views.interiors.free_floor import free_floor
from algorithms.simulator.views.interiors.furnishings import SOLIDS
from algorithms.simulator.views.interiors.interior import interior_of
from algorithms.simulator.views.robot_scan import LASER_HEIGHT
from algorithms.simulator.views.surfaces.patterns import PATTERNS


@pytest.fixture(scope="module", params=["apartment", "home", "corridor"])
def building(request) -> Building:
    return build(request.param, 4)


def test_every_piece_of_a_floor_plan_has_looks(building):
    kinds = {piece.kind for piece in building.pieces}
    assert len(kinds) > 3
    assert kinds <= set(SOLIDS)


def test_every_material_has_a_pattern(building):
    interior = interior_of(building, 4)
    assert {one.pattern for one in (*interior.materials, *interior.solids.materials)} <= set(PATTERNS)


def test_what_a_laser_hits_of_furniture_a_camera_sees(building):
    """Most cells that are no wall lie in or beside a solid that reaches through the laser's height."""
    interior, cell = interior_of(building, 4), building.resolution
    solids = interior.solids.place[
        (interior.solids.place[:, 6] < LASER_HEIGHT) & (interior.solids.place[:, 7] > LASER_HEIGHT)
    ]
    loose = []
    for piece in building.pieces:
        if piece.kind in ("cabinet", "sofa", "carton", "plant", "drawers"):
            loose.append((piece.x, piece.y))
    off = np.array(loose)[:, None] - solids[None, :, :2]
    assert (off**2).sum(axis=2).min(axis=1).max() < (2 * cell) ** 2


def test_free_floor_is_indoors_and_clear(building):
    floor = free_floor(building)
    width = building.surface.shape[1]
    assert 0.2 < floor.inside.mean() < 0.95
    assert not floor.inside[0].any()
    assert not (floor.inside & building.solid).any()
    assert not floor.is_indoors(-1.0, 2.0)
    assert not floor.is_indoors(0.05, 0.05)
    assert floor.clear_of_walls(width * building.resolution + 1, 1.0) == 0
    middle = np.array([[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]])
    row, col = np.unravel_index(np.where(floor.inside, floor.clearance, 0).argmax(), floor.inside.shape)
    roomy = np.array([col + 0.5, row + 0.5]) * building.resolution
    assert floor.footprint_clear(middle + roomy)
    rows, cols = np.nonzero(building.solid)
    assert not floor.footprint_clear(middle + np.array([cols[0], rows[0]]) * building.resolution)


def test_shade_is_deepest_beside_what_stands_on_the_floor(building):
    interior, floor = interior_of(building, 4), free_floor(building)
    shade = interior.shade
    assert 0 <= shade.min() <= shade.max() <= 1
    near, far = (floor.inside & (floor.clearance < 0.06)), (floor.inside & (floor.clearance > 0.6))
    assert shade[near].mean() > 0.25
    assert shade[far].mean() < 0.1  # under tables there is some


@pytest.mark.parametrize("kind", list(BUILDINGS))
def test_two_seeds_of_a_building_differ_in_style(kind):
    if kind in ("office", "university", "warehouse"):
        return  # large ones take long, and are drawn the same way
    building = build(kind, 1)
    first, second = (interior_of(building, seed) for seed in (1, 2))
    assert first.style.floor.seed != second.style.floor.seed
    assert interior_of(building, 1) is first
