"""A warehouse: aisles that nearly repeat, a building made to mislead."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.buildings.floor_plan import Building, FloorPlan
from algorithms.simulator.buildings.furniture import boxes, door, furnish, plant
from algorithms.simulator.buildings.office import INNER, MARGIN, OUTER, windows
from algorithms.simulator.portable_random import chance, uniform, whole

BAY = 2.7  # metres between the posts of a rack
POST = 0.1


def _rack(plan: FloorPlan, rng: np.random.Generator, x: float, y: float, bays: int, depth: float) -> None:
    """A pallet rack standing upright from (x, y): posts at every bay, pallets between them."""
    plan.note("rack", (x, y, x + depth, y + bays * BAY + POST))
    for bay in range(bays + 1):
        for side in (x, x + depth - POST):
            plan.box(side, y + bay * BAY, side + POST, y + bay * BAY + POST)
    for bay in range(bays):
        for slot in (0.2, 1.45):
            if chance(rng, 0.84):
                left = x + uniform(rng, -0.06, 0.1)
                low = y + bay * BAY + slot + uniform(rng, -0.06, 0.06)
                pallet = (left, low, left + uniform(rng, 0.8, 1.0), low + uniform(rng, 0.8, 1.15))
                plan.note("pallet", pallet)
                plan.box(*pallet)


def warehouse(shell: np.random.Generator, rng: np.random.Generator, resolution: float = 0.025) -> Building:
    """A hall of about 30 m × 24 m: racks at an even pitch, a dock in front, an office in a corner."""
    pitch, depth = uniform(shell, 3.5, 4.1), 1.1
    racks, bays = whole(shell, 6, 8), whole(shell, 4, 6)
    dock, back = uniform(shell, 4.5, 6.5), uniform(shell, 2.4, 3.2)
    width, height = racks * pitch + 3.0, dock + bays * BAY + POST + back
    plan = FloorPlan(width + 2 * MARGIN, height + 2 * MARGIN, resolution)
    left, bottom, right, top = MARGIN, MARGIN, MARGIN + width, MARGIN + height
    plan.outline(left, bottom, right, top, OUTER)
    windows(plan, shell, left, bottom, right, top)
    inside = (left + OUTER / 2, bottom + OUTER / 2, right - OUTER / 2, top - OUTER / 2)
    corner = uniform(rng, 4.0, 6.0)
    deep = min(dock - 2.2, uniform(rng, 2.6, 3.4))
    x_office = left if chance(rng, 0.5) else right - corner
    plan.outline(x_office, bottom, x_office + corner, bottom + deep, INNER)
    door(plan, rng, x_office + uniform(rng, 0.5, corner - 1.6), bottom + deep, (1, 0), (0, -1), shut=0.0)
    office = (x_office + 0.1, bottom + 0.2, x_office + corner - 0.1, bottom + deep - 0.1)
    furnish(plan, rng, office, "work")
    plan.stops.append((x_office + corner / 2, bottom + deep / 2))
    y_racks = bottom + dock
    for rack in range(racks):
        x = left + 2.6 + rack * pitch
        short = 1 if chance(rng, 0.25) else 0
        _rack(plan, rng, x, y_racks + short * BAY, bays - short, depth)
        if chance(rng, 0.3):  # a guard at the head of the aisle
            plan.pillar(x + depth / 2, y_racks + short * BAY - 0.35, uniform(rng, 0.08, 0.2), "guard")
    for column in range(2, racks, 3):  # the pillars of the hall
        x = left + 2.6 + column * pitch + depth / 2
        for y in (bottom + dock * 0.55, top - 0.6):
            if plan.is_empty(x - 0.3, y - 0.3, x + 0.3, y + 0.3):
                plan.note("square pillar", (x - 0.2, y - 0.2, x + 0.2, y + 0.2))
                plan.box(x - 0.2, y - 0.2, x + 0.2, y + 0.2)
    for lane in range(racks + 1):
        x = left + 2.6 + (lane - 0.5) * pitch + depth / 2 if lane else left + 1.3
        x = min(x, right - 1.2)
        for share in (0.15, 0.5, 0.85):
            plan.stops.append((x, y_racks + share * bays * BAY))
        plan.stops += [(x, bottom + dock * 0.62), (x, top - back / 2)]
    for _ in range(whole(rng, 3, 6)):
        boxes(plan, rng, (inside[0], bottom + deep, inside[2], y_racks - 0.5))
        plant(plan, rng, inside)
    return plan.finish("warehouse")
