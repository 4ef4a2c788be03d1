"""A run as one HTML page that plays offline: a recording and its player, which asks nothing of anybody."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from html import escape
from typing import Any

from algorithms.methods.registry import METHODS
from algorithms.methods.steps import Step
from app.drawing import grid_pixels as render
from app.drawing.palette import DARK, LIGHT, Palette
from app.model import status_text as words
from app.model.knowledge import counted
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.settings import settings_of, text_for, value_at
from app.report.replay.recorder import (
    LATER_PARTICLES,
    PARTICLES,
    PICTURE,
    Recording,
    record,
    sizes,
)
from app.system.cancellation import Check, never_cancelled, wanted
from app.system.data_paths import asset
from app.system.version import versions

Rows = list[list[str]]
RECOLOURED = ("agreed", "margin", "free", "unknown", "text")  # on a dark page


@dataclass(frozen=True, eq=False)
class ReplayMetadata:
    """The run that was recorded; versions: of mapmeld and what it stands on."""

    inputs: MergeInputs
    method: str
    config: Any
    seed: int
    versions: Mapping[str, str] = field(default_factory=versions)

    def facts(self) -> Rows:
        return [
            ["pair", self.inputs.name],
            *sizes(self.inputs),
            ["known", counted(self.inputs.known)],
            ["method", f"{METHODS[self.method].title} ({self.method})"],
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
        if any(render.pooling(grid.cells.shape, PICTURE) > 1 for grid in self.inputs.grids):
            notes.append(
                f"The pictures are coarser than the maps: at most {PICTURE} pixels on a side; walls are kept."
            )
        return notes


def replay_of(
    job: MergeJob,
    steps: Callable[[MergeJob, Callable[[], bool]], Iterator[Step]],
    inputs: MergeInputs,
    check: Check = never_cancelled,
) -> bytes:
    """The page for a run.

    steps  : gives the steps of that run, as long as they are wanted
    inputs : the same maps and sightings, with their name and, where it is known, the truth
    check  : is called at every step
    """

    def watched() -> Iterator[Step]:
        run = RunState(job.config)
        for step in steps(job, partial(wanted, check)):
            run.add(step)
            check(words.progress(run))
            yield step
        check()  # they end early where they are not wanted

    about = ReplayMetadata(inputs, job.method, job.config, job.seed)
    return replay_html(record(watched(), inputs, job.config), about)


def replay_html(recording: Recording, about: ReplayMetadata) -> bytes:
    """The page; equal runs give equal bytes. Every text in it is data, never markup."""
    data = recording | {
        "name": about.inputs.title,
        "method": METHODS[about.method].title,
        "seed": about.seed,
        "version": about.versions.get("mapmeld", "unknown"),
        "facts": about.facts(),
        "settings": about.settings(),
        "notes": about.notes(),
        "dark": {_red_green_blue(LIGHT, name): _red_green_blue(DARK, name) for name in RECOLOURED},
    }
    parts = {
        "{{title}}": escape(f"{about.inputs.title}: replay of a merge"),
        "/*{{style}}*/": asset("replay/player.css"),
        "/*{{ink}}*/": asset("map_drawing.js"),
        "/*{{charts}}*/": asset("replay/charts.js"),
        "/*{{player}}*/": asset("replay/player.js"),
        "{{recording}}": as_script(data),
    }
    # in one go: what has been put in is not looked at again
    slots = re.compile("|".join(map(re.escape, parts)))
    return slots.sub(lambda slot: parts[slot.group()], asset("replay/player.html")).encode()


def _red_green_blue(palette: Palette, name: str) -> str:
    return ",".join(map(str, getattr(palette, name)))


def as_script(data: Any) -> str:
    """JSON that may stand inside of a script element, whatever the texts in it say."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")
