"""The simple bodies that all things but walls are made of: boxes, drums and eggs that stand upright."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.simulator.portable_random import TURN, cosine, sine
from algorithms.simulator.views.surfaces.materials import Material

BOX, DRUM, EGG = 0, 1, 2
FRONT, BACK, LEFT, RIGHT, TOP, BOTTOM = range(6)
ROUND = FRONT  # the face of a drum's mantle and of an egg
NOBODY = -1  # no robot that a solid belongs to


def ticks_of(theta: float) -> int:
    """The whole ticks nearest to an angle in radians."""
    return round(theta * TURN / (2 * np.pi)) % TURN


@dataclass(frozen=True, eq=False)
class Solid:
    """A body in the world, or in the frame of what it is a part of; metres.

    x, y   : its middle
    depth  : along the direction in which its front looks
    width  : across
    bottom, top : heights
    faces  : its materials by FRONT … BOTTOM, or one for all
    ticks  : the front's direction, counter-clockwise from x
    shape  : BOX, DRUM (upright axis) or EGG
    robot  : whose part it is, by its number in the scene, or NOBODY
    """

    x: float
    y: float
    depth: float
    width: float
    bottom: float
    top: float
    faces: tuple[Material, ...]
    ticks: int = 0
    shape: int = BOX
    robot: int = NOBODY

    def moved(self, x: float, y: float, ticks: int, robot: int = NOBODY) -> Solid:
        """It in the frame in which its own frame stands at (x, y), turned by so many ticks."""
        c, s = float(cosine(ticks)), float(sine(ticks))
        there = x + c * self.x - s * self.y, y + s * self.x + c * self.y
        return replace(self, x=there[0], y=there[1], ticks=(self.ticks + ticks) % TURN, robot=robot)

    def corners(self) -> FloatArray:
        """(4, 2) corners of its outline, counter-clockwise from front left."""
        c, s = float(cosine(self.ticks)), float(sine(self.ticks))
        a, b = self.depth / 2, self.width / 2
        along, across = np.array([a, -a, -a, a]), np.array([b, b, -b, -b])
        return np.stack([self.x + c * along - s * across, self.y + s * along + c * across], axis=1)


@dataclass(frozen=True, eq=False)
class SolidTable:
    """Many solids as arrays, one row each, as kernels want them.

    place : (K, 8) x, y, cosine, sine, half depth, half width, bottom, top
    shape, robot : (K,)
    faces : (K, 6) rows of ``materials``
    """

    place: FloatArray
    shape: NDArray[np.int32]
    robot: NDArray[np.int32]
    faces: NDArray[np.int32]
    materials: tuple[Material, ...]

    def __len__(self) -> int:
        return len(self.place)

    @staticmethod
    def of(solids: Iterable[Solid]) -> SolidTable:
        listed = list(solids)
        known: dict[int, int] = {}
        materials: list[Material] = []

        def row(material: Material) -> int:
            if id(material) not in known:
                known[id(material)] = len(materials)
                materials.append(material)
            return known[id(material)]

        place = [(*_middle(one), one.depth / 2, one.width / 2, one.bottom, one.top) for one in listed]
        faces = [[row(material) for material in _six(one.faces)] for one in listed]
        return SolidTable(
            np.array(place, dtype=np.float64).reshape(-1, 8),
            np.array([one.shape for one in listed], dtype=np.int32),
            np.array([one.robot for one in listed], dtype=np.int32),
            np.array(faces, dtype=np.int32).reshape(-1, 6),
            tuple(materials),
        )

    def __add__(self, other: SolidTable) -> SolidTable:
        """The rows of both."""
        return SolidTable(
            np.concatenate([self.place, other.place]),
            np.concatenate([self.shape, other.shape]),
            np.concatenate([self.robot, other.robot]),
            np.concatenate([self.faces, other.faces + len(self.materials)]),
            self.materials + other.materials,
        )

    def only(self, kept: NDArray[np.bool_]) -> SolidTable:
        """Some of the rows."""
        return replace(
            self,
            place=self.place[kept],
            shape=self.shape[kept],
            robot=self.robot[kept],
            faces=self.faces[kept],
        )

    def at_height(self, height: float) -> FloatArray:
        """(M, 7) x, y, cosine, sine, half depth, half width, shape of those that a level beam may hit."""
        hit = (self.place[:, 6] <= height) & (self.place[:, 7] > height)
        return np.concatenate([self.place[hit, :6], self.shape[hit, None]], axis=1)


def _middle(solid: Solid) -> tuple[float, float, float, float]:
    return solid.x, solid.y, float(cosine(solid.ticks)), float(sine(solid.ticks))


def _six(faces: Sequence[Material]) -> Sequence[Material]:
    return faces if len(faces) == 6 else [faces[0]] * 6
