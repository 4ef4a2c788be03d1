"""What makes a robot hard to find, or makes one up: each sets up a scene, or finds no place for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.simulator.lidar import sees
from algorithms.simulator.portable_random import (
    TURN,
    chance,
    cosine,
    pick,
    radians,
    sine,
    snap,
    uniform,
    whole,
)
from algorithms.simulator.views.camera_image import eye_of, viewpoint
from algorithms.simulator.views.clutter import wall_near
from algorithms.simulator.views.projection import projected
from algorithms.simulator.views.reflections import reflection_seen
from algorithms.simulator.views.robot_poster import VARIANTS, robot_picture
from algorithms.simulator.views.solids import Solid, ticks_of
from algorithms.simulator.views.stage import Stage, Staged, draw_body
from algorithms.simulator.views.surfaces.materials import Material
from algorithms.simulator.views.view_scene import Mirror, Poster, ViewScene

HALF_HIDDEN = 0.3, 0.7  # share of a robot that is seen
WELL_SEEN = 0.95
FACING = 0.6  # cosine of the angle from a poster's normal under which it is seen, at least
STEP = 0.01  # metres; a robot beside a wall is at most so far from touching it


def plain(stage: Stage, rng: np.random.Generator, robot: bool) -> Staged | None:
    """A robot that stands free and is seen whole, or nobody."""
    observer = stage.observer(rng)
    if observer is None:
        return None
    if not robot:
        return Staged(stage.dressed(rng, observer, ()), observer)
    body, pose = draw_body(rng), stage.robot_before(rng, observer)
    if pose is None or not stage.is_whole(observer, pose, body):
        return None
    staged = Staged(stage.dressed(rng, observer, ((pose, body),)), observer)
    return staged if stage.share(staged) >= WELL_SEEN else None


def beside_wall(stage: Stage, rng: np.random.Generator, robot: bool) -> Staged | None:
    """A robot that touches a wall or a piece of furniture."""
    observer = stage.observer(rng)
    pose = stage.robot_before(rng, observer, clearance=0.3) if observer else None
    if observer is None or pose is None:
        return None
    body, way = draw_body(rng), whole(rng, 0, TURN - 1)
    if chance(rng, 0.6):  # robots that dock look straight away from a wall or along it
        pose = replace(pose, theta=radians(TURN // 4 * whole(rng, 0, 3)))
    step = np.array([float(cosine(way)), float(sine(way))]) * STEP
    for n in range(120):
        x, y = snap(pose.xy + step * (n + 1)).tolist()
        if not stage.floor.footprint_clear(body.footprint(replace(pose, x=x, y=y))):
            break
    else:
        return None
    x, y = snap(pose.xy + step * n).tolist()
    pose = replace(pose, x=x, y=y)
    far = float(np.sqrt(((pose.xy - observer.xy) ** 2).sum()))
    if not stage.distance[0] <= far <= stage.distance[1] or not stage.is_whole(observer, pose, body):
        return None
    staged = Staged(stage.dressed(rng, observer, ((pose, body),)), observer)
    return staged if stage.share(staged) >= 0.8 else None


def two_robots(stage: Stage, rng: np.random.Generator, robot: bool) -> Staged | None:
    """Two robots, at least one of them seen whole."""
    observer = stage.observer(rng)
    poses = [stage.robot_before(rng, observer) for _ in range(2)] if observer else []
    first, second = poses if poses else (None, None)
    if observer is None or first is None or second is None:
        return None
    bodies = draw_body(rng), draw_body(rng, 1)
    if ((first.xy - second.xy) ** 2).sum() < 0.7 * 0.7 or not all(
        stage.is_whole(observer, pose, body) for pose, body in zip((first, second), bodies, strict=True)
    ):
        return None
    robots = ((first, bodies[0]), (second, bodies[1]))
    staged = Staged(stage.dressed(rng, observer, robots), observer)
    shares = sorted(stage.share(staged, n) for n in range(2))
    return staged if shares[0] >= 0.5 and shares[1] >= WELL_SEEN else None


def half_hidden(stage: Stage, rng: np.random.Generator, robot: bool) -> Staged | None:
    """A robot behind something: furniture, a door's frame, or a box that was put before it."""
    observer = stage.observer(rng)
    if observer is None:
        return None
    body = draw_body(rng)
    by_chance = chance(rng, 0.4)
    pose = stage.robot_before(rng, observer, clearance=0.33, in_sight=not by_chance)
    if pose is None or not stage.is_whole(observer, pose, body):
        return None
    staged = Staged(stage.dressed(rng, observer, ((pose, body),)), observer)
    low, high = HALF_HIDDEN
    if by_chance:
        return staged if low <= stage.share(staged) <= high else None
    delta = pose.xy - observer.xy
    far = float(np.sqrt((delta * delta).sum()))
    ahead, aside = delta / far, np.array([-delta[1], delta[0]]) / far
    for _ in range(8):
        part, wide = uniform(rng, 0.45, 0.8), uniform(rng, 0.3, 0.6)
        if far * part < 0.6 or far * (1 - part) < 0.55:
            continue
        edge = pick(rng, (-1, 1)) * (wide / 2 + uniform(rng, -0.12, 0.12) * part)
        x, y = (observer.xy + ahead * far * part + aside * edge).tolist()
        box = _something(rng, x, y, wide)
        if not stage.floor.footprint_clear(box.corners()):
            continue
        scene = replace(staged.scene, things=(*staged.scene.things, box))
        hidden = Staged(scene, observer)
        if low <= stage.share(hidden) <= high:
            return hidden
    return None


