"""The proof over the plane: is there any place at which more wall agrees than at the best that was climbed?

Blocks of transforms whose bound is not above the value of that place are left out, sector by sector of the
circle; what is left, some thousand blocks of some ten million, branch and bound looks into.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from algorithms.common.parallel_kernels import each_on_a_core
from algorithms.common.pose import FloatArray, Pose2, pose_error, wrap_angles
from algorithms.methods.merge_result import Answer
from algorithms.methods.steps import AnswersDetail, ProofDetail
from algorithms.optimisation.branch_and_bound import NODES, ProofConfig, ProofState, prove
from algorithms.optimisation.objective import Lookup
from algorithms.optimisation.open_blocks import Roots
from algorithms.optimisation.plane_bounds import PlaneBlocks, PlaneBounds
from algorithms.optimisation.transform_lattice import IntArray
from algorithms.optimisation.upper_bounds import UpperBounds
from algorithms.verdict.whole_maps import WholeMaps

TOGETHER = 16  # sectors between two steps
MOST_BLOCKS = 2_000_000_000  # of a plane: about a minute on two cores; maps of 1,000 × 1,000 cells have fewer
PATIENCE = ProofConfig().patience
HAIR = 1e-6  # metres of wall; the best that was climbed is itself to be found again

Sector = tuple[IntArray, FloatArray, float]


def prove_plane(whole: WholeMaps, climbed: AnswersDetail) -> Iterator[ProofDetail]:
    """The best of the lattice over all that the window leaves of the plane; the state after every few sectors
    of turns, then those of branch and bound, the last one ``stopped``. It counts blocks, not seconds, so it
    ends alike on any machine.
    """
    objective, window = replace(whole.crisp, lookup=Lookup.NEAREST), whole.window
    values = UpperBounds(objective, window)
    blocks = PlaneBlocks(values.lattice)
    tops = [Pose2.from_array(pose) for pose in climbed.tops]
    beside = np.concatenate([values.lattice.nearest(top) for top in tops])
    found = values(beside, 0)
    best, best_value = beside[[found.argmax()]], float(found.max())
    sought = max(0.0, best_value - HAIR)
    known = values.lattice.poses(values.lattice.coordinates(best, 0))[0], best_value
    most = sum(float(side.weights.sum()) for side in objective.sides)
    so_far = _Bounded(blocks, most, sought, *known)
    if blocks.count > MOST_BLOCKS:
        many = f"{blocks.count:,} blocks are more than {MOST_BLOCKS:,}"
        yield ProofDetail(so_far.state(many), window)
        return
    bounds = PlaneBounds(objective, blocks)
    for start in range(0, len(blocks.left), TOGETHER):
        turns = blocks.left[start : start + TOGETHER]
        so_far.add(turns, each_on_a_core(lambda turn: bounds.above(turn, sought), turns))
        if so_far.left > PATIENCE * NODES:
            many = f"{so_far.left:,} blocks or more may hold a better place"
            yield ProofDetail(so_far.state(many), window)
            return
        yield ProofDetail(so_far.state(None), window)
    # floor 1: other places than the best are not looked for
    for state in prove(objective, window, ProofConfig(patience=PATIENCE), 1.0, sought, so_far.roots()):
        if state.best is None:  # nothing as good has been met again so far
            state = replace(state, best=known[0], best_value=best_value)
        yield ProofDetail(state, window)


class _Bounded:
    """The sectors that have been bounded.

    most             : what all walls together can be worth
    sought           : what a block must be above
    best, best_value : (3,) x, y, theta of the best that was climbed, on the lattice, and its value
    left             : blocks that may hold something better than what is sought
    """

    def __init__(
        self, blocks: PlaneBlocks, most: float, sought: float, best: FloatArray, best_value: float
    ) -> None:
        self._blocks, self._lattice, self._sought = blocks, blocks.lattice, sought
        self._best, self._best_value = best, best_value
        self._nodes: list[IntArray] = []
        self._tops: list[FloatArray] = []
        self._known = np.full(self._lattice.turns >> self._lattice.levels, -np.inf)
        self._tops_of = np.full(blocks.turns, -np.inf)
        self._tops_of[blocks.left] = most
        self._looked_at = 0
        self.left = 0

    def add(self, turns: Sequence[int], sectors: Sequence[Sector]) -> None:
        for turn, (nodes, tops, rest) in zip(turns, sectors, strict=True):
            self._nodes.append(nodes)
            self._tops.append(tops)
            self._looked_at += self._blocks.side**2
            self.left += len(nodes)
            at = turn >> (self._lattice.levels - self._blocks.level)
            self._known[at] = max(self._known[at], rest)
            self._tops_of[turn] = max(rest, float(tops.max(initial=-np.inf)))

    def roots(self) -> Roots:
        nodes = np.concatenate([np.zeros((0, 3), dtype=np.int64), *self._nodes])
        bounds = np.concatenate([np.zeros(0), *self._tops])
        return Roots(self._blocks.level, nodes, bounds, self._known, self._looked_at)

    def state(self, stopped: str | None) -> ProofState:
        """Before branch and bound has begun."""
        sectors = len(self._known)
        ceilings = self._tops_of.reshape(sectors, -1).max(axis=1)
        middles = (np.arange(sectors) + 0.5) * 2**self._lattice.levels * self._lattice.step
        return ProofState(
            rival_sought=False,
            nodes=self._looked_at,
            best=self._best,
            best_value=self._best_value,
            ceiling=float(ceilings.max()),
            rivals=np.zeros((0, 3)),
            rival_values=np.zeros(0),
            floor=self._sought,
            turns=wrap_angles(middles),
            ceilings=ceilings,
            found=np.full(sectors, -np.inf),
            stopped=stopped,
            proven=False,
        )


def with_proven(
    whole: WholeMaps, climbed: AnswersDetail, state: ProofState, distance: float, angle: float
) -> tuple[AnswersDetail, bool]:
    """The answers, with the proven best among them, and whether the search had come to it.

    distance, angle : metres and radians, from which on two transforms are two answers
    """
    if state.best is None:
        return climbed, False
    best = Pose2.from_array(state.best)
    for top in climbed.tops:
        metres, turn = pose_error(Pose2.from_array(top), best, whole.window.pivot)
        if metres <= distance and turn <= angle:
            return climbed, True
    top = Pose2.from_array(whole.climb_all(state.best[None])[0])
    found = Answer(top, whole.crisp.value_at(top), "the proof found it")
    return replace(climbed, answers=(*climbed.answers, found)), False
