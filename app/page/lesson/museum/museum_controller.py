"""The museum of failures as a mode of the page: it loads an exhibit, tells what happens, and cures it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import pose_error
from algorithms.methods.registry import METHODS
from algorithms.observations.fleet import Fleet
from app.model.knowledge import CHOICES
from app.model.merge_inputs import Files, MergeInputs
from app.model.settings import settings_of, text_for, value_at
from app.model.status_text import apart_by
from app.model.view_modes import MUSEUM
from app.page.inputs_controller import InputsController
from app.page.lesson.figures.poster_figure import opinions, poster
from app.page.lesson.lesson_texts import Settings, files, with_settings
from app.page.lesson.museum.exhibit_samples import exhibit_fleet, exhibit_inputs, exhibit_picture
from app.page.lesson.museum.exhibit_texts import Exhibit, museum_folder, read_exhibit
from app.page.lesson.sighting_look import LookThread, SightingLook
from app.page.run_controller import RunController
from app.page.tab import Tab
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_controller import UndoController
from app.report.fleet_report import summary


class MuseumController:
    """Knows the exhibit at hand, and what was before the visit; ``merge_fleet``: shows and merges one."""

    def __init__(
        self,
        tab: Tab,
        undo: UndoController,
        runs: RunController,
        inputs: InputsController,
        merge_fleet: Callable[[Fleet, str], None],
    ) -> None:
        self._state, self._display, self._panels = tab.state, tab.display, tab.panels
        self._modes, self._notices, self._panel = tab.modes, tab.notices, tab.panels.museum
        self._undo, self._runs, self._inputs, self._merge_fleet = undo, runs, inputs, merge_fleet
        self.open = False
        self._before: PageSnapshot | None = None
        self._files: list[Path] = []
        self._index = 0
        self._exhibit: Exhibit | None = None
        self._pair = self._cured_pair = MergeInputs()
        self._looks = LookThread(runs.thread.runner, tab.state.locks.drawing, self._seen, self._panel.picture)
        self._look: SightingLook | None = None  # at the picture of the exhibit at hand
        self._asked = False  # whether laser and map may say what they say of it
        self._panel.connect(self.pick, self.cure, lambda: self.pick(self._index), self.leave)
        tab.state.subscribe("result", self._result_shown)
        tab.state.subscribe("fleet", self._fleet_shown)
        tab.state.subscribe("palette", self._show_look)

    def close(self) -> None:
        self._looks.close()

    def toggle(self) -> None:
        (self.leave if self.open else self.enter)()

    def enter(self) -> None:
        """Begin where one was the last time."""
        with self._state.locks.action:
            if self.open:
                return
            try:
                self._files = files(museum_folder())
            except MapMergeError as error:
                self._notices.report(error)
                return
            self._modes.leave()
            self._before = self._undo.history.snapshot
            self._panel.contents([self._title(path) for path in self._files])
            self._show(True)
            self.pick(min(self._index, len(self._files) - 1))

    def leave(self) -> None:
        """Put everything back as it was before the visit."""
        with self._state.locks.action:
            if not self.open:
                return
            before, self._before, self._exhibit = self._before, None, None
            self._looks.stop()
            self._show(False)
            if before is not None:
                self._undo.go_to(before, "leave the museum")

    def _show(self, open_: bool) -> None:
        self.open = open_
        self._panel.visible(open_)
        self._panels.run.open(MUSEUM, open_)
        self._display.show_buttons()

    def pick(self, index: int) -> None:
        with self._state.locks.action:
            if not self.open or not 0 <= index < len(self._files):
                return
            self._index, self._exhibit = index, None
            self._looks.stop()
            self._look, self._asked = None, False
            try:
                exhibit = read_exhibit(self._files[index])
                self._pair, self._cured_pair = exhibit_inputs(exhibit)
            except MapMergeError as error:
                self._panel.broken(index, str(error))
                return
            self._exhibit = exhibit
            method, config = self._failing(exhibit)
            self._panel.exhibit(index, exhibit.body)
            self._panel.settings(rows(exhibit, config))
            task = exhibit_picture(exhibit)
            if task is not None:
                self._panel.picture("The detector looks at the picture …")
                self._looks.ask(task, self._pair, config)
            self._runs.thread.stop()
            self._modes.close()
            self._runs.set_method(method, config, seed=0)
            self._panels.files.show(Files(self._pair.name))
            with self._state.locks.drawing:
                if self._inputs.show(self._pair):
                    self._state.update(fleet=None)
                    self._undo.history.note(self._state.snapshot(), f"exhibit: {exhibit.title}")

    def cure(self) -> None:
        """Apply the cure, and merge."""
        with self._state.locks.action:
            if self.open and self._exhibit is not None:
                exhibit = self._exhibit
                fleet = exhibit_fleet(exhibit)
                if fleet is not None:
                    self._panel.settings(self._changes(exhibit))
                    self._merge_fleet(fleet, exhibit.case)
                    return
                if self._state.inputs is not self._pair:
                    self.pick(self._index)
                if self._pair is not self._cured_pair:
                    with self._state.locks.drawing:
                        self._inputs.show(self._cured_pair)
                self._panel.settings(self._changes(exhibit))
                self._runs.set_method(*self._cured(exhibit), seed=0)
                self._runs.merge()

    def _result_shown(self) -> None:
        """A merge came to its end: if it was the exhibit's, or its cure's, say what happened."""
        exhibit, truth, result = self._exhibit, self._pair.truth, self._state.result
        failing, cured = (self._state.inputs is pair for pair in (self._pair, self._cured_pair))
        if exhibit is None or result is None or not (failing or cured):
            return
        if truth is None or truth.T_ref_mov is None:
            return
        distance, angle = pose_error(result.T_ref_mov, truth.T_ref_mov, result.pivot)
        right = truth.allows(distance, angle)
        verdict = "accepted" if result.verdict.accepted else "refused"
        ran = result.method, self._state.result_config
        where = apart_by(distance, angle)
        if failing and ran == self._failing(exhibit) and not right:
            noticed = "The verdict saw it." if verdict == "refused" else "The verdict did not see it."
            self._panel.settings(rows(exhibit, self._state.result_config))
            self._tell_all()
            self._panel.failed(exhibit.why, f"Wrong: {where} from the truth. {noticed}", exhibit.cure)
        elif cured and ran == self._cured(exhibit) and right:
            self._panel.settings(self._changes(exhibit))
            self._tell_all()
            self._panel.cured(exhibit.cured, f"Cured: {where} from the truth, and {verdict}.")

    def _fleet_shown(self) -> None:
        """The fleet of an exhibit was merged: say what became of the sighting."""
        exhibit, state = self._exhibit, self._state.fleet
        if exhibit is None or not exhibit.sighting or state is None or state.result is None:
            return
        left = [each.reason for each in state.result.left_out if each.number == exhibit.sighting - 1]
        if state.name == exhibit.case and left:
            said = summary(state.result, len(state.robots))
            self._panel.cured(exhibit.cured, f"Cured: {said} {left[0]}.")

    def _seen(self, look: SightingLook) -> None:
        self._look = look
        self._show_look()

    def _tell_all(self) -> None:
        """Let laser and map say what they say of the picture, too; before a merge the detector alone does."""
        self._asked = True
        self._show_look()

    def _show_look(self) -> None:
        if self._exhibit is not None and self._look is not None:
            said = opinions(self._look)
            self._panel.picture(poster(self._look, self._state.palette), said if self._asked else said[:1])

    def _failing(self, exhibit: Exhibit) -> tuple[str, Any]:
        return exhibit.method, with_settings(METHODS[exhibit.method].defaults, exhibit.settings)

    def _cured(self, exhibit: Exhibit) -> tuple[str, Any]:
        both = (*exhibit.settings, *exhibit.cure_settings)
        return exhibit.cure_method, with_settings(METHODS[exhibit.cure_method].defaults, both)

    def _changes(self, exhibit: Exhibit) -> list[tuple[str, ...]]:
        return changes(exhibit, self._failing(exhibit)[1], self._cured(exhibit)[1])

    def _title(self, path: Path) -> str:
        try:
            return read_exhibit(path).title
        except MapMergeError:
            return path.name


def rows(exhibit: Exhibit, config: Any) -> list[tuple[str, ...]]:
    """What is loaded and set for an exhibit, as a person reads it."""
    sample = exhibit.case + (", badly measured" if exhibit.rough else "")
    sample += f", sighting {exhibit.sighting} alone" if exhibit.sighting else ""
    shown = [("sample", sample), ("method", METHODS[exhibit.method].title)]
    if exhibit.picture:
        shown.append(("picture", exhibit.picture))
    if exhibit.known != exhibit.cure_known:
        shown.append(("known", CHOICES[exhibit.known]))
    return shown + _settings(exhibit.settings, config)


def changes(exhibit: Exhibit, failing: Any, cured: Any) -> list[tuple[str, ...]]:
    """The same once the cure is applied: what it has changed with what it was before."""
    titles = [METHODS[method].title for method in (exhibit.method, exhibit.cure_method)]
    touched = tuple(dict((*exhibit.settings, *exhibit.cure_settings)).items())
    before, after = dict(_settings(touched, failing)), _settings(touched, cured)
    shown = [("method", _change(*titles))]
    if exhibit.picture:
        shown.append(("picture", f"{exhibit.picture} → refused by the laser"))
    if exhibit.known != exhibit.cure_known:
        shown.append(("known", _change(CHOICES[exhibit.known], CHOICES[exhibit.cure_known])))
    shown += [(label, _change(before.get(label, words), words)) for label, words in after]
    (label, sample), *_ = rows(exhibit, failing)
    return [(label, f"{sample} → all of its sightings" if exhibit.sighting else sample), *shown]


def _change(old: str, new: str) -> str:
    return new if old == new else f"{old} → {new}"


def _settings(settings: Settings, config: Any) -> list[tuple[str, ...]]:
    """Those of the method that has this config, by their labels."""
    known = {setting.path: setting for setting in settings_of(config)}
    mine = [known[path] for path, _ in settings if path in known]
    return [(each.label, text_for(each, value_at(config, each.path), "on", "off")) for each in mine]
