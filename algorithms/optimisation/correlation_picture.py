"""The correlation surface of one turn, small enough to be shown: over the shift of T_ref_mov."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import BoolArray, Float32Array
from algorithms.optimisation.plane_correlation import PlaneCorrelation, TurnLook

PIXELS = 128  # along the longer edge of a surface


@dataclass(frozen=True, eq=False)
class CorrelationPicture:
    """The surface of one turn over Δx to the right and Δy upwards; row 0 is the lowest Δy.

    turn    : Δθ of T_ref_mov; radians
    values  : (H, W) metres of wall that agree less metres that contradict, the best below a pixel; NaN where
              no shift is looked at
    low     : (2,) Δx, Δy of the lower left corner; metres
    pixel   : edge of a pixel; metres
    hills   : (P, 2) Δx, Δy of the highest hills, the highest first; metres
    """

    turn: float
    values: Float32Array
    low: FloatArray
    pixel: float
    hills: FloatArray

    @property
    def high(self) -> FloatArray:
        """(2,) Δx, Δy of the upper right corner; metres."""
        return self.low + self.pixel * np.array(self.values.shape[::-1])


def picture_of(plane: PlaneCorrelation, look: TurnLook, pixels: int = PIXELS) -> CorrelationPicture | None:
    """The picture of a turn that was looked at, of the shifts that are left; None where none is."""
    if look.surface is None or not look.shifts:
        return None
    shown = look.surface if look.within is None else np.where(look.within, look.surface, -np.inf)
    whole, first = plane.unwrapped(shown)
    (bottom, top), (left, right) = (_ends(np.isfinite(whole).any(axis=axis)) for axis in (1, 0))
    step = -(-max(top - bottom, right - left) // pixels)
    pooled, first = _highest(whole[bottom:top, left:right], step), first + (left, bottom)
    # shifts to metres is a turn and a scale: three corners give it
    ends = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]) * step
    start, along, up = plane.poses_at(look.turn, first - 0.5 + ends)[:, :2]
    to_metres = np.column_stack([along - start, up - start])
    corners = start + np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * pooled.shape[::-1] @ to_metres.T
    low, pixel = corners.min(axis=0), step * plane.cell
    wide, high = np.ceil((corners.max(axis=0) - low) / pixel - 1e-6).astype(int).tolist()
    x, y = np.meshgrid(low[0] + (np.arange(wide) + 0.5) * pixel, low[1] + (np.arange(high) + 0.5) * pixel)
    at = (np.stack([x, y], axis=-1) - start) @ np.linalg.inv(to_metres).T
    col, row = np.moveaxis(np.floor(at).astype(np.intp), -1, 0)
    inside = (row >= 0) & (row < pooled.shape[0]) & (col >= 0) & (col < pooled.shape[1])
    values = np.full((high, wide), -np.inf, dtype=np.float32)
    values[inside] = pooled[row[inside], col[inside]]
    # turned, a hill may lie between the pixels that were asked: each goes to the pixel that it is in
    rows, cols = np.indices(pooled.shape)
    there = start + (np.stack([cols, rows], axis=-1) + 0.5) @ to_metres.T
    col, row = np.moveaxis(((there - low) / pixel).astype(np.intp), -1, 0)
    np.maximum.at(values, (np.minimum(row, high - 1), np.minimum(col, wide - 1)), pooled)
    values[np.isneginf(values)] = np.nan
    return CorrelationPicture(look.turn, values, low, pixel, look.poses[:, :2])


def _ends(there: BoolArray) -> tuple[int, int]:
    """The first that is there, and the one after the last."""
    found = np.flatnonzero(there)
    return int(found[0]), int(found[-1]) + 1


def _highest(values: Float32Array, step: int) -> Float32Array:
    """The highest of every ``step`` rows and columns; what is missing of the last ones is −inf."""
    rows, cols = (-(-size // step) for size in values.shape)
    whole = np.full((rows * step, cols * step), -np.inf, dtype=np.float32)
    whole[: values.shape[0], : values.shape[1]] = values
    return np.asarray(whole.reshape(rows, step, cols, step).max(axis=(1, 3)))
