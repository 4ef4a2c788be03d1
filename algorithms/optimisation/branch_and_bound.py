"""The certificate: branch and bound over the whole circle, as in Hess et al. (ICRA 2016).

Blocks of transforms whose bound is not above the best value found are never opened; when none is left,
that value is proven to be the best of the lattice in the coupled window. A second pass looks for the best
transform elsewhere: the rival.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi, sqrt
from typing import Annotated

import numpy as np

from algorithms.common.pose import FloatArray, wrap_angles
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.grid_map import BoolArray
from algorithms.observations.search_window import CoupledWindow
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.open_blocks import BlockSearch, Roots
from algorithms.optimisation.transform_lattice import IntArray

NODES = 100_000  # in one unit of patience
MOST_RIVALS = 5


@dataclass(frozen=True)
class ProofConfig(CheckedConfig):
    """Settings of the certificate."""

    whole_circle: bool = False
    """Search the whole circle in the coupled window, with proof; the best of it is then the answer."""
    angle: Annotated[float, Bounds(1, 90, 1, "°", "", "rival's turn")] = 10.0
    """Two transforms are two answers where they turn by more than this apart, or"""
    distance: Annotated[float, Bounds(0.1, 5, 0.1, "m", "", "rival's shift")] = 0.7
    """put the seen robot at places farther apart than this."""
    patience: Annotated[int, Bounds(1, 1000, 1, "10⁵ nodes", "", "patience")] = 30
    """The search stops unproven after so many nodes, with the gap that is left."""


@dataclass(frozen=True, eq=False)
class ProofState:
    """How far the proof has come; its arrays are copies.

    rival_sought     : False while the best is proven, True in the passes after it
    nodes            : blocks bounded so far, single transforms among them
    best, best_value : (3,) x, y, theta of T_ref_mov, and its value; None before the first
    ceiling          : no transform of the lattice is better than this; once proven, none elsewhere
    rivals, rival_values : (R, 3), (R,) the best transforms elsewhere, best first, each another answer
                       than those before it; the last one may not be final before ``stopped``
    floor            : neither bests nor rivals below this value are looked for
    turns            : (A,) middles of the sectors of the circle; radians
    ceilings, found  : (A,) bound of each sector, and the best value met in it (−inf: none looked at)
    stopped          : why the search ended; None while it goes on
    proven           : whether ``best`` is the best of the lattice
    empty            : whether the window is known to hold no transform at all: the sightings contradict
                       each other
    """

    rival_sought: bool
    nodes: int
    best: FloatArray | None
    best_value: float
    ceiling: float
    rivals: FloatArray
    rival_values: FloatArray
    floor: float
    turns: FloatArray
    ceilings: FloatArray
    found: FloatArray
    stopped: str | None
    proven: bool
    empty: bool = False

    @property
    def rival(self) -> FloatArray | None:
        """(3,) the best rival; None where there is none above ``floor``."""
        return np.asarray(self.rivals[0], dtype=np.float64) if len(self.rivals) else None

    @property
    def rival_value(self) -> float:
        """Its value; −inf without one."""
        return float(self.rival_values[0]) if len(self.rivals) else -np.inf

    @property
    def gap(self) -> float:
        """How much better than the best found something could still be; 0 once it is proven."""
        return 0.0 if self.proven else max(0.0, self.ceiling - self.best_value)


def prove(
    objective: Objective,
    window: CoupledWindow,
    config: ProofConfig,
    floor: float = 0.0,
    worth: float = -np.inf,
    roots: Roots | None = None,
) -> Iterator[ProofState]:
    """Search the whole circle; yield the state every few hundred blocks, the last one ``stopped``.

    The caller may leave at any time. Values are those of ``objective`` at look-up NEAREST.

    floor : share of the best value below which a rival is of no interest
    worth : value up to which the best is of no interest either; where none is above it, that is proven
            and no ``best`` is given
    roots : blocks to begin with, all others being known to hold nothing better than ``worth``
    """
    search = BlockSearch(objective, window, roots)
    lattice = search.lattice
    patience = config.patience * NODES
    answers: list[IntArray] = []  # the best, then its rivals
    values: list[float] = []
    leading: tuple[float, IntArray | None] = search.single.best(worth)
    least = worth
    proven = False

    def state(stopped: str | None) -> ProofState:
        nodes, sums = [*answers], [*values]
        if leading[1] is not None:
            nodes, sums = [*nodes, leading[1]], [*sums, leading[0]]
        poses = lattice.poses(lattice.coordinates(np.array(nodes).reshape(-1, 3), 0))
        return ProofState(
            rival_sought=proven,
            nodes=search.bounded,
            best=poses[0] if len(poses) else None,
            best_value=sums[0] if sums else -np.inf,
            ceiling=max(search.top, search.single.top, least),
            rivals=poses[1:],
            rival_values=np.array(sums[1:]),
            floor=least,
            turns=wrap_angles((np.arange(search.sectors) + 0.5) * 2**search.levels * lattice.step),
            ceilings=search.ceilings(),
            found=search.found.copy(),
            stopped=stopped,
            proven=proven,
            empty=search.empty,
        )

    def elsewhere(nodes: IntArray, level: int) -> BoolArray:
        """Whether a block holds a transform that is another answer than those found."""
        out = np.ones(len(nodes), dtype=np.bool_)
        at = lattice.coordinates(nodes, level)
        for answer in lattice.coordinates(np.array(answers), 0):
            off = at - answer
            apart = np.hypot(off[:, 0], off[:, 1]) + lattice.half(level) * sqrt(2)
            turned = np.abs(wrap_angles(off[:, 2])) + lattice.half_turn(level)
            out &= (apart > config.distance) | (turned > config.angle * pi / 180)
        return out

    while len(answers) <= MOST_RIVALS:
        while search.open_best(max(leading[0], least), elsewhere if answers else None):
            leading = search.single.best(least)
            if search.nodes > patience:
                yield state(
                    f"{'proven; rivals ' if proven else ''}not all searched: {search.bounded:,} blocks"
                )
                return
            yield state(None)
        if leading[1] is None:
            break
        answers.append(leading[1])
        values.append(leading[0])
        if not proven and leading[0] <= 0:
            break
        least = max(least, floor * leading[0])
        search.single.keep(elsewhere(search.single.nodes, 0))
        search.open_again()
        proven, leading = True, search.single.best(least)
    if answers:
        end = f"proven: {search.bounded:,} blocks bounded" if proven else "proven, but nothing speaks for it"
        proven, leading = True, (-np.inf, None)
        yield state(end)
    elif search.empty:
        yield state("the window holds no transform of the lattice")
    else:
        yield state(f"no transform has a value above {worth:g}")