def _something(rng: np.random.Generator, x: float, y: float, wide: float) -> Solid:
    """A box to hide behind."""
    kind = pick(rng, ("carton", "carton", "drawers", "fabric", "plain"))
    colour = pick(rng, ((0.66, 0.52, 0.36), (0.5, 0.5, 0.5), (0.85, 0.84, 0.8), (0.25, 0.3, 0.38)))
    face = Material(kind, colour, (0.75, 0.7, 0.6), (0.8, 0.2), whole(rng, 0, 199))
    return Solid(
        x, y, uniform(rng, 0.25, 0.5), wide, 0.0, uniform(rng, 0.4, 0.9), (face,), whole(rng, 0, TURN - 1)
    )


def mirror(stage: Stage, rng: np.random.Generator, robot: bool) -> Staged | None:
    """A robot that is seen in a mirror, and not beside it."""
    observer = stage.observer(rng)
    wide = uniform(rng, 0.9, 2.0)
    found = wall_near(rng, stage.building, stage.seed, observer.xy, 3.5, wide) if observer else None
    if observer is None or found is None:
        return None
    left, right = found
    glass = Mirror((float(left[0]), float(left[1])), (float(right[0]), float(right[1])))
    middle, normal = (left + right) / 2, glass.normal()
    observer = _turned_to(observer, middle, whole(rng, -1500, 1500))
    if not sees(stage.building, observer.xy, middle + 0.15 * normal):
        return None
    body = draw_body(rng)
    for _ in range(20):
        place = stage.floor.draw(rng, 0.4)
        if place is None:
            return None
        pose = Pose2(*place, radians(whole(rng, 0, TURN - 1)))
        off = float(((pose.xy - middle) * normal).sum())
        image = replace(pose, x=pose.x - 2 * off * float(normal[0]), y=pose.y - 2 * off * float(normal[1]))
        far = float(np.sqrt(((image.xy - observer.xy) ** 2).sum()))
        apart = float(np.sqrt(((pose.xy - observer.xy) ** 2).sum()))
        if off < 0.4 or far > 6.5 or apart < 0.7 or not stage.is_whole(observer, image, body):
            continue
        scene = replace(stage.dressed(rng, observer, ((pose, body),)), mirrors=(glass,))
        staged = Staged(scene, observer)
        if stage.share(staged) == 0 and _in_mirror(stage, staged) > 0.5:
            return staged
    return None


