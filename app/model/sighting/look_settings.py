"""How a camera's image and a laser scan are looked at."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from algorithms.detection.footprint import Footprint
from algorithms.detection.svm_detector import LEAST_PROBABILITY
from algorithms.detection.tag_detector import FAMILIES

Finder = Literal["trained", "own", "tags"]


@dataclass(frozen=True)
class LookSettings:
    """What a person has set.

    finder            : the model that comes along, one's own, or tags
    least_probability : of a box that counts, where a model finds it
    family, tag_size  : of tags; metres, the side of the black square, 0 where it is not known
    body              : the outline of the robot that is seen
    use_map           : whether walls of map 1 are no robots
    field_of_view     : of a camera without a calibration, horizontally; radians, 0 where it is not known
    """

    finder: Finder = "trained"
    least_probability: float = LEAST_PROBABILITY
    family: str = next(iter(FAMILIES))
    tag_size: float = 0.0
    body: Footprint = field(default_factory=Footprint)
    use_map: bool = True
    field_of_view: float = 0.0

    @property
    def needs_scan(self) -> bool:
        """Whether only the laser tells how far the robot is: all but tags of a known size."""
        return self.finder != "tags" or not self.tag_size
