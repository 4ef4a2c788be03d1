"""The paper's performance index, eq. (23): how much of what both robots saw agrees."""

from __future__ import annotations

import numpy as np

from algorithms.maps.grid_map import FREE_UP_TO, OCCUPIED_FROM, UNKNOWN, BoolArray
from algorithms.maps.map_fusion import Fusion


def performance_index(estimated: Fusion, true: Fusion | None = None) -> float | None:
    """agr / N_overlap, eq. (23), 0 … 1; None where there is no overlap.

    With ``true``, the same two maps fused under the true transform, N_overlap are the cells that both
    robots have really seen, as in the paper, and agreement counts in those cells alone. Without it the
    overlap is that of the estimate: nobody knows the true one of maps of their own, and a merge in a
    wrong place can then reach a high index.
    """
    agreed, overlap = _agreed(estimated), _overlap(true or estimated)
    cells = int(np.count_nonzero(overlap))
    if true is not None:
        agreed = _laid_on(agreed, estimated, true)
    return int(np.count_nonzero(agreed & overlap)) / cells if cells else None  # eq. (23)


def _overlap(fusion: Fusion) -> BoolArray:
    return np.asarray((fusion.ref_cells != UNKNOWN) & (fusion.mov_cells != UNKNOWN))


def _agreed(fusion: Fusion) -> BoolArray:
    a, b = fusion.ref_cells, fusion.mov_cells
    walls = (a >= OCCUPIED_FROM) & (b >= OCCUPIED_FROM)
    return np.asarray(walls | (_overlap(fusion) & (a <= FREE_UP_TO) & (b <= FREE_UP_TO)))


def _laid_on(mask: BoolArray, of: Fusion, onto: Fusion) -> BoolArray:
    """A mask over one merged grid as a mask over another; both are aligned with the ref grid."""
    shift = onto.merged.grid_coordinates(of.merged.origin.xy)
    col, row = np.rint(shift).astype(int).tolist()
    out = np.zeros(onto.ref_cells.shape, dtype=np.bool_)
    height, width = of.merged.height, of.merged.width
    top, left = max(0, row), max(0, col)
    bottom, right = min(onto.merged.height, row + height), min(onto.merged.width, col + width)
    if bottom > top and right > left:
        out[top:bottom, left:right] = mask[top - row : bottom - row, left - col : right - col]
    return out
