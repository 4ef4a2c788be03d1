"""What is merged: loads it in place of everything there was."""

from __future__ import annotations

from dataclasses import replace

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.maps.map_corrections import NO_CORRECTIONS
from algorithms.methods.registry import METHODS
from app.drawing.scene_layout import lay_out
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.run_controller import RunController
from app.page.suited_method import following_method
from app.page.tab import Tab
from app.web.cell_quota import CellQuota


class InputsController:
    """Of one tab; ``quota`` is shared by all tabs."""

    def __init__(self, tab: Tab, runs: RunController, quota: CellQuota) -> None:
        self._state, self._display, self._panels = tab.state, tab.display, tab.panels
        self._modes, self._history, self._notices = tab.modes, tab.history, tab.notices
        self._runs, self._quota = runs, quota

    def close(self) -> None:
        self._quota.release(self)

    def load(self, inputs: MergeInputs, label: str = "") -> None:
        """Show these inputs as an action of the person, called so; a lesson goes on with them."""
        self._runs.thread.stop()
        with self._state.locks.action:
            mode, before = self._modes.close(), self._state.inputs
            inputs = inputs.named_as(before)
            with self._state.locks.drawing:
                if self.show(inputs):
                    if inputs.grids != before.grids:  # else it is more that is known of a fleet's pair
                        self._state.update(fleet=None)
                    self.follow(before, inputs)
                    self._history.note(self._state.snapshot(), label)
            if mode is not None and mode.reopen is not None:
                mode.reopen()

    def show(self, inputs: MergeInputs) -> bool:
        """Show these inputs, and nothing that was found on others; whoever calls is drawing.

        Whether they could be shown: too large ones are reported.
        """
        if self._state.closed:
            return False
        self._runs.thread.stop()  # a run of others may have been asked for while this waited for its turn
        try:
            self._quota.claim(self, sum(grid.cells.size for grid in inputs.grids))
            layout = lay_out(inputs.ref, inputs.mov, inputs.at)
        except MapMergeError as error:
            self._notices.report(error)
            return False
        self._notices.clear()
        self._modes.close()
        self.forget_results(inputs, view=MAP, files=self._panels.files.files)
        self._display.show_inputs(layout)
        self._display.messages.flush()
        return True

    def follow(self, before: MergeInputs, after: MergeInputs) -> None:
        """Take the method that suits the inputs now, if the one at hand did suit them before."""
        method = following_method(self._state.method, before, after)
        if method != self._state.method:
            self._runs.set_method(method, METHODS[method].defaults)

    def forget_results(self, inputs: MergeInputs, **more: object) -> None:
        """These are the inputs now; what was found with others no longer counts."""
        gone = dict.fromkeys(("result", "result_config", "contradictions", "search", "goal"))
        export = self._state.export
        if isinstance(export.frame, Pose2) and inputs.ref is not self._state.inputs.ref:
            more["export"] = replace(export, frame="ref")  # it was one of the other map
        if inputs.grids != self._state.inputs.grids:  # they were of the other maps
            more["corrections"] = NO_CORRECTIONS
        self._state.update(inputs=inputs, run=RunState(), **gone, **more)
