"""A suggestion of a refused merge, pressed: map 2 lies so, in the person's hand."""

from __future__ import annotations

from algorithms.methods.merge_result import MergeResult
from algorithms.methods.suggestions import suggestions_of
from app.page.editing.map_drag_controller import MapDragController
from app.page.tab import Tab


class SuggestionController:
    """Of one tab."""

    def __init__(self, tab: Tab, drag: MapDragController) -> None:
        self._state, self._drag = tab.state, drag
        tab.events.on("suggest", self._preview, number=int)

    def _preview(self, number: int) -> None:
        with self._state.locks.action:
            search = self._state.search
            result = search.get(MergeResult) if search is not None else None
            for each in () if result is None else suggestions_of(result):
                if each.number == number:
                    self._drag.preview(each.T_ref_mov, f"look at suggestion {number}")
