"""How an image's greys are read, and what a person should know about that.

A saver's default, a picture editor or a wrong mode can turn all that is unknown into free floor, or all that
is wall into nothing; a merge of such maps is refused, and nobody sees why. So each map is asked, when it is
read, whether it makes sense.
"""

from __future__ import annotations

from dataclasses import replace
from math import floor

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.files.images.thresholds import GreyArray, Shading
from algorithms.maps.grid_map import FREE, FREE_UP_TO, OCCUPIED_FROM, BoolArray, CellArray

Counts = NDArray[np.int64]

SAVER = (0, 205, 254)  # greys of map_server's and Nav2's savers: wall, unknown, free
SAVER_UNKNOWN = 205
SAVER_FREE_THRESH = 0.196  # just below the 0.19608 of grey 205
SPIKE = 0.03  # share of the cells from which on a grey stands for something
FEW_GREYS = 0.98  # share of the floor that spikes must hold for it to be made of a few greys
NEARLY_ONE = 0.04  # occupied; greys nearer than that are one floor with a little noise
MIDDLE = 0.006  # how near to half occupied greys 127 and 128 lie
MOST_WALL = 0.5  # share of the cells that no map of a building has
OPEN_EDGE = 0.25  # share of the image's edge that is free where a map runs on into what nobody has seen
NOTHING = 0.001  # share of the cells below which there is none of a kind


def count_greys(grey: GreyArray, alpha: GreyArray | None) -> Counts:
    """(256,) pixels of each grey that are wholly opaque."""
    opaque = None if alpha is None else (alpha == 255).astype(np.uint8)
    counts = cv2.calcHist([grey], [0], opaque, [256], [0, 256])
    return np.rint(counts.ravel()).astype(np.int64)


def corrected(shading: Shading, counts: Counts) -> tuple[Shading, str]:
    """The shading that an image was made for, and a remark where that is not the one given.

    Only what is unmistakable is put right: the savers' own three greys, under a free_thresh by which their
    unknown would be free, or in mode raw, of which they are no per cent.
    """
    greys = set(np.flatnonzero(counts).tolist())
    if shading.negate or SAVER_UNKNOWN not in greys or not greys <= set(SAVER) or len(greys) == 1:
        return shading, ""
    if shading.mode == "raw":
        return Shading(unknown_grey=shading.unknown_grey), (
            "mode raw takes a grey for per cent, and all above 100 for unknown, by which no cell would be a "
            f"wall; but its greys are {_and(sorted(greys))}, those of mode trinary: read as trinary. Set "
            "mode: trinary to say so"
        )
    if shading.table()[SAVER_UNKNOWN] != FREE:
        return shading, ""
    return replace(shading, free_thresh=SAVER_FREE_THRESH), (
        f"grey 205, {_share(counts, [SAVER_UNKNOWN])} of its cells, would be free floor by free_thresh: "
        f"{shading.free_thresh:g}, but beside {_and(sorted(greys - {SAVER_UNKNOWN}))} it is the saver's "
        f"unknown: read as unknown. Set free_thresh: {SAVER_FREE_THRESH:g} to say so"
    )


def remarks(shading: Shading, counts: Counts, cells: CellArray) -> tuple[str, ...]:
    """What is odd about a map as it was read, each as a clause with the cure; () where nothing is.

    counts : of ``count_greys``
    cells  : (H, W) int8, row 0 at the bottom
    """
    table, total = shading.table(), max(1, int(counts.sum()))
    wall, free = table >= OCCUPIED_FROM, (table >= FREE) & (table <= FREE_UP_TO)
    walls, floors = int(counts[wall].sum()), int(counts[free].sum())
    greys = set(np.flatnonzero(counts).tolist())
    if walls == 0 and floors == 0 and len(greys) <= 1:
        return (
            f"no cell of it is known: all {cells.size:,} are unknown, so there is nothing to merge yet. Save "
            "the map once its robot has driven",
        )
    if walls == 0 or floors == 0:
        kind = "free floor" if walls else "a wall" if floors else "a wall or free floor"
        if (walls or floors) and shading.mode != "raw" and greys <= set(SAVER):
            return (f"no cell of it is {kind} yet. Let its robot drive on, and save the map again",)
        return (f"no cell of it is {kind}, {_greys(counts, shading.negate)}: {_cure(shading, counts)}",)
    if walls > MOST_WALL * cells.size:
        flag = "take negate: 1 away" if shading.negate else "set negate: 1, if white is wall in it"
        return (f"more than half of it, {walls / cells.size:.0%} of its cells, is wall: {flag}",)
    said = _third_grey(shading, counts, free)
    if said:
        return (said,)
    unknown = cells.size - walls - floors
    edge = np.concatenate([cells[0], cells[-1], cells[:, 0], cells[:, -1]])
    edge_free = float(np.mean((edge >= FREE) & (edge <= FREE_UP_TO)))
    if unknown < NOTHING * cells.size and edge_free > OPEN_EDGE:
        return (
            f"none of its cells is unknown: {floors / total:.0%} are free floor, also where no robot ever "
            "was, so that free floor says nothing. Save it with unknown cells (grey 205 in mode trinary)",
        )
    return ()


