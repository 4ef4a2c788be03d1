"""What one tab merges, and what keeps it from merging."""

from __future__ import annotations

from dataclasses import dataclass

from algorithms.casefiles import Case, Truth
from algorithms.gridmap import GridMap
from algorithms.observation import Encounter, Observation, encounter


@dataclass(frozen=True, eq=False)
class Inputs:
    """Two maps and a sighting; None for what is not there yet.

    name  : what to call the pair before a person
    truth : the known answer of a sample
    """

    ref: GridMap | None = None
    mov: GridMap | None = None
    observation: Observation | None = None
    name: str = ""
    truth: Truth | None = None

    @property
    def at(self) -> Encounter | None:
        """Where robot 2 was seen, in both maps."""
        return encounter(self.observation) if self.observation else None

    @property
    def complete(self) -> bool:
        """Whether there is all that a merge needs."""
        return self.ref is not None and self.mov is not None and self.observation is not None

    def missing(self) -> str:
        """What to load next, as a sentence; empty where nothing is missing."""
        if self.ref is None and self.mov is None:
            if self.observation is None:
                return "Choose a sample, or load two maps and an observation."
            return "Now load the two maps: a YAML file and an image each."
        if self.ref is None or self.mov is None:
            return (
                f"Map {1 if self.mov is None else 2} is here. Load map {2 if self.mov is None else 1}, too."
            )
        if self.observation is None:
            return "Both maps are here. Load the observation: where robot 1 saw robot 2."
        return ""

    def doubt(self) -> str:
        """What is odd about the inputs, as a sentence; empty where nothing is."""
        o, at = self.observation, self.at
        if o is None or at is None:
            return ""
        for name, grid, point, key in (
            ("Robot 1", self.ref, o.observer.xy, "observer.pose"),
            ("Robot 2", self.mov, at.x_mov, "observed.pose"),
        ):
            if grid is not None and not grid.contains(point):
                number = 1 if grid is self.ref else 2
                return (
                    f"{name} at ({point[0]:.2f}, {point[1]:.2f}) m is outside map {number}. "
                    f"Check {key} in the observation."
                )
        return ""

    @staticmethod
    def of(case: Case) -> Inputs:
        """The inputs of a case folder."""
        return Inputs(case.ref, case.mov, case.observation, case.name, case.truth)
