"""What a run is to do, for whoever runs it: a thread of this process, or a process of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

from algorithms.maps.grid_map import GridMap
from algorithms.methods import registry as methods
from algorithms.methods.stage_runner import StageCache
from algorithms.methods.steps import Step
from algorithms.observations.pair_problem import Known

Goal = Literal["merge", "candidates", "cause"]


@dataclass(frozen=True, eq=False)
class MergeJob:
    """One request: what to merge, how, how far, and how fast to tell it.

    goal  : the whole merge, or only up to the candidates (before the first merge, a moved slider
            shows what it does without jumping to the answer); or, after a refusal, its cause
    pace  : factor on the time each step stays on the screen; 0: none
    again : play steps that are known already, too
    steps : what runs in place of the method, and can be pickled; None: the method
    """

    ref: GridMap
    mov: GridMap
    known: tuple[Known, ...]
    config: Any
    method: str = methods.DEFAULT_METHOD
    seed: int = 0
    goal: Goal = "merge"
    pace: float = 0.0
    again: bool = False
    steps: Callable[[], Iterator[Step]] | None = None

    def run(self, memo: StageCache) -> Iterator[Step]:
        """Do it, up to its last step; ``memo`` knows the stages of the method's runs before."""
        if self.steps is not None:
            return self.steps()
        how = (self.method, self.ref, self.mov, self.known, self.config, self.seed)
        return methods.run(*how, memo)