def _third_grey(shading: Shading, counts: Counts, free: BoolArray) -> str:
    """A remark on a grey that is read as free beside a lighter one that is floor; the image has few greys."""
    spikes = np.flatnonzero(free & (counts >= SPIKE * counts.sum()))
    if shading.mode == "raw" or len(spikes) < 2 or counts[spikes].sum() < FEW_GREYS * counts[free].sum():
        return ""
    occupied = _occupied(np.arange(256), shading.negate)
    floors = sorted(spikes.tolist(), key=lambda grey: float(occupied[grey]))
    grey = floors[-1]
    if occupied[grey] - occupied[floors[0]] < NEARLY_ONE:
        return ""
    threshold = floor(occupied[grey] * 100 - 1e-6) / 100
    return (
        f"a third grey, {grey}, holds {_share(counts, [grey])} of its cells and is read as free floor. If it "
        f"stands for unknown, set free_thresh: {threshold:g}, or give --unknown-grey {grey}"
    )


def _greys(counts: Counts, negate: bool) -> str:
    """Which greys an image has: "its greys being 0, 205 and 254"."""
    greys = np.flatnonzero(counts).tolist()
    if len(greys) == 1:
        return f"its one grey being {greys[0]}"
    if len(greys) <= 6:
        return f"its greys being {_and(greys)}"
    parts = (f"{100 * low:.0f}–{100 * high:.0f} %" for low, high in _parts(counts, negate))
    return f"its greys lying at {' and '.join(parts)} occupied"


def _and(greys: list[int]) -> str:
    """ "0, 205 and 254"; of one, that one."""
    return " and ".join(filter(None, (", ".join(map(str, greys[:-1])), str(greys[-1]))))


def _parts(counts: Counts, negate: bool) -> list[tuple[float, float]]:
    """The greys as how occupied they are, 0 … 1, the freer part first: cut in two at the widest gap. A grey
    right in the middle that many cells have stands for unknown, and is left out.
    """
    shares = np.sort(_occupied(np.flatnonzero(counts), negate))
    known = shares[np.abs(shares - 0.5) > MIDDLE] if _middle_is_unknown(counts) else shares
    shares = known if len(known) > 1 else shares
    cut = int(np.diff(shares).argmax()) + 1
    return [(float(shares[0]), float(shares[cut - 1])), (float(shares[cut]), float(shares[-1]))]


def _occupied(greys: NDArray[np.int64], negate: bool) -> FloatArray:
    return np.asarray(greys / 255 if negate else 1 - greys / 255, dtype=np.float64)


def _middle_is_unknown(counts: Counts) -> bool:
    middle = np.abs(_occupied(np.arange(256), False) - 0.5) <= MIDDLE
    return bool(counts[middle].sum() >= SPIKE * counts.sum())


def _cure(shading: Shading, counts: Counts) -> str:
    """What would make walls and floor of an image whose greys miss the thresholds."""
    greys = np.flatnonzero(counts)
    if shading.mode == "raw" and greys.max() > 100:
        return (
            "mode raw takes a grey for per cent, and all above 100 for unknown. Set mode: trinary, "
            "occupied_thresh: 0.65 and free_thresh: 0.196"
        )
    if shading.mode == "raw":
        return (
            f"in mode raw a wall is {OCCUPIED_FROM} or more, and floor {FREE_UP_TO} or less. Write walls as "
            "100, floor as 0 and unknown as 255"
        )
    if len(greys) == 1:
        return "is it the image of this map?"
    (_, floor_to), (wall_from, _) = _parts(counts, shading.negate)
    below = 0.5 + MIDDLE if floor_to < 0.5 < wall_from and _middle_is_unknown(counts) else floor_to
    between = "they lie between the thresholds"
    if shading.mode != "trinary":
        between = (
            f"in mode {shading.mode} a wall is {OCCUPIED_FROM} % or more of the way between the thresholds"
        )
    mode = "" if shading.mode == "trinary" else ", and mode: trinary"
    return (
        f"{between}, free_thresh: {shading.free_thresh:g} and occupied_thresh: {shading.occupied_thresh:g}. "
        f"Set occupied_thresh: {(below + wall_from) / 2:.2f} and free_thresh: {floor_to + 0.01:.2f}{mode}"
    )


def _share(counts: Counts, greys: list[int]) -> str:
    return f"{counts[greys].sum() / counts.sum():.0%}"
