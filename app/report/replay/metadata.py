"""What a replay says of itself: of what it is a recording, and how it was made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from algorithms.methods.registry import METHODS
from app.drawing import grid_pixels as render
from app.model.merge_inputs import MergeInputs
from app.model.settings import settings_of, text_for, value_at
from app.report.replay.recorder import LATER_PARTICLES, PARTICLES, PICTURE, sizes
from app.system.version import versions

Rows = list[list[str]]


@dataclass(frozen=True, eq=False)
class ReplayMetadata:
    """The run that was recorded.

    versions : of mapmeld and what it stands on
    """

    inputs: MergeInputs
    method: str
    config: Any
    seed: int
    versions: Mapping[str, str] = field(default_factory=versions)

    @property
    def method_title(self) -> str:
        """The method as the menu names it."""
        return METHODS[self.method].title

    def facts(self) -> Rows:
        return [
            ["pair", self.inputs.name],
            *sizes(self.inputs),
            ["observations", str(len(self.inputs.observations))],
            ["method", f"{self.method_title} ({self.method})"],
            ["seed", str(self.seed)],
            ["made with", ", ".join(f"{name} {number}" for name, number in self.versions.items())],
        ]

    def settings(self) -> Rows:
        """Every setting: its name, its value, and the method's own value where it was changed."""
        rows = []
        for setting in settings_of(self.config):
            default = value_at(METHODS[self.method].defaults, setting.path)
            value = setting.default
            shown, usual = (text_for(setting, each, "yes", "no") for each in (value, default))
            changed = f"instead of {usual}" if value != default else ""
            rows.append([f"{setting.path[0]}: {setting.label}", shown, changed])
        return rows

    def notes(self) -> list[str]:
        """What a viewer should know of a recording, a sentence each."""
        notes = [
            "This is a recording of one run. Nothing is computed here, and nothing can be changed.",
            "How long a step stays is set for the eye: it does not tell how long the run took.",
            f"Of the first swarm at most {PARTICLES} particles are drawn, of the later {LATER_PARTICLES}.",
        ]
        grids = [grid for grid in (self.inputs.ref, self.inputs.mov) if grid is not None]
        if any(render.pooling(grid.cells.shape, PICTURE) > 1 for grid in grids):
            notes.append(
                f"The pictures are coarser than the maps: at most {PICTURE} pixels on a side; walls are kept."
            )
        return notes
