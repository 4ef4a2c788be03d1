"""The occupancy grid and its dual form. Row 0 is the bottom; everything metric is in metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from algorithms.common.errors import SettingError, TooLargeError
from algorithms.common.pose import FloatArray, Pose2, wrap_angle
from algorithms.common.source_file import SourceFile

BoolArray = NDArray[np.bool_]
CellArray = NDArray[np.int8]
Float32Array = NDArray[np.float32]

UNKNOWN = -1
FREE = 0
OCCUPIED = 100

# A cell of a scale or raw map is a wall from 65 % and free up to 25 %, the thresholds Nav2's saver
# writes; what lies between is neither, and counts as unknown.
OCCUPIED_FROM = 65
FREE_UP_TO = 25

MAX_CELLS = 100_000_000  # 10,000 x 10,000: 100 MB of cells, the stated bound of one map
MAX_SIDE = 65_535  # cells; 3.3 km at 0.05 m, and no side of a JPEG or GIF is longer


FINEST, COARSEST = 0.0001, 100.0  # metres per cell; what lies outside is a mistake of units
FARTHEST = 1e7  # metres from a frame's origin; UTM, in which maps of the open are kept, ends there
MOST_TURN = 1000.0  # radians; a heading that was never wrapped may have grown large


def check_size(width: int, height: int, what: str) -> None:
    """Raise TooLargeError for a grid of more than MAX_CELLS cells, or of more than MAX_SIDE on a side.

    A row costs time and memory of its own: 100 million rows of one cell took 8 s to read.
    """
    if width * height > MAX_CELLS:
        limit = f"{MAX_CELLS:,} cells"
    elif max(width, height) > MAX_SIDE:
        limit = f"{MAX_SIDE:,} cells on a side"
    else:
        return
    raise TooLargeError(
        f"{what} would be {width} x {height} cells; the limit is {limit}. "
        "Use a coarser resolution, or crop the map to what was seen"
    )


def where(mask: BoolArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """(N,) rows and (N,) columns of the cells of a mask, row by row: np.nonzero, but several times faster on
    a large one.
    """
    rows, cols = np.unravel_index(np.flatnonzero(mask), mask.shape)
    return rows, cols


@dataclass(frozen=True, eq=False)
class GridMap:
    """An occupancy grid in the frame of the robot that made it.

    cells      : (H, W) int8, row 0 at the bottom; −1 unknown, 0 free … 100 occupied, as in a ROS
                 OccupancyGrid; not writeable
    resolution : metres per cell
    origin     : T_map_grid, pose of the lower-left corner of cell (0, 0) in the map's frame
    name       : what to call it before a person
    remarks    : what a person should know of how it was read, each a clause with the cure
    files      : what it was read from: the YAML file, where there was one, and the image
    made       : when its image was last written; seconds since 1970, None where that is not known
    """

    cells: CellArray
    resolution: float
    origin: Pose2 = field(default_factory=Pose2)
    name: str = "map"
    remarks: tuple[str, ...] = ()
    files: tuple[SourceFile, ...] = ()
    made: float | None = None

    def __post_init__(self) -> None:
        if self.cells.ndim != 2 or self.cells.dtype != np.int8 or self.cells.size == 0:
            raise SettingError(
                f"{self.name}: cells must be a non-empty (H, W) int8 array, "
                f"not {self.cells.dtype} of shape {self.cells.shape}"
            )
        if not FINEST <= self.resolution <= COARSEST:
            raise SettingError(
                f"{self.name}: resolution is {self.resolution:g} m; it must be {FINEST:g} to {COARSEST:g} m"
            )
        self.cells.flags.writeable = False

    def __reduce__(self) -> tuple[type[GridMap], tuple[object, ...]]:
        """What travels to another process: what the map was made of, and nothing that was made of it."""
        return GridMap, tuple(getattr(self, each.name) for each in fields(self))

    @property
    def height(self) -> int:
        return int(self.cells.shape[0])

    @property
    def width(self) -> int:
        return int(self.cells.shape[1])

    @cached_property
    def occupied(self) -> BoolArray:
        """(H, W) bool: walls."""
        return np.asarray(self.cells >= OCCUPIED_FROM)

    @cached_property
    def free(self) -> BoolArray:
        """(H, W) bool: known to be free."""
        return np.asarray((self.cells >= FREE) & (self.cells <= FREE_UP_TO))

    @cached_property
    def points(self) -> FloatArray:
        """The dual map M^d (section II-A): (N, 2) centres of occupied cells; metres, map frame."""
        rows, cols = where(self.occupied)
        return self.centres(rows, cols)

    def centres(self, rows: NDArray[np.integer], cols: NDArray[np.integer]) -> FloatArray:
        """(N, 2) centres of the given cells; metres, map frame."""
        grid = np.stack([cols + 0.5, rows + 0.5], axis=-1) * self.resolution
        return self.origin.apply(grid)

    def grid_coordinates(self, points: FloatArray) -> FloatArray:
        """(N, 2) column and row as real numbers: the centre of cell (r, c) is (c + ½, r + ½)."""
        return np.asarray(self.origin.inverse().apply(points) / self.resolution, dtype=np.float64)

    def value_at(self, point: FloatArray) -> int:
        """The cell value under a (2,) point in metres, map frame; UNKNOWN outside the grid."""
        col, row = np.floor(self.grid_coordinates(point)).astype(int)
        inside = 0 <= row < self.height and 0 <= col < self.width
        return int(self.cells[row, col]) if inside else UNKNOWN

    def contains(self, point: FloatArray) -> bool:
        """Whether a (2,) point in metres, map frame, lies on the grid."""
        col, row = self.grid_coordinates(point)
        return bool(0 <= row < self.height and 0 <= col < self.width)

    def corners(self) -> FloatArray:
        """(4, 2) corners of the grid, counter-clockwise from its origin; metres, map frame."""
        unit = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
        return self.origin.apply(unit * (self.width, self.height) * self.resolution)

    def mirrored(self) -> GridMap:
        """The map flipped left to right: what lay at (x, y) of its frame lies at (−x, y)."""
        corner = self.origin.apply(np.array([self.width * self.resolution, 0.0]))
        origin = Pose2(-float(corner[0]), float(corner[1]), wrap_angle(-self.origin.theta))
        return replace(self, cells=np.ascontiguousarray(self.cells[:, ::-1]), origin=origin)


def remarks_on(maps: Sequence[GridMap | None]) -> tuple[str, ...]:
    """What is odd about how maps were read, in sentences that name them; None where one is not there yet."""
    return tuple(
        f"Map {number} ({grid.name}): {remark}."
        for number, grid in enumerate(maps, 1)
        if grid is not None
        for remark in grid.remarks
    )
