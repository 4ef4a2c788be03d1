"""Grey to occupancy and back: the rule of Nav2's map_io, as a table of 256 entries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.errors import SettingError
from algorithms.maps.grid_map import FREE, OCCUPIED, UNKNOWN, CellArray

GreyArray = NDArray[np.uint8]

MODES = ("trinary", "scale", "raw")
ROWS_AT_ONCE = 256  # bounds what is held beside the image and the cells


@dataclass(frozen=True)
class Shading:
    """How the grey of a pixel says how occupied its cell is; the defaults are those we write.

    With shade = grey / 255 and occ = 1 − shade (negated: occ = shade):

    trinary : 100 from ``occupied_thresh`` on, 0 up to ``free_thresh``, unknown between
    scale   : the same, and between the two occ stretched to 0 … 100, rounded
    raw     : the grey itself where it is 0 … 100, otherwise unknown; nothing else counts

    A pixel that is not wholly opaque is unknown in trinary and scale.
    """

    negate: bool = False
    occupied_thresh: float = 0.65
    free_thresh: float = 0.196  # below 0.19608 of grey 205, which stands for unknown
    mode: str = "trinary"
    unknown_grey: int | None = None  # a grey that stands for unknown, whatever the thresholds say

    def __post_init__(self) -> None:
        occupied, free = self.occupied_thresh, self.free_thresh
        if self.mode not in MODES:
            raise SettingError(f"mode is {self.mode!r}; it must be one of {', '.join(MODES)}")
        if self.mode == "raw":
            return
        for name, value in (("occupied_thresh", occupied), ("free_thresh", free)):
            if not 0 <= value <= 1:
                raise SettingError(f"{name} is {value:g}; it must lie in [0, 1]")
        if not free < occupied:
            raise SettingError(
                f"free_thresh is {free:g} and occupied_thresh {occupied:g}; "
                "free_thresh must be the smaller one"
            )

    def table(self) -> CellArray:
        """(256,) int8: the cell value of each grey. In float32, as Nav2 computes it: the last bit
        decides where a grey meets a threshold.
        """
        occ = np.arange(256, dtype=np.float32) / np.float32(255)
        if not self.negate:
            occ = np.float32(1) - occ
        occupied, free = np.float32(self.occupied_thresh), np.float32(self.free_thresh)
        cells = np.full(256, UNKNOWN, dtype=np.int8)
        if self.mode == "raw":
            cells[: OCCUPIED + 1] = np.arange(OCCUPIED + 1)
        else:
            cells[occ >= occupied] = OCCUPIED
            cells[occ <= free] = FREE
        if self.mode == "scale":
            between = (occ > free) & (occ < occupied)
            spread = np.float32(self.occupied_thresh - self.free_thresh)
            percent = (occ[between] - free) / spread * np.float32(100)
            # Halves go up; in float64 the sum is exact.
            cells[between] = np.floor(percent.astype(np.float64) + 0.5).astype(np.int8)
        if self.unknown_grey is not None:
            cells[self.unknown_grey] = UNKNOWN
        return cells


def cells_of(grey: GreyArray, alpha: GreyArray | None, shading: Shading) -> CellArray:
    """The cells of an image.

    grey    : (H, W) uint8, row 0 at the top
    alpha   : (H, W) uint8, 255 is opaque; None where every pixel is
    returns : (H, W) int8, row 0 at the bottom
    """
    table = shading.table().tobytes()
    height, width = grey.shape
    cells = np.empty((height, width), dtype=np.int8)
    upward = cells[::-1]  # row 0 at the top, as in the image
    for top in range(0, height, ROWS_AT_ONCE):
        rows = slice(top, top + ROWS_AT_ONCE)
        # bytes.translate, for an index array would take eight bytes per cell.
        block = np.frombuffer(grey[rows].tobytes().translate(table), dtype=np.int8)
        upward[rows] = block.reshape(-1, width)
        if alpha is not None and shading.mode != "raw":
            upward[rows][alpha[rows] < 255] = UNKNOWN
    return cells


def greys_of(cells: CellArray) -> tuple[bytes, Shading]:
    """The pixels that stand for cells, and the shading under which they read back the same.

    cells   : (H, W) int8, row 0 at the bottom
    returns : H·W bytes, row 0 at the top. Trinary (black 0, white 254, grey 205, as Nav2 saves)
              where that says all, otherwise raw.
    """
    pixels = cells[::-1].tobytes()  # as unsigned bytes: unknown is 255
    if pixels.translate(None, delete=bytes([UNKNOWN % 256, FREE, OCCUPIED])):
        return pixels, Shading(mode="raw")
    grey = bytearray(256)
    grey[UNKNOWN % 256], grey[FREE], grey[OCCUPIED] = 205, 254, 0
    return pixels.translate(grey), Shading()
