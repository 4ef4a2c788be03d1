"""Undo and redo at the top of the panel, and folder "History": a list to go anywhere."""

from __future__ import annotations

from html import escape

import viser

from algorithms.verdict.decision import Outcome
from app.page.panels.html_widgets import put
from app.page.undo.undo_history import UndoHistory, UndoStep

DOTS = {Outcome.MERGED: "#009E73", Outcome.BENT: "#E69F00", Outcome.REFUSED: "#D55E00"}


class HistoryPanel:
    """Shows where one has been. map_editing.js tells which of its buttons was pressed."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._steps = gui.add_html(steps_html("", ""), order=4.5)
        with gui.add_folder("History", order=80.0, expand_by_default=False):
            self._list = gui.add_html("")

    def show(self, history: UndoHistory) -> None:
        steps, at = history.steps, history.position
        undo = steps[at].label if at > 0 else ""
        redo = steps[at + 1].label if at + 1 < len(steps) else ""
        put(self._steps, content=steps_html(undo, redo))
        put(self._list, content=history_html(history))


def steps_html(undo: str, redo: str) -> str:
    """HTML of both buttons; ``undo``, ``redo``: what would be undone, or done again, or ""."""
    buttons = []
    for by, sign, name, what, keys in (
        (-1, "↶", "Undo", undo, "Ctrl+Z or ⌘Z"),
        (1, "↷", "Redo", redo, "Ctrl+Shift+Z, Ctrl+Y or ⇧⌘Z"),
    ):
        hint = escape(f"{name}: {what} ({keys})" if what else f"Nothing to {name.lower()}")
        off = "" if what else " disabled"
        buttons.append(
            f'<button type="button" class="mm-step" data-by="{by}" title="{hint}"{off}>'
            f'<span aria-hidden="true">{sign}</span> {name}</button>'
        )
    return f'<div class="mm-steps">{"".join(buttons)}</div>'


def history_html(history: UndoHistory) -> str:
    """HTML of a button per step, newest first; map_editing.js tells which one was pressed."""
    rows = []
    for number, step in reversed(list(enumerate(history.steps))):
        here, undone = number == history.position, number > history.position
        style = "font-weight:600;background:#0072B21f" if here else "opacity:.5" if undone else ""
        current = ' aria-current="true"' if here else ""
        rows.append(
            f'<button type="button" class="mm-entry" data-go="{number}"{current} style="{style}">'
            f"{_dot(step)}<span>{escape(step.label)}</span></button>"
        )
    return f'<div class="mm-history">{"".join(rows)}</div>'


def _dot(step: UndoStep) -> str:
    """A dot in the colour of the verdict, where there is one."""
    result = step.snapshot.result
    if result is None:
        return "<i></i>"
    outcome = result.verdict.outcome
    return f'<i style="background:{DOTS[outcome]}" role="img" aria-label="{outcome.value}"></i>'
