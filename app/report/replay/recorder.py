"""A run told once more, and every picture of it kept: what the page's map view draws, when it draws it.

Time is the time of the telling: how long each step stays for the eye (app/model/playback.py). Nothing of the
computer's own clock is in it, so the same run is recorded to the same bytes.
"""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

import numpy as np

from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AugmentDetail, ObservationDetail, RefineDetail, Step
from app.drawing.browser_messages import BrowserMessages
from app.drawing.legend import legend
from app.drawing.palette import LIGHT
from app.drawing.scene.grid_image import Size
from app.drawing.scene.map_view import MapView
from app.drawing.scene.run_view import RunView
from app.drawing.scene_layout import lay_out
from app.model import status_text as words
from app.model import verdict_text
from app.model.knowledge import counted
from app.model.merge_inputs import MergeInputs
from app.model.playback import FRAME, dwell
from app.model.run_state import RunState
from app.model.status_text import typeset
from app.model.view_modes import MAP
from app.report.replay.chart_recorder import curves
from app.report.replay.image_recorder import PictureScene
from app.report.result_rows import STAGES, named, numbers, prior_rows, sighting_rows

BEFORE = 1.2  # seconds that the maps lie side by side
AFTER = 4.0  # seconds that the verdict stays
PARTICLES = 400  # drawn of the first swarm; more would be megabytes
LATER_PARTICLES = 120  # of each later one, which is only glanced at
ASPECT = 1.5  # of the player's map, width over height
PICTURE = 1024  # pixels of a side of a picture at most

Recording = dict[str, Any]


