"""The blocks of transforms that branch and bound has not opened yet, and which of them it opens next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.maps.grid_map import BoolArray
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.transform_lattice import IntArray
from algorithms.optimisation.upper_bounds import UpperBounds

BATCH = 256  # blocks opened between two looks at the best value, at least


@dataclass
class OpenBlocks:
    """Blocks of one level that are not opened yet, with their bounds."""

    bounds: FloatArray
    nodes: IntArray

    @staticmethod
    def empty() -> OpenBlocks:
        return OpenBlocks(np.zeros(0), np.zeros((0, 3), dtype=np.int64))

    @property
    def top(self) -> float:
        return float(self.bounds.max(initial=-np.inf))

    def add(self, bounds: FloatArray, nodes: IntArray) -> None:
        self.bounds = np.concatenate([self.bounds, bounds])
        self.nodes = np.concatenate([self.nodes, nodes])

    def take(self, most: int) -> tuple[FloatArray, IntArray]:
        """The blocks with the highest bounds, taken out."""
        order = np.arange(len(self.bounds))
        if len(order) > most:
            order = np.argpartition(-self.bounds, most - 1)
        taken, left = order[:most], order[most:]
        out = self.bounds[taken], self.nodes[taken]
        self.bounds, self.nodes = self.bounds[left], self.nodes[left]
        return out

    def drop(self, value: float) -> tuple[FloatArray, IntArray]:
        """Keep the blocks above a value; return the others."""
        keep = self.bounds > value
        out = self.bounds[~keep], self.nodes[~keep]
        self.keep(keep)
        return out

    def keep(self, which: BoolArray) -> None:
        self.bounds, self.nodes = self.bounds[which], self.nodes[which]

    def best(self, above: float = -np.inf) -> tuple[float, IntArray | None]:
        """The highest value and whose it is; None where none is above."""
        if not len(self.bounds) or self.bounds.max() <= above:
            return -np.inf, None
        # of equal values the first block's, so that the answer does not hang on the order of opening
        equal = np.flatnonzero(self.bounds == self.bounds.max())
        first = equal[np.lexsort(self.nodes[equal].T[::-1])[0]]
        return float(self.bounds[first]), self.nodes[first]


@dataclass(frozen=True, eq=False)
class Roots:
    """Blocks to begin with, where others have been left out already.

    level  : of the blocks
    nodes, bounds : (P, 3), (P,) the blocks and their bounds
    known  : (A,) of every sector of the circle, a bound of what was left out
    blocks : how many have been bounded for it
    """

    level: int
    nodes: IntArray
    bounds: FloatArray
    known: FloatArray
    blocks: int


class BlockSearch:
    """The open blocks and what has been found; one of them for both passes.

    nodes   : blocks bounded
    bounded : the same, with those that were bounded before it began
    """

    def __init__(self, objective: Objective, window: CoupledWindow, roots: Roots | None = None) -> None:
        self.upper_bounds = UpperBounds(objective, window)
        self.lattice = self.upper_bounds.lattice
        self.levels = self.lattice.levels
        self.open = [OpenBlocks.empty() for _ in range(self.levels + 1)]
        self.shut = [OpenBlocks.empty() for _ in range(self.levels + 1)]  # no better than what was sought
        self.single = OpenBlocks.empty()  # transforms looked at, with their values
        self.sectors = self.lattice.turns >> self.levels
        self.found = np.full(self.sectors, -np.inf)
        self.known = np.full(self.sectors, -np.inf)  # bound of the blocks that were left out
        self.nodes, self._before = 0, 0
        if roots is None:
            self._add(self.lattice.roots(), self.levels, np.inf)
        else:
            self.known, self._before = roots.known.copy(), roots.blocks
            self._add(roots.nodes, roots.level, roots.bounds)

    @property
    def bounded(self) -> int:
        return self._before + self.nodes

    @property
    def top(self) -> float:
        """Bound of what is open."""
        return max(front.top for front in self.open)

    @property
    def empty(self) -> bool:
        """Whether nothing has been found in the window, and nothing is left to look at."""
        return not any(len(front.bounds) for front in (*self.open, *self.shut, self.single))

    def sector(self, nodes: IntArray, level: int) -> IntArray:
        """(P,) which sector of the circle blocks lie in."""
        return np.asarray(nodes[:, 0] >> (self.levels - level), dtype=np.int64)

    def ceilings(self) -> FloatArray:
        """(A,) bound of each sector, over all that is not taken apart."""
        out = np.maximum(self.found, self.known)
        for fronts in (self.open, self.shut):
            for level, front in enumerate(fronts):
                np.maximum.at(out, self.sector(front.nodes, level), front.bounds)
        return out

    def _add(self, nodes: IntArray, level: int, at_most: FloatArray | float) -> None:
        """Bound blocks, and keep them open; at_most: the bounds of the blocks they are in."""
        values = self.upper_bounds(nodes, level)
        possible = values > -np.inf
        values, nodes = np.minimum(values, at_most)[possible], nodes[possible]
        self.nodes += len(nodes)
        if level:
            self.open[level].add(values, nodes)
        else:
            np.maximum.at(self.found, self.sector(nodes, 0), values)
            self.single.add(values, nodes)

    def open_best(self, sought: float, wanted: BlockFilter | None = None) -> bool:
        """Open the blocks with the highest bounds; False where no bound is above ``sought``.

        wanted : which blocks to go into; the others are left out
        """
        level = int(np.argmax([front.top for front in self.open]))
        front = self.open[level]
        if front.top <= sought:
            return False
        self.shut[level].add(*front.drop(sought))
        bounds, nodes = front.take(max(BATCH, len(front.bounds) // 8))
        children, at_most = self.lattice.children(nodes), np.repeat(bounds, 8)
        if wanted is not None:
            keep = wanted(children, level - 1)
            np.maximum.at(self.known, self.sector(children[~keep], level - 1), at_most[~keep])
            children, at_most = children[keep], at_most[keep]
        if level == 1:  # a value is no bound: rounding must not cut it
            at_most = np.full(len(children), np.inf)
        self._add(children, level - 1, at_most)
        return True

    def open_again(self) -> None:
        """What was shut may hold a rival."""
        for open_, shut in zip(self.open, self.shut, strict=True):
            open_.add(shut.bounds, shut.nodes)
        self.shut = [OpenBlocks.empty() for _ in range(self.levels + 1)]


BlockFilter = Callable[[IntArray, int], BoolArray]
