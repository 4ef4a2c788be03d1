"""Merges beside the lesson's own, which a step compares: what is known makes the difference, or the pair."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, PLANE_METHOD
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import SPREADS_IN_RADIUS, NearPlace
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.status_text import progress

VAGUE = 1.0  # metres; standard deviation of where the robots met, and how far off it is given


@dataclass(eq=False)
class SideRun:
    """One of the merges, as far as it has come.

    title      : what is known, in a few words
    job        : what is to be done
    place      : (2,) where the robots met, as far as it is known; metres, ref frame. None: not at all
    covariance : (2, 2) of it; m²
    run        : None before it has begun
    failed     : why there is no answer, as a sentence; empty where there may be one
    ends       : what it tells at its end
    """

    title: str
    job: MergeJob
    place: FloatArray | None = None
    covariance: FloatArray | None = None
    run: RunState | None = None
    failed: str = ""
    ends: type = MergeResult

    @property
    def result(self) -> MergeResult | None:
        return None if self.run is None else self.run.get(MergeResult)

    @property
    def over(self) -> bool:
        return bool(self.failed) or (self.run is not None and self.run.reached(self.ends))


class SideRuns:
    """The merges of one step, in the order in which they are run."""

    def __init__(self, *each: SideRun) -> None:
        self.each = each

    @property
    def at_work(self) -> SideRun | None:
        """The one that has begun and is not over."""
        return next((one for one in self.each if one.run is not None and not one.over), None)

    @property
    def next(self) -> SideRun | None:
        """The first that is not over."""
        return next((one for one in self.each if not one.over), None)

    @property
    def done(self) -> float | None:
        """Share of all the work that is done; None where none of it is at hand."""
        at_work = self.at_work
        if at_work is None or at_work.run is None:
            return None
        return (sum(one.over for one in self.each) + progress(at_work.run)) / len(self.each)

    def of(self, job: MergeJob) -> SideRun | None:
        """The one that a job belongs to."""
        return next((one for one in self.each if one.job is job), None)


def knowledge_runs(inputs: MergeInputs, seed: int = 0) -> SideRuns:
    """The merges over the plane of a pair that was seen at least once, those first that know least."""
    assert inputs.ref is not None
    assert inputs.mov is not None
    ref, mov, at = inputs.ref, inputs.mov, inputs.encounters[0]
    about = at.x_ref + VAGUE * np.sqrt(0.5)
    near = NearPlace(*about.tolist(), *at.x_mov.tolist(), SPREADS_IN_RADIUS * VAGUE)

    def job(*known: Known) -> MergeJob:
        return MergeJob(ref, mov, known, METHODS[PLANE_METHOD].defaults, PLANE_METHOD, seed)

    return SideRuns(
        SideRun("nothing known", job()),
        SideRun(f"the place, to {VAGUE:g} m", job(near), about, VAGUE**2 * np.eye(2)),
        SideRun("the sighting", job(*inputs.observations), at.x_ref, at.covariance),
    )