def _in_mirror(stage: Stage, staged: Staged) -> float:
    """Roughly the share of a robot that the first mirror shows."""
    return reflection_seen(staged.scene, 0, 0, staged.observer, stage.camera, stage.camera_height)[1]


def _turned_to(observer: Pose2, at: FloatArray, off: int) -> Pose2:
    """The observer on the spot, looking at a point but for some ticks."""
    dx, dy = (at - observer.xy).tolist()
    return replace(observer, theta=radians(ticks_of(float(np.arctan2(dy, dx))) + off))


def poster(stage: Stage, rng: np.random.Generator, robot: bool) -> Staged | None:
    """A photograph of a robot on a wall, and no robot."""
    observer = stage.observer(rng)
    variant = whole(rng, 0, VARIANTS - 1)
    return poster_before(stage, rng, observer, variant) if observer else None


def poster_before(stage: Stage, rng: np.random.Generator, observer: Pose2, variant: int) -> Staged | None:
    """A photograph of a robot on a wall near an observer, who turns to it on the spot."""
    picture, width, height = robot_picture(variant)
    found = wall_near(rng, stage.building, stage.seed, observer.xy, 4.5, width)
    if found is None:
        return None
    left, right = found
    hung = Poster(
        (float(left[0]), float(left[1])),
        (float(right[0]), float(right[1])),
        0.03,
        0.03 + height,
        picture,
        True,
    )
    middle = (left + right) / 2
    far = float(np.sqrt(((middle - observer.xy) ** 2).sum()))
    across = right - left
    facing = float((observer.xy - middle) @ np.array([across[1], -across[0]])) / width
    if not max(1.0, stage.distance[0]) <= far <= stage.distance[1] or facing < FACING * far:
        return None
    observer = _turned_to(observer, middle, whole(rng, -2500, 2500))
    scene = stage.dressed(rng, observer, ())
    scene = replace(scene, posters=(*(one for one in scene.posters if not _meet(one, hung)), hung))
    ends = np.array([[*left, 0.5], [*right, 0.5]])
    view = viewpoint(observer, stage.camera, stage.camera_height)
    seen = projected(view, stage.camera, ends)[:, 0]
    if not (np.isfinite(seen).all() and seen.min() > 0 and seen.max() < stage.camera.width):
        return None
    return Staged(scene, observer) if _is_open(stage, scene, observer, hung) else None


def _meet(one: Poster, other: Poster) -> bool:
    """Whether two posters may overlap."""
    apart = np.array(one.left) + np.array(one.right) - np.array(other.left) - np.array(other.right)
    return bool((apart * apart).sum() < 4 * 1.6 * 1.6)


def _is_open(stage: Stage, scene: ViewScene, observer: Pose2, hung: Poster) -> bool:
    """Whether little stands before a poster."""
    eye = eye_of(scene, observer, stage.camera, stage.camera_height)
    view = viewpoint(observer, stage.camera, stage.camera_height)
    shares = (np.arange(8) + 0.5) / 8
    along, up = (grid.ravel() for grid in np.meshgrid(shares, shares))
    left, right = np.array(hung.left), np.array(hung.right)
    level = left + (right - left) * along[:, None]
    depth, aside = view.seen_from(level)
    heights = hung.bottom + (hung.top - hung.bottom) * up
    traced = eye.trace(aside / depth, (view.height - heights) / depth)
    return bool((np.abs(traced.hits.depth - depth) < 0.06).mean() > 0.85)


Setting = Callable[[Stage, np.random.Generator, bool], Staged | None]

HARDSHIPS: dict[str, Setting] = {
    "beside wall": beside_wall,
    "two robots": two_robots,
    "half hidden": half_hidden,
    "mirror": mirror,
    "night": plain,
    "poster": poster,
}
"""Each sets up a view, given whether there is to be a robot; None: not there, try another place."""
