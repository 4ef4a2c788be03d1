"""In which frame, and in which cells, the merged map is given away."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, hypot, isfinite
from typing import Literal

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.maps.grid_map import FARTHEST, GridMap
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrected, Corrections
from algorithms.maps.resampling import Resampled, resampled
from app.report import correction_text

LEAST_APART = 0.01  # metres between an origin and a point on its x-axis; nearer says no direction


@dataclass(frozen=True)
class ExportFrame:
    """frame      : whose map's frame it is; of one that was chosen T_ref_frame, where it lies in map 1's
    yaw        : whether the map may lie turned in its frame; else its cells are resampled
    resolution : metres per cell; None: as they were merged
    """

    frame: Literal["ref", "mov"] | Pose2 = "ref"
    yaw: bool = True
    resolution: float | None = None

    def __post_init__(self) -> None:
        T = self.frame
        if isinstance(T, Pose2) and not (isfinite(T.theta) and max(abs(T.x), abs(T.y)) <= FARTHEST):
            raise SettingError(f"no frame lies at {T.x:g}, {T.y:g} m; give x, y and yaw in map 1's frame")

    @staticmethod
    def between(origin: tuple[float, float], on_x: tuple[float, float]) -> Pose2:
        """The frame with that origin whose x-axis leads to a point; both in map 1's frame, metres.

        raises : SettingError where they are one place
        """
        along, up = on_x[0] - origin[0], on_x[1] - origin[1]
        if hypot(along, up) < LEAST_APART:
            raise SettingError("the point on the x-axis is the origin itself; choose one farther away")
        return Pose2(*origin, atan2(up, along))

    def in_ref(self, T_ref_mov: Pose2) -> Pose2:
        """T_ref_frame: where the frame lies in map 1's."""
        if isinstance(self.frame, Pose2):
            return self.frame
        return Pose2() if self.frame == "ref" else T_ref_mov

    @property
    def said(self) -> str:
        """Whose frame it is, in words on map 1 and map 2."""
        owners = {"ref": "map 1's frame", "mov": "map 2's frame"}
        return owners.get(str(self.frame), "the frame that was chosen")

    @property
    def how(self) -> str:
        """All of it: "map 2's frame, without yaw, in cells of 0.1 m"."""
        cells = [] if self.resolution is None else [f"in cells of {self.resolution:g} m"]
        return ", ".join([self.said, *["without yaw"] * (not self.yaw), *cells])

    @property
    def as_merged(self) -> bool:
        """Whether its cells are those of the merge."""
        return self.yaw and self.resolution is None

    def given(self, merged: GridMap, T_ref_mov: Pose2) -> ExportedMap:
        """The merged map, which came in map 1's frame; raises SettingError, TooLargeError."""
        T_ref_frame = self.in_ref(T_ref_mov)
        if self.frame != "ref":
            merged = replace(merged, origin=T_ref_frame.inverse() @ merged.origin)
        return ExportedMap(self, T_ref_frame, resampled(merged, self.resolution, self.yaw))

    def given_corrected(self, made: Corrected, T_ref_mov: Pose2) -> ExportedMap:
        """The same of a map that a person corrected."""
        return replace(self.given(made.grid, T_ref_mov), corrections=made.by, corrected=made.changed)


AS_MERGED = ExportFrame()


@dataclass(frozen=True, eq=False)
class ExportedMap:
    """The merged map as it is given away: in which frame, where that lies in map 1's, and in which cells.

    corrections : that a person made in it
    corrected   : how many cells those changed, before any resampling
    """

    frame: ExportFrame
    T_ref_frame: Pose2
    cells: Resampled
    corrections: Corrections = NO_CORRECTIONS
    corrected: int = 0

    @property
    def as_merged(self) -> bool:
        """Whether nothing was done to it."""
        return self.frame == AS_MERGED and self.corrections == NO_CORRECTIONS

    @property
    def said(self) -> str:
        """In which frame it is, and what was done to its cells: sentences on map 1 and map 2."""
        changes = "" if self.frame.as_merged else f": {changes_text(self.cells)}"
        by_hand = correction_text.said(self.corrections, self.corrected)
        return " ".join(filter(None, [f"The merged map is in {self.frame.how}{changes}.", by_hand]))


def changes_text(told: Resampled) -> str:
    """How many cells say something else than they did, and what: the end of a sentence."""
    if not told.changed:
        return f"none of {told.of:,} cells changed"
    became = [f"{told.now_wall:,} are wall now"] * bool(told.now_wall)
    became += [f"{told.now_free:,} free floor"] * bool(told.now_free)
    return f"{told.changed:,} of {told.of:,} cells changed, {' and '.join(became)}"
