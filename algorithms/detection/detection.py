"""What a detector finds in an image: boxes with a label and a probability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.sensors.camera import Camera

Picture = NDArray[np.uint8]
"""(H, W, 3) red, green, blue; row 0 at the top, as cameras have it."""

SAME_ROBOT = 0.4  # shared area over joint area, from which two boxes show one thing
WITHIN = 0.7  # share of the smaller box inside the larger one, from which they do as well


@dataclass(frozen=True)
class TagDistance:
    """How far a tag of known size is; metres.

    distance : of the tag's middle from the camera, along the floor
    sigma    : one standard deviation
    facing   : angle between the tag's normal and the way to the camera; radians
    """

    distance: float
    sigma: float
    facing: float


@dataclass(frozen=True)
class Detection:
    """A box in an image that may show a robot.

    left, top, right, bottom : of the box; pixels from the middle of the first pixel, rows go down
    probability : that it is a robot, as the detector sees it alone, 0 … 1
    label       : class of what is seen, as front_back, side or a tag's number
    tag         : distance, where a tag's size is known
    is_part     : whether the box frames a part of the robot alone, as a tag, and not all of it
    is_mirrored : whether what is printed on the robot reads backwards
    """

    left: float
    top: float
    right: float
    bottom: float
    probability: float
    label: str
    tag: TagDistance | None = None
    is_part: bool = False
    is_mirrored: bool = False

    @property
    def width(self) -> float:
        return self.right - self.left

    @property
    def middle(self) -> tuple[float, float]:
        """Column and row of the middle; pixels."""
        return (self.left + self.right) / 2, (self.top + self.bottom) / 2

    def box(self) -> tuple[float, float, float, float]:
        return self.left, self.top, self.right, self.bottom


class Detector(Protocol):
    """Finds robots in an image."""

    def detect(self, picture: Picture, camera: Camera | None = None) -> tuple[Detection, ...]:
        """What may be robots, the likeliest first.

        camera : that made the picture; a detector that measures distances needs it
        """


def overlaps(boxes: FloatArray, box: FloatArray) -> tuple[FloatArray, FloatArray]:
    """How far (N, 4) boxes cover another (4,) one: shared over joint area, and over the smaller one's."""
    wide = np.minimum(boxes[:, 2], box[2]) - np.maximum(boxes[:, 0], box[0])
    high = np.minimum(boxes[:, 3], box[3]) - np.maximum(boxes[:, 1], box[1])
    shared = np.maximum(wide, 0.0) * np.maximum(high, 0.0)
    areas = (boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])
    area = float((box[2] - box[0]) * (box[3] - box[1]))
    return shared / (areas + area - shared), shared / np.minimum(areas, area)


def strongest(found: Sequence[Detection]) -> tuple[Detection, ...]:
    """Of boxes that show one thing, the likeliest: non-maximum suppression. The likeliest box comes first.

    The box that stays lies in the middle of all that it stands for, weighted by their probabilities: windows
    lie on a grid, the robot does not.
    """
    order = sorted(found, key=lambda one: (-one.probability, one.box()))
    boxes = np.array([one.box() for one in order]).reshape(-1, 4)
    weights = np.array([one.probability for one in order])
    free = np.ones(len(order), dtype=bool)
    kept = []
    for k, one in enumerate(order):
        if not free[k]:
            continue
        joint, inner = overlaps(boxes, boxes[k])
        same = free & ((joint > SAME_ROBOT) | (inner > WITHIN))
        near = same & (joint > SAME_ROBOT)
        box = (boxes[near] * weights[near, None]).sum(axis=0) / weights[near].sum()
        free &= ~same
        left, top, right, bottom = box.tolist()
        kept.append(Detection(left, top, right, bottom, one.probability, one.label, one.tag, one.is_part))
    return tuple(kept)
