"""A robot as another one's camera sees it: a box behind four paper boards, each with a tag."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from algorithms.common.pose import FloatArray, Pose2
from algorithms.simulator.views.solids import DRUM, Solid, ticks_of
from algorithms.simulator.views.surfaces.materials import Colour, Material, Picture

PIXEL = 0.002  # metres of a board
MODULES = 8  # of a tag of the family 36h11, its black border included
WHITE, CREAM = (0.95, 0.95, 0.93), (0.93, 0.90, 0.81)
BAR, BAR_FROM_EDGE = 0.036, 0.016  # metres; the two upright bars of a board at the side
INK = 0.06  # how bright black paint is

FRONT_BACK, SIDE = "front_back", "side"
TOPS = ("laptop", "turret", "both", "bare")


@dataclass(frozen=True)
class RobotBody:
    """Its measures and its boards; metres, the robot's frame: x to the front, its middle at the origin.

    length, width : along x and y
    low, high     : heights between which the boards stand
    tags          : ids of the family 36h11 at front, back, left, right
    tag_size      : of a tag, its black border included
    paper         : colour of the boards
    top           : what it carries, one of TOPS
    """

    length: float = 0.46
    width: float = 0.40
    low: float = 0.06
    high: float = 0.50
    tags: tuple[int, int, int, int] = (0, 1, 2, 3)
    tag_size: float = 0.256
    paper: Colour = WHITE
    top: str = "laptop"

    @property
    def half_size(self) -> float:
        """Mean of half its length and half its width: from its middle to a face."""
        return (self.length + self.width) / 4

    def footprint(self, pose: Pose2) -> FloatArray:
        """(4, 2) corners of its outline, counter-clockwise from front left; metres, the pose's frame."""
        a, b = self.length / 2, self.width / 2
        return pose.apply(np.array([[a, b], [-a, b], [-a, -b], [a, -b]]))

    def corners(self, pose: Pose2) -> FloatArray:
        """(8, 3) corners of the box from the floor to the boards' upper edges; metres, frame of the pose."""
        level = self.footprint(pose)
        return np.array([[*corner, height] for height in (0.0, self.high) for corner in level.tolist()])

    def solids(self, pose: Pose2, robot: int) -> list[Solid]:
        """What it consists of where it stands; ``robot`` is its number in the scene."""
        ticks = ticks_of(pose.theta)
        return [part.moved(pose.x, pose.y, ticks, robot) for part in _parts(self)]

    def board(self, face: int) -> Picture:
        """The board at the front, the back, the left or the right (0 … 3); PIXEL metres per pixel."""
        return _board(self, face)


@lru_cache(maxsize=64)
def _board(body: RobotBody, face: int) -> Picture:
    wide = body.width if face < 2 else body.length
    rows, cols = round((body.high - body.low) / PIXEL), round(wide / PIXEL)
    paper, ink = (np.array(colour) * 255 for colour in (body.paper, (INK, INK, INK)))
    black = np.zeros((rows, cols), dtype=bool)
    if face >= 2:  # what tells a side from front and back
        first, last = round(BAR_FROM_EDGE / PIXEL), round((BAR_FROM_EDGE + BAR) / PIXEL)
        black[first:-first, first:last] = black[first:-first, cols - last : cols - first] = True
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    tag = np.asarray(cv2.aruco.generateImageMarker(family, body.tags[face], MODULES)) == 0
    module = max(1, round(body.tag_size / MODULES / PIXEL))
    tag = np.kron(tag, np.ones((module, module), dtype=bool))
    top, left = (rows - len(tag)) // 2, (cols - len(tag)) // 2
    black[top : top + len(tag), left : left + len(tag)] = tag
    board = np.where(black[..., None], ink, paper)
    board[[0, -1]] *= 0.75  # the edges of the paper
    board[:, [0, -1]] *= 0.75
    return np.asarray(np.rint(board), dtype=np.uint8)


@lru_cache(maxsize=64)
def _parts(body: RobotBody) -> tuple[Solid, ...]:
    boards = [Material("picture", picture=_board(body, face), fine=True) for face in range(4)]
    deck, dark = Material("plain", (0.5, 0.43, 0.33)), Material("plain", (0.13, 0.13, 0.14))
    parts = [
        Solid(0, 0, body.length, body.width, body.low, body.high, (*boards, deck, dark)),
        Solid(0, 0, body.length - 0.1, body.width - 0.1, 0.025, body.low, (dark,)),
    ]
    rubber, hub = Material("plain", (0.07, 0.07, 0.07)), Material("plain", (0.35, 0.35, 0.36))
    for x in (-0.14, 0.14):
        for side in (-1, 1):
            parts.append(
                Solid(x, side * (body.width / 2 - 0.035), 0.11, 0.05, 0.0, body.low + 0.01, (rubber,))
            )
            parts.append(Solid(x, side * (body.width / 2 - 0.012), 0.04, 0.01, 0.025, body.low, (hub,)))
    if body.top in ("laptop", "both"):
        parts += _laptop(body.high)
    if body.top in ("turret", "both"):
        case = Material("plain", (0.16, 0.17, 0.2))
        parts.append(Solid(0.13, 0, 0.11, 0.11, body.high, body.high + 0.035, (case,)))
        parts.append(Solid(0.13, 0, 0.085, 0.085, body.high + 0.035, body.high + 0.08, (dark,), shape=DRUM))
    return tuple(parts)


def _laptop(deck: float) -> list[Solid]:
    """A laptop that looks backwards, for who walks behind the robot."""
    grey, lid = Material("plain", (0.45, 0.46, 0.48)), Material("plain", (0.28, 0.29, 0.31))
    rows, cols = 20, 32
    screen = np.zeros((rows, cols, 3), dtype=np.uint8)
    screen[:] = (40, 70, 120)
    screen[4:16, 3:16], screen[4:16, 18:29] = (225, 228, 230), (60, 62, 66)
    screen[[0, -1]], screen[:, [0, -1]] = (20, 20, 22), (20, 20, 22)
    shown = Material("picture", picture=screen, glow=0.5)
    return [
        Solid(-0.1, 0, 0.22, 0.32, deck, deck + 0.018, (grey,)),
        Solid(0.015, 0, 0.012, 0.32, deck + 0.018, deck + 0.21, (lid, shown, lid, lid, lid, lid)),
    ]
