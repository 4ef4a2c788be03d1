"""One turn of a laser in a scene: the building's walls and furniture, other robots, mirrors."""

from __future__ import annotations

import numpy as np

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray, Pose2
from algorithms.sensors.laser_scan import LaserScan
from algorithms.simulator.buildings.floor_plan import AIR, DARK, Surface
from algorithms.simulator.lidar import Lidar, first_hit
from algorithms.simulator.portable_random import DIRECTIONS, METRE_GRID, TURN, normals, uniforms
from algorithms.simulator.views.rendering.ray_casting import Index
from algorithms.simulator.views.solids import SolidTable, ticks_of
from algorithms.simulator.views.view_scene import ViewScene

LASER_HEIGHT = 0.3  # metres; it hits the boards of robots
NEAREST = 0.05  # metres; the least range


@kernel
def _footprint_hit(x: float, y: float, dx: float, dy: float, bodies: FloatArray) -> float:
    """Distance to the first of (M, 7) outlines as of ``SolidTable.at_height``; a large number if none is."""
    found = 1e9
    for n in range(len(bodies)):
        c, s, half_x, half_y = bodies[n, 2], bodies[n, 3], bodies[n, 4], bodies[n, 5]
        ox, oy = x - bodies[n, 0], y - bodies[n, 1]
        px, py = c * ox + s * oy, c * oy - s * ox
        qx, qy = c * dx + s * dy, c * dy - s * dx
        if bodies[n, 6] != 0:
            px, py, qx, qy = px / half_x, py / half_y, qx / half_x, qy / half_y
            a, b, rest = qx * qx + qy * qy, px * qx + py * qy, px * px + py * py - 1.0
            if b * b - a * rest > 0:
                t = (-b - np.sqrt(b * b - a * rest)) / a
                if 0 < t < found:
                    found = t
            continue
        enter, leave = -1e30, 1e30
        for axis in range(2):
            origin, way, half = (px, qx, half_x) if axis == 0 else (py, qy, half_y)
            if way == 0.0:
                if abs(origin) > half:
                    leave = -1e30
                continue
            near, far = (-half - origin) / way, (half - origin) / way
            enter, leave = max(enter, min(near, far)), min(leave, max(near, far))
        if 0 < enter <= leave and enter < found:
            found = enter
    return found


@kernel
def _mirror_hit(x: float, y: float, dx: float, dy: float, mirrors: FloatArray) -> tuple[float, int]:
    """Distance to the first of (M, 4) mirrors met from its front, and which; a large number if none is."""
    found, which = 1e9, -1
    for n in range(len(mirrors)):
        ex, ey = mirrors[n, 2] - mirrors[n, 0], mirrors[n, 3] - mirrors[n, 1]
        across = dx * ey - dy * ex
        if across >= 0:  # from behind
            continue
        ox, oy = mirrors[n, 0] - x, mirrors[n, 1] - y
        t, share = (ox * ey - oy * ex) / across, (ox * dy - oy * dx) / across
        if t > 0 and 0 <= share <= 1 and t < found:
            found, which = t, n
    return found, which


@kernel
def _turn(
    surface: Surface, cell: float, x: float, y: float, ways: FloatArray, reach: float,
    bodies: FloatArray, mirrors: FloatArray, ranges: FloatArray, kinds: Index,
) -> None:  # fmt: skip
    """Fill in what a perfect laser measures along (2, N) unit vectors, and what its beams meet."""
    for i in range(ways.shape[1]):
        dx, dy = ways[0, i], ways[1, i]
        wall, kind = first_hit(surface, cell, x, y, dx, dy, reach)
        body = _footprint_hit(x, y, dx, dy, bodies)
        glass, which = _mirror_hit(x, y, dx, dy, mirrors)
        if which >= 0 and glass < body and glass < min(wall + 3 * cell, reach):
            ex, ey = mirrors[which, 2] - mirrors[which, 0], mirrors[which, 3] - mirrors[which, 1]
            length = np.sqrt(ex * ex + ey * ey)
            nx, ny = ey / length, -ex / length
            across = dx * nx + dy * ny
            px, py = x + glass * dx, y + glass * dy
            dx, dy = dx - 2 * across * nx, dy - 2 * across * ny
            skipped = min(2 * cell / max(-across, 0.05), 0.5)  # out of the wall, whose cells are not so exact
            wall, kind = first_hit(surface, cell, px + skipped * dx, py + skipped * dy, dx, dy, reach)
            wall, body = wall + skipped + glass, _footprint_hit(px, py, dx, dy, bodies) + glass
        if body < wall:
            wall, kind = body, 1
        if wall >= reach:
            wall, kind = reach, 0
        ranges[i], kinds[i] = wall, kind


def scan_of(
    scene: ViewScene, pose: Pose2, mounting: Pose2, lidar: Lidar, rng: np.random.Generator
) -> LaserScan:
    """What a robot's laser measures, with noise and losses as ``lidar.scan`` has them.

    pose     : of the robot, T_world_robot; itself it does not see
    mounting : T_robot_laser
    rng      : draws noise and losses
    returns  : ranges in metres; NaN where nothing useful came back, inf where nothing was within reach
    """
    T_world_laser = pose @ mounting
    x, y = (round(at * METRE_GRID) / METRE_GRID for at in (T_world_laser.x, T_world_laser.y))
    beams = lidar.beam_ticks()
    ways = np.ascontiguousarray(DIRECTIONS[:, (ticks_of(T_world_laser.theta) + beams) % TURN])
    things = list(scene.things)
    for n, (stands, body) in enumerate(scene.robots):
        things += body.solids(stands, n)
    bodies = SolidTable.of(things).at_height(LASER_HEIGHT)
    faces = [mirror.face() for mirror in scene.mirrors if mirror.bottom < LASER_HEIGHT < mirror.top]
    mirrors = np.array(faces, dtype=np.float64).reshape(-1, 4)
    ranges, kinds = np.empty(lidar.beams), np.empty(lidar.beams, dtype=np.int32)
    building = scene.building
    _turn(building.surface, building.resolution, x, y, ways, lidar.reach, bodies, mirrors, ranges, kinds)
    noise, drawn = normals(rng, lidar.beams), uniforms(rng, lidar.beams)
    lost = drawn < np.where(kinds == DARK, lidar.lost_on_dark, lidar.lost)
    noisy = np.maximum(ranges + lidar.noise * noise, NEAREST)
    measured = np.where(lost, np.nan, np.where(kinds == AIR, np.inf, noisy))
    step = 2 * np.pi / TURN
    return LaserScan(
        angle_min=float(beams[0]) * step,
        angle_increment=lidar.field / 360 * 2 * np.pi / lidar.beams,
        ranges=measured,
        range_min=NEAREST / 2,
        range_max=lidar.reach + 6 * lidar.noise,
        mounting=mounting,
    )