class Recorder(BrowserMessages):
    """Keeps what a tab would have been told; what has not changed since is left out."""

    def __init__(self, scene: PictureScene) -> None:
        super().__init__()
        self._scene = scene
        self._last: dict[str, Any] = {}
        self.frames: list[dict[str, Any]] = []
        self.time = 0.0
        self.particles = PARTICLES

    def extra(self, **shown: Any) -> None:
        """What a replay shows beside the map."""
        with self._lock:
            self._pending.update(shown)

    def send(self, message: dict[str, Any]) -> None:
        """Keep it as a frame of this time."""
        layers = message.pop("layers", {})
        message.pop("follow", None)
        message["pictures"] = self._scene.seen
        if self._scene.ghost is not None:
            message["ghost"] = _compact(self._scene.ghost.pose)
        frame = {"t": round(self.time, 3)} | self._news("", message)
        thinned = {name: items and [self._thinned(item) for item in items] for name, items in layers.items()}
        if drawn := self._news("layer ", thinned):
            frame["layers"] = drawn
        self.frames.append(frame)

    def _news(self, prefix: str, values: dict[str, Any]) -> dict[str, Any]:
        news = {}
        for key, value in values.items():
            value = _compact(value)
            if self._last.get(prefix + key, self) != value:
                self._last[prefix + key] = news[key] = value
        return news

    def _thinned(self, item: dict[str, Any]) -> dict[str, Any]:
        if item["k"] != "cloud":
            return item
        points = np.asarray(item["p"]).reshape(-1, item["n"])
        return item | {"p": points[:: max(1, -(-len(points) // self.particles))].ravel()}


def record(steps: Iterable[Step], inputs: MergeInputs, config: Any) -> Recording:
    """The pictures, words and curves of a whole run.

    steps  : of the method, up to its MergeResult
    inputs : what it merges; complete
    config : its settings
    returns: what player.js plays, as JSON can hold it; lengths in metres, times in seconds
    """
    scene = PictureScene()
    recording = Recorder(scene)
    recording.names, told = inputs.names, inputs.names.told
    maps = MapView(SimpleNamespace(scene=scene), recording, Size(PICTURE, PICTURE))  # type: ignore[arg-type]
    maps.load(inputs, lay_out(inputs.ref, inputs.mov, inputs.at, ASPECT), LIGHT)
    view = RunView(maps, recording)
    run, marks, result = RunState(config), [{"t": 0.0, "name": "Maps"}], None
    recording.hud(state=words.SIDE_BY_SIDE, mood="running", legend=legend(LIGHT, MAP, run))
    recording.extra(curves=[], table=beginning(inputs))
    recording.flush()
    recording.time, drawn_at, at_work = BEFORE, -FRAME, ""
    for step in steps:
        run.add(step)
        if step.stage != at_work:
            at_work = step.stage
            name = STAGES.get(at_work, at_work)
            marks.append({"t": round(recording.time, 3), "name": name[0].upper() + name[1:]})
            drawn_at = -FRAME  # its first picture is not left out
        if isinstance(step.detail, MergeResult):
            result = step.detail
        stay = dwell(step, 1.0, again=True)
        if stay >= FRAME or recording.time - drawn_at >= FRAME or result is not None:
            drawn_at = recording.time
            _draw(run, recording, view, inputs, config)
        recording.time += stay
        if result is not None:
            break
    assert result is not None
    rows = _typeset(numbers(result, inputs, config))
    mood = verdict_text.mood(result.verdict)
    recording.hud(mood=mood, state=result.verdict.reason)
    recording.extra(table={"rows": rows, "says": told(verdict_text.remedy(result)), "mood": mood})
    recording.flush()
    return {
        "frames": recording.frames,
        "pictures": scene.pictures,
        "marks": marks,
        "length": round(recording.time + AFTER, 3),
        "verdict": told(result.verdict.reason),
    }


def sizes(inputs: MergeInputs) -> list[list[str]]:
    """How large the maps are, a row each."""
    return [
        [inputs.names.told(f"map {number}"), f"{grid.width} × {grid.height} cells of {grid.resolution:g} m"]
        for number, grid in enumerate(inputs.grids, 1)
    ]


def beginning(inputs: MergeInputs) -> dict[str, Any]:
    """What there is before anything was done."""
    return {"title": inputs.title, "rows": [*sizes(inputs), ["known", counted(inputs.known)]]}


def observed(inputs: MergeInputs) -> dict[str, Any]:
    """The numbers of the first sighting; without one of what else is known."""
    if not inputs.observations:
        rows = [row for prior in inputs.priors for row in named(prior_rows(prior), inputs.names)]
        return {"title": "What is known", "rows": _typeset(rows or [("of how the maps lie", "nothing")])}
    o, at = inputs.observations[0], inputs.encounters[0]
    of = f", the first of {len(inputs.observations)}" if len(inputs.observations) > 1 else ""
    title = inputs.names.told(f"What robot 1 saw{of}")
    return {"title": title, "rows": _typeset(named(sighting_rows(o, at), inputs.names))}


def _typeset(rows: Iterable[tuple[str, ...]]) -> list[list[str]]:
    return [[name, *map(typeset, values)] for name, *values in rows]


def _draw(run: RunState, recording: Recorder, view: RunView, inputs: MergeInputs, config: Any) -> None:
    detail = run.last.detail if run.last else None
    later = isinstance(detail, RefineDetail) and detail.index > 0
    recording.particles = LATER_PARTICLES if later else PARTICLES
    view.show(run, config, camera=True, live=True)
    recording.hud(state=words.sentence(run), mood="running", legend=legend(LIGHT, MAP, run))
    seen = isinstance(detail, (ObservationDetail, AugmentDetail))
    recording.extra(curves=curves(run, inputs.names), table=observed(inputs) if seen else None)
    recording.flush()


def _compact(value: Any) -> Any:
    """The value as JSON holds it in few letters: to a millimetre, or a thousandth of a radian."""
    if isinstance(value, np.ndarray):
        return _compact(np.round(value.astype(float), 3).tolist())
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float):
        value = round(value, 3)
        return int(value) if value == int(value) else value
    if isinstance(value, dict):
        return {key: _compact(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_compact(inner) for inner in value]
    return value
