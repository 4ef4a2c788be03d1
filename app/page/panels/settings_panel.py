"""Folders "Augmentation" to "Result": a slider for every setting of the chosen method."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from threading import RLock, get_ident
from typing import Any

import viser

from algorithms.common.errors import MapMergeError, SettingError
from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from app.drawing.palette import QUIET
from app.model.settings import Path, Setting, in_cells, settings_of, value_at, with_value, word_for
from app.page.panels.html_widgets import put

# Group of the config -> folder; what is not named goes to "Search".
FOLDERS = {
    "augment": "Augmentation",
    "agreement": "Agreement",
    "proof": "Proof",
    "whole_maps": "Proof",
    "verdict": "Result",
    "conflict": "Result",
}
ORDER = {"Augmentation": 30.0, "Search": 40.0, "Agreement": 43.0, "Proof": 46.0, "Result": 60.0}

# Shown at once, in this order; every other setting is under "More".
FRONT: tuple[Path, ...] = (
    ("augment", "intensity"),
    ("augment", "spread"),
    ("window", "kind"),
    ("window", "margin"),
    ("window", "deviations"),
    ("refine", "objective"),
    ("box", "sigma_x"),
    ("box", "sigma_y"),
    ("box", "sigma_theta"),
    ("refine", "optimiser"),
    ("swarm", "particles"),
    ("swarm", "iterations"),
    ("swarm", "omega"),
    ("swarm", "tau"),
)


def idle(config: Any, path: Path) -> bool:
    """Whether a setting does nothing beside the others as they stand."""
    refine, proof = getattr(config, "refine", None), getattr(config, "proof", None)
    if path == ("window", "kind"):  # the plane's window is a coupled one
        return refine is None
    if path[0] == "agreement":
        return refine is not None and refine.objective != "agreement"
    if path[0] == "proof" and path[-1] != "whole_circle":
        return proof is not None and not proof.whole_circle
    if path in {("swarm", "omega"), ("swarm", "tau")}:
        return refine is not None and refine.optimiser != "pso"
    if path[0] in {"swarm", "box"} or path == ("refine", "candidates"):
        return refine is not None and refine.optimiser == "none"
    return False


def _in_metres(setting: Setting) -> bool:
    """Whether a setting is a length with a symbol: worth telling in cells, too."""
    return setting.bounds is not None and setting.bounds.unit == "m" and bool(setting.bounds.symbol)


class SettingsPanel:
    """Shows a config, and makes another one as its sliders are moved.

    action : held while a change by the person is carried out, ``changed`` included: nobody else gets it
             before everything that goes by the config knows of it
    """

    def __init__(self, gui: viser.GuiApi, action: RLock) -> None:
        self._gui, self._action = gui, action
        self._handles: dict[Path, Any] = {}
        self._settings: dict[Path, Setting] = {}
        self._folders: dict[str, Any] = {}
        self._notes: dict[str, Any] = {}
        self._cells: tuple[float, ...] = ()
        self._writer = 0  # a value that is written calls back at once, half-way through the others
        self._shown = False  # whether any setting is
        self.method = DEFAULT_METHOD
        self.config: Any = METHODS[self.method].defaults
        self._build()

    def connect(self, changed: Callable[[], None], report: Callable[[MapMergeError], None]) -> None:
        """What is done where a person has changed a setting, or set what cannot be."""
        self._changed, self._report = changed, report

    def choose(self, method: str) -> None:
        with self._action:
            if method == self.method:
                return
            self._take(method)
            self._changed()

    def restore(self, method: str, config: Any) -> None:
        with self._action:
            if method != self.method:
                self._take(method)
            self.config = config
            self._write(config)

    def _take(self, method: str) -> None:
        self.method, self.config = method, METHODS[method].defaults
        for folder in self._folders.values():
            folder.remove()
        self._build()

    def research(self, yes: bool) -> None:
        """Show the settings, or hide all of them."""
        self._shown = yes
        self._hide_idle()

    def resolutions(self, *cells: float) -> None:
        """Metres per cell of the maps, so that lengths are shown in cells, too."""
        self._cells = cells
        self._show_cells()

    # --- building ---------------------------------------------------------------------------------

    def _build(self) -> None:
        self._handles.clear()
        self._notes.clear()
        self._settings = {setting.path: setting for setting in settings_of(self.config)}
        self._folders = {}
        for title, order in ORDER.items():
            mine = self._paths_in(title)
            if not mine:
                continue
            front = [path for path in FRONT if path in mine]
            more = [path for path in mine if path not in front]
            folder = self._gui.add_folder(title, order=order, expand_by_default=bool(front))
            self._folders[title] = folder
            with folder:
                for path in front:
                    self._add(self._settings[path])
                if any(_in_metres(self._settings[path]) for path in mine):
                    self._notes[title] = self._gui.add_html("")
                if more:
                    within = self._gui.add_folder("More", expand_by_default=False) if front else nullcontext()
                    with within:
                        for path in more:
                            self._add(self._settings[path])
                reset = self._gui.add_button(f"Reset {title.lower()}", color=QUIET)
                reset.on_click(lambda _, mine=tuple(mine): self._reset(mine))
        self._show_cells()
        self._hide_idle()

    def _paths_in(self, title: str) -> list[Path]:
        """The settings of a folder."""
        return [path for path in self._settings if FOLDERS.get(path[0], "Search") == title]

    def _add(self, setting: Setting) -> None:
        hint, value = setting.hint or None, setting.default
        if setting.bounds is not None:
            b, kind = setting.bounds, int if setting.whole else float
            ends = {"min": kind(b.low), "max": kind(b.high), "step": kind(b.step)}
            start: Any = kind(value)
            handle: Any = self._gui.add_slider(setting.label, initial_value=start, hint=hint, **ends)
        elif setting.choices is not None:
            words, start = tuple(setting.choices), word_for(setting, value)
            handle = self._gui.add_dropdown(setting.label, words, initial_value=start, hint=hint)
        else:
            handle = self._gui.add_checkbox(setting.label, value, hint=hint)
        self._handles[setting.path] = handle
        handle.on_update(lambda _: self._read())

    # --- reading and writing ----------------------------------------------------------------------

    def _wanted(self, path: Path) -> Any:
        value, setting = self._handles[path].value, self._settings[path]
        if setting.choices is not None:
            return setting.choices[value]
        if setting.bounds is None:
            return bool(value)
        # sliders step from their lower end in binary fractions; 0.1 + 2 * 0.1 is meant as 0.3
        return int(value) if setting.whole else round(float(value), 6)

    def read(self) -> Any:
        """The config as the panel stands: every widget is asked, since a message of one may be lost."""
        config = self.config
        for path in self._handles:
            value = self._wanted(path)
            if value != value_at(config, path):
                config = with_value(config, path, value)
        return config

    def sync(self) -> bool:
        """Take in what the widgets say now: a message of theirs may have been lost on the way.

        Whether that is anything new; what cannot be set is reported.
        """
        before = self.config
        try:
            self.config = self.read()
        except SettingError as error:
            self._report(error)
            self._write(self.config)
        return self.config != before

    def _read(self) -> None:
        if self._writer == get_ident():
            return
        with self._action:
            if not self.sync():
                return
            self._show_cells()
            self._hide_idle()
            self._changed()

    def _reset(self, mine: tuple[Path, ...]) -> None:
        with self._action:
            config = self.config
            if not self._settings.keys() >= set(mine):  # of a method that has given way meanwhile
                return
            for path in mine:
                config = with_value(config, path, self._settings[path].default)
            if config == self.config:
                return
            self.config = config
            self._write(config)
            self._changed()

    def _write(self, config: Any) -> None:
        self._writer = get_ident()
        try:
            for path, handle in self._handles.items():
                value, setting = value_at(config, path), self._settings[path]
                put(handle, value=word_for(setting, value) if setting.choices is not None else value)
        finally:
            self._writer = 0
        self._show_cells()
        self._hide_idle()

    def _hide_idle(self) -> None:
        """Show the settings that do something, and the folders that hold one."""
        for path, handle in self._handles.items():
            put(handle, visible=not idle(self.config, path))
        for title, folder in self._folders.items():
            useful = not all(idle(self.config, path) for path in self._paths_in(title))
            put(folder, visible=self._shown and useful)

    def _show_cells(self) -> None:
        """Lengths in cells below the sliders of a folder; the maps may differ in resolution."""
        for title, note in self._notes.items():
            lengths = [self._settings[path] for path in self._paths_in(title)] if self._cells else []
            said = " · ".join(
                f"{each.bounds.symbol} = {in_cells(value_at(self.config, each.path), *self._cells)}"
                for each in filter(_in_metres, lengths)
            )
            note.content = f'<div style="font-size:11.5px;opacity:.7;margin:-2px 10px 6px">{said}</div>'
