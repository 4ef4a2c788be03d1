"""The museum of failures as a mode of the page: it loads an exhibit, tells what happens, and cures it."""

from __future__ import annotations

from pathlib import Path
from threading import RLock
from typing import Any

import viser

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import pose_error
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from app.model.merge_inputs import MergeInputs
from app.model.settings import settings_of, value_at, word_for
from app.model.status_text import apart_by
from app.page.lesson.hosts import Hall
from app.page.lesson.lesson_texts import Exhibit, Settings, exhibit_case, files, read_exhibit, with_settings
from app.page.lesson.museum_panel import MuseumPanel, MuseumWishes
from app.page.page_snapshot import PageSnapshot


class MuseumController:
    """Knows the exhibit at hand, and what there was before the visit.

    turn : held while a person's wish is carried out
    """

    def __init__(self, hall: Hall, gui: viser.GuiApi, turn: RLock, folder: Path) -> None:
        self._hall, self._turn, self._folder = hall, turn, folder
        self._panel = MuseumPanel(gui, MuseumWishes(self.pick, self.cure, self._again, self.leave))
        self.open = False
        self._before: PageSnapshot | None = None
        self._files: list[Path] = []
        self._index = 0
        self._exhibit: Exhibit | None = None
        self._inputs = MergeInputs()

    def enter(self) -> None:
        """Begin where one was the last time."""
        with self._turn:
            if self.open:
                return
            try:
                self._files = files(self._folder)
            except MapMergeError as error:
                self._hall.report(error)
                return
            self._before, self.open = self._hall.desk, True
            self._panel.contents([self._title(path) for path in self._files])
            self._panel.visible(True)
            self._hall.museum_entered(True)
            self.pick(min(self._index, len(self._files) - 1))

    def leave(self) -> None:
        """Put everything back as it was before the visit."""
        with self._turn:
            if not self.open:
                return
            before, self._before, self.open, self._exhibit = self._before, None, False, None
            self._panel.visible(False)
            self._hall.museum_entered(False)
            self._hall.museum_left(before)

    def pick(self, index: int) -> None:
        """Go to an exhibit."""
        with self._turn:
            if not self.open or not 0 <= index < len(self._files):
                return
            self._index, self._exhibit = index, None
            try:
                exhibit = read_exhibit(self._files[index])
                self._inputs = MergeInputs.of(exhibit_case(exhibit))
            except MapMergeError as error:
                self._panel.broken(index, str(error))
                return
            self._exhibit = exhibit
            method, config = self._failing(exhibit)
            self._panel.exhibit(index, exhibit.body)
            self._panel.settings(rows(exhibit, config))
            self._hall.hang(self._inputs, method, config, f"exhibit: {exhibit.title}")

    def cure(self) -> None:
        """Apply the cure, and merge."""
        with self._turn:
            if self.open and self._exhibit is not None:
                if self._hall.desk is None or self._hall.desk.inputs is not self._inputs:
                    self.pick(self._index)
                self._panel.settings(self._changes(self._exhibit))
                self._hall.treat(*self._cured(self._exhibit))

    def _again(self) -> None:
        self.pick(self._index)

    def told(self, inputs: MergeInputs, method: str, config: Any, result: MergeResult) -> None:
        """A merge came to its end: if it was the exhibit's, or its cure's, say what happened."""
        exhibit, truth = self._exhibit, self._inputs.truth
        if exhibit is None or inputs is not self._inputs or truth is None or truth.T_ref_mov is None:
            return
        distance, angle = pose_error(result.T_ref_mov, truth.T_ref_mov, result.encounter.x_mov)
        right = truth.allows(distance, angle)
        verdict = "accepted" if result.verdict.accepted else "refused"
        where = apart_by(distance, angle)
        if (method, config) == self._failing(exhibit) and not right:
            noticed = "The verdict saw it." if verdict == "refused" else "The verdict did not see it."
            self._panel.settings(rows(exhibit, config))
            self._panel.failed(exhibit.why, f"Wrong: {where} from the truth. {noticed}", exhibit.cure)
        elif (method, config) == self._cured(exhibit) and right:
            self._panel.settings(self._changes(exhibit))
            self._panel.cured(exhibit.cured, f"Cured: {where} from the truth, and {verdict}.")

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
    told = [("sample", sample), ("method", METHODS[exhibit.method].title)]
    return told + _settings(exhibit.settings, config)


def changes(exhibit: Exhibit, failing: Any, cured: Any) -> list[tuple[str, ...]]:
    """The same once the cure is applied: what it has changed with what it was before."""
    titles = [METHODS[method].title for method in (exhibit.method, exhibit.cure_method)]
    touched = tuple(dict((*exhibit.settings, *exhibit.cure_settings)).items())
    before, after = dict(_settings(touched, failing)), _settings(touched, cured)
    told = [("method", _change(*titles))]
    told += [(label, _change(before.get(label, words), words)) for label, words in after]
    return [rows(exhibit, failing)[0], *told]


def _change(old: str, new: str) -> str:
    return new if old == new else f"{old} → {new}"


def _settings(settings: Settings, config: Any) -> list[tuple[str, ...]]:
    known = {setting.path: setting for setting in settings_of(config)}
    out: list[tuple[str, ...]] = []
    for path, _ in settings:
        if path not in known:  # of another method
            continue
        setting, value = known[path], value_at(config, path)
        if setting.choices is not None:
            words = word_for(setting, value)
        elif isinstance(value, bool):
            words = "on" if value else "off"
        else:
            words = f"{value:g}"
        out.append((setting.label, words))
    return out
