"""Rays end at what they meet first."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.simulator.buildings.floor_plan import FloorPlan
from algorithms.simulator.lidar import first_hit
from algorithms.simulator.portable_random import TURN
from algorithms.simulator.views.interiors.wall_outlines import WallFaces, wall_faces
from algorithms.simulator.views.rendering.ray_casting import FLOOR, RayCaster, Viewpoint
from algorithms.simulator.views.solids import BOTTOM, BOX, DRUM, EGG, FRONT, TOP, Solid, SolidTable
from algorithms.simulator.views.surfaces.materials import Material

PLAIN = (Material("plain"),)
NO_WALLS = WallFaces(np.zeros((0, 4)), np.zeros(0, dtype=np.uint8))
NOTHING = SolidTable.of([])
CEILING = 2.5


def some_boxes(seed: int) -> FloorPlan:
    rng = np.random.default_rng(seed)
    plan = FloorPlan(8.0, 6.0, 0.05)
    plan.outline(0.3, 0.3, 7.7, 5.7, 0.2)
    for x, y in 0.2 * rng.integers(
        (5, 5), (32, 22), (6, 2)
    ):  # no corner is finer than what a face leaves out
        plan.box(x, y, x + 0.4, y + 0.6)
    plan.box(3.6, 2.6, 4.4, 3.4, 0)
    return plan


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.integers(0, TURN - 1))
def test_the_depth_of_a_wall_is_what_a_beam_of_the_lidar_measures(seed, ticks):
    plan, view = some_boxes(seed), Viewpoint.looking(4.0, 3.0, 0.4, ticks)
    caster = RayCaster(view, wall_faces(plan.cells, 0.05), NOTHING, CEILING, (-1.0, 1.0))
    a = np.linspace(-0.99, 0.99, 101)
    depth = caster.cast(a, np.zeros(101)).depth
    wrong = 0
    for slope, found in zip(a.tolist(), depth.tolist(), strict=True):
        stretch = np.sqrt(1 + slope * slope)
        dx, dy = ((view.forward + slope * view.right) / stretch).tolist()
        distance, _ = first_hit(plan.cells, 0.05, 4.0, 3.0, dx, dy, 20.0)
        wrong += abs(distance - found * stretch) > 0.01
    assert wrong <= 2  # at edges


def surface_is_met(solid: Solid, view: Viewpoint, a: float, b: float, depth: float) -> bool:
    """Whether a point of a ray lies on the surface of a solid."""
    c, s = np.cos(solid.ticks * 2 * np.pi / TURN), np.sin(solid.ticks * 2 * np.pi / TURN)
    x, y = (
        np.array([view.x, view.y]) + depth * (view.forward + a * view.right) - [solid.x, solid.y]
    ).tolist()
    z = view.height - b * depth
    p, q = (c * x + s * y) / (solid.depth / 2), (c * y - s * x) / (solid.width / 2)
    r = (z - (solid.bottom + solid.top) / 2) / ((solid.top - solid.bottom) / 2)
    level = {BOX: max(abs(p), abs(q)), DRUM: np.hypot(p, q), EGG: np.sqrt(p * p + q * q + r * r)}[solid.shape]
    return abs((level if solid.shape == EGG else max(level, abs(r))) - 1) < 1e-3


@settings(max_examples=60)
@given(
    st.sampled_from([BOX, DRUM, EGG]), st.integers(0, TURN - 1), st.floats(1.0, 4.0), st.floats(-0.5, 0.5),
    st.floats(0.2, 1.0), st.floats(0.2, 1.0), st.floats(0.0, 1.0),
)  # fmt: skip
def test_rays_end_on_the_surface_of_a_solid_and_go_by_it_elsewhere(
    shape, ticks, far, aside, deep, wide, bottom
):
    view = Viewpoint.looking(1.0, -2.0, 0.6, 3000)
    x, y = (np.array([view.x, view.y]) + far * view.forward + aside * view.right).tolist()
    solid = Solid(x, y, deep, wide, bottom, bottom + 0.7, PLAIN, ticks, shape)
    caster = RayCaster(view, NO_WALLS, SolidTable.of([solid]), CEILING, (-1.0, 1.0))
    a, b = (grid.ravel() for grid in np.meshgrid(np.linspace(-0.9, 0.9, 37), np.linspace(-0.7, 0.7, 29)))
    hits = caster.cast(a, b)
    met = hits.surface >= 0
    for slope, down, depth in zip(a[met].tolist(), b[met].tolist(), hits.depth[met].tolist(), strict=True):
        assert surface_is_met(solid, view, slope, down, depth)
    floor = hits.surface == FLOOR
    assert np.allclose(hits.depth[floor], 0.6 / b[floor])


def test_faces_are_told_apart():
    solid = Solid(3.0, 0.0, 1.0, 1.0, 0.5, 0.8, PLAIN, TURN // 2)  # its front looks at the camera
    for height, b, face in ((0.6, 0.0, FRONT), (2.0, 0.45, TOP), (0.1, -0.14, BOTTOM)):
        view = Viewpoint.looking(0.0, 0.0, height, 0)
        caster = RayCaster(view, NO_WALLS, SolidTable.of([solid]), CEILING, (-1.0, 1.0))
        hits = caster.cast(np.array([0.0]), np.array([b]))
        assert (hits.surface[0], hits.face[0]) == (0, face)


def test_the_nearer_of_two_solids_is_met():
    near, far = (Solid(x, 0.0, 0.2, 0.2, 0.0, 1.0, PLAIN) for x in (2.0, 3.0))
    view = Viewpoint.looking(0.0, 0.0, 0.5, 0)
    for order in ([near, far], [far, near]):
        hits = RayCaster(view, NO_WALLS, SolidTable.of(order), CEILING, (-1.0, 1.0)).cast(
            np.zeros(1), np.zeros(1)
        )
        assert order[hits.surface[0]] is near
        assert hits.depth[0] == 1.9
