"""What the lesson looks at: every step of one run on the loaded pair, and what follows from them."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any, Literal, TypeVar

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.common.robot_names import UNNAMED
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.spectra_config import PipelineConfig
from algorithms.methods.spectra_stages import objective_of, values_in
from algorithms.methods.steps import AugmentDetail, CandidatesDetail, RefineDetail, Step
from algorithms.observations.pair_problem import PairProblem
from algorithms.optimisation.monte_carlo import monte_carlo
from algorithms.optimisation.objective import Objective
from algorithms.optimisation.optimiser import SearchState
from algorithms.optimisation.particle_swarm import settled_within, swarm
from algorithms.optimisation.search_box import SearchBox, box_around
from algorithms.spectra.hough_spectra import hough_transform
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.status_text import typeset
from app.page.lesson.side_runs import SideRun, SideRuns
from app.page.lesson.sighting_look import SIGHTING, SightingLook
from app.report.result_rows import numbers, sighting_rows

D = TypeVar("D")

FEW = 14  # particles: so many can be followed by eye
DRAWS = 60  # batches of the Monte-Carlo search that are looked at


def keep(steps: list[Step], step: Step) -> None:
    """Add a step of a run; of the search on one candidate the newest alone: a long one fills the memory."""
    last, new = steps[-1].detail if steps else None, step.detail
    if isinstance(last, RefineDetail) and isinstance(new, RefineDetail) and last.index == new.index:
        steps.pop()
    steps.append(step)


class LessonRun:
    """One run, as far as it has come; all that is drawn from it is worked out once, when asked for."""

    def __init__(
        self,
        inputs: MergeInputs,
        config: Any,
        seed: int = 0,
        steps: tuple[Step, ...] = (),
        sides: dict[str, SideRuns] | None = None,
    ) -> None:
        """``sides``: by the names of pictures, merges that a step compares, once a student has come to it."""
        self.inputs, self.config, self.seed, self.steps = inputs, config, seed, steps
        self.sides = {} if sides is None else sides

    @property
    def possible(self) -> bool:
        """Whether there are maps, a sighting, and a method that goes through all the stages."""
        return self.inputs.sighted and isinstance(self.config, PipelineConfig)

    def all(self, kind: type[D]) -> list[D]:
        """Every detail of a kind."""
        return [step.detail for step in self.steps if isinstance(step.detail, kind)]

    def get(self, kind: type[D]) -> D:
        """The newest detail of a kind, which must be there: see ``reached``."""
        return self.all(kind)[-1]

    def reached(self, *kinds: type) -> bool:
        """Whether the run has come to all of these; a look at a picture comes beside it."""
        there = {type(step.detail) for step in self.steps}
        return (there | ({SightingLook} if self.look else set())).issuperset(kinds)

    def run_until(self, kind: type, index: int = -1) -> RunState:
        """The run up to a step of a kind, as the page draws it; empty where it has not come to it."""
        found = [k for k, step in enumerate(self.steps) if isinstance(step.detail, kind)]
        run = RunState(self.config)
        for step in self.steps[: found[index] + 1] if found else ():
            run.add(step)
        return run

    def compared(self, job: MergeJob) -> SideRun | None:
        """Of the merges that a step compares the one that a job belongs to."""
        return next((one for runs in self.sides.values() if (one := runs.of(job)) is not None), None)

    @property
    def look(self) -> SightingLook | None:
        """What camera and laser saw; None before a student has asked for it."""
        runs = self.sides.get(SIGHTING)
        run = runs.each[0].run if runs is not None else None
        return None if run is None else run.get(SightingLook)

    # --- worked out once --------------------------------------------------------------------------

    @cached_property
    def rows(self) -> dict[str, str]:
        """The page's numbers of the sighting, and of the result where there is one, by their labels."""
        i = replace(self.inputs, names=UNNAMED)
        told = sighting_rows(i.observations[0], i.encounters[0])
        if self.reached(MergeResult):
            told += [(label, value) for label, value, *_ in numbers(self.get(MergeResult), i, self.config)]
        return {label: typeset(value) for label, value, *_ in told}

    @cached_property
    def votes(self) -> tuple[FloatArray, FloatArray, float]:
        """M_H of both maps, (K, R) each as eq. (11) sums it, and the width of a bin of ρ in metres."""
        lifted, directions = self.get(AugmentDetail), self.config.spectra.directions
        step = max(lifted.ref.grid.resolution, lifted.mov.grid.resolution)
        first, second = (hough_transform(part, directions, step) for part in (lifted.ref, lifted.mov))
        return first, second, step

    @cached_property
    def gamma(self) -> Objective:
        """Γ of eq. (17), whatever the run maximises."""
        return self._objective("gamma")

    @cached_property
    def agreement(self) -> Objective:
        """The agreement, whatever the run maximises."""
        return self._objective("agreement")

    def _objective(self, name: Literal["gamma", "agreement"]) -> Objective:
        i, config = self.inputs, replace(self.config, refine=replace(self.config.refine, objective=name))
        assert i.ref is not None
        assert i.mov is not None
        return objective_of(PairProblem.of(i.ref, i.mov, i.known), self.get(AugmentDetail), config)

    @cached_property
    def box(self) -> SearchBox:
        """The optimiser's box around the best candidate."""
        found = self.get(CandidatesDetail)
        return box_around(found.candidates[0].T_ref_mov, found.window, self.config.box)

    def _values(self, poses: FloatArray) -> FloatArray:
        found = self.get(CandidatesDetail)
        return values_in(found.objective, found.window, self.box, poses)

    @cached_property
    def samples(self) -> list[SearchState]:
        """The Monte-Carlo search in the best candidate's box, batch by batch."""
        config = replace(self.config.swarm, iterations=min(DRAWS, self.config.swarm.iterations))
        rng = np.random.default_rng([self.seed, 2])
        return list(monte_carlo(self._values, self.box, config, np.zeros(3), rng))

    @cached_property
    def few(self) -> list[SearchState]:
        """A swarm of a few particles in the best candidate's box, with what pulls at each of them."""
        config = replace(self.config.swarm, particles=FEW)
        settled = settled_within(self.get(CandidatesDetail).objective.cell)
        rng = np.random.default_rng([self.seed, 3])
        return list(swarm(self._values, self.box, config, settled, rng))
