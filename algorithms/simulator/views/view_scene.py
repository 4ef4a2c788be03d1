"""What there is to see: a building, robots in it, posters and mirrors on its walls, what stands about."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.views.interiors.interior import Interior, hung, interior_of
from algorithms.simulator.views.light import Light
from algorithms.simulator.views.robot_body import RobotBody
from algorithms.simulator.views.solids import Solid, SolidTable
from algorithms.simulator.views.surfaces.materials import MIRROR, Material, Picture

FLAT = 0.006  # metres; how thick a poster is
FRAME = 0.025  # metres; how wide a mirror's frame is
GLASS = 0.02  # metres; how far a mirror's face is from its wall


@dataclass(frozen=True, eq=False)
class Poster:
    """A flat picture on a wall, over what hangs there.

    left, right : its ends on the wall, as one sees who looks at it; metres, world frame
    bottom, top : metres above the floor
    picture     : what it shows
    robot       : whether that is a robot
    """

    left: tuple[float, float]
    right: tuple[float, float]
    bottom: float
    top: float
    picture: Picture
    robot: bool = False

    def solid(self) -> Solid:
        face = Material("picture", picture=self.picture, fine=True)
        return hung(self.left, self.right, self.bottom, self.top, face, FLAT + 0.01)


@dataclass(frozen=True)
class Mirror:
    """A mirror on a wall; fields as in ``Poster``."""

    left: tuple[float, float]
    right: tuple[float, float]
    bottom: float = 0.02
    top: float = 2.0

    def normal(self) -> FloatArray:
        """(2,) unit vector into the air."""
        dx, dy = self.right[0] - self.left[0], self.right[1] - self.left[1]
        return np.asarray(np.array([dy, -dx]) / np.sqrt(dx * dx + dy * dy))

    def face(self) -> FloatArray:
        """(4,) the two ends of what reflects, x0, y0, x1, y1; metres, world frame."""
        off = self.normal() * GLASS
        return np.concatenate([np.array(self.left) + off, np.array(self.right) + off])

    def solid(self) -> Solid:
        return hung(self.left, self.right, self.bottom, self.top, MIRROR, GLASS)

    def frame(self) -> list[Solid]:
        """Strips along its upper edge and its sides."""
        metal = Material("plain", (0.35, 0.34, 0.33))
        (x0, y0), (x1, y1) = self.left, self.right
        share = FRAME / float(np.sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0)))
        dx, dy = share * (x1 - x0), share * (y1 - y0)
        sides = ((self.left, (x0 + dx, y0 + dy)), ((x1 - dx, y1 - dy), self.right))
        strips = [hung(a, b, self.bottom, self.top, metal, GLASS + 0.005) for a, b in sides]
        return [*strips, hung(self.left, self.right, self.top - FRAME, self.top, metal, GLASS + 0.005)]


@dataclass(frozen=True, eq=False)
class ViewScene:
    """All that a picture and a scan depend on, but for who looks.

    building : walls and furniture, which robots have in their maps
    robots   : where each stands, T_world_robot, and what it looks like
    posters, mirrors : on walls
    things   : what stands about and is in no map: cartons, bins, who hides a robot
    light    : and the faults of cameras
    seed     : of the building's style
    """

    building: Building
    robots: tuple[tuple[Pose2, RobotBody], ...] = ()
    posters: tuple[Poster, ...] = ()
    mirrors: tuple[Mirror, ...] = ()
    things: tuple[Solid, ...] = ()
    light: Light = field(default_factory=Light)
    seed: int = 0

    @property
    def interior(self) -> Interior:
        return interior_of(self.building, self.seed)

    @cached_property
    def movable(self) -> SolidTable:
        """What is not a part of the building; mirrors come first, in their order."""
        solids = [mirror.solid() for mirror in self.mirrors]
        solids += [poster.solid() for poster in self.posters]
        solids += [strip for mirror in self.mirrors for strip in mirror.frame()]
        solids += self.things
        for n, (pose, body) in enumerate(self.robots):
            solids += body.solids(pose, n)
        return SolidTable.of(solids)

    @cached_property
    def solids(self) -> SolidTable:
        """All solids, the building's first."""
        return self.interior.solids + self.movable

    def shadows(self) -> list[Solid]:
        """What throws a shadow on the floor and is not in the building's shade."""
        casters = [one for one in self.things if one.bottom < 0.2]
        for pose, body in self.robots:
            casters += body.solids(pose, 0)[:1]
        return casters
