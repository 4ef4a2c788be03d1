"""What the lesson and the museum need of the page they are on."""

from __future__ import annotations

from typing import Any, Protocol

from algorithms.common.errors import MapMergeError
from app.drawing.draw_items import Item
from app.drawing.scene_layout import SceneLayout
from app.jobs.job_thread import JobThread
from app.model.merge_inputs import MergeInputs
from app.model.run_state import RunState
from app.page.host import RunHost
from app.page.page_snapshot import PageSnapshot


class Host(RunHost, Protocol):
    """A page with a lesson."""

    session: JobThread

    @property
    def layout(self) -> SceneLayout:
        """Where it lies in the scene."""

    def present(
        self, story: RunState, says: str, ink: list[Item], turn: float | None, look: bool, busy: bool
    ) -> None:
        """Show a run, as far as a story goes, on the map."""

    def entered(self, open_: bool) -> None:
        """The lesson was opened or closed."""

    def came_back(self) -> None:
        """Show again what there was before the lesson."""

    def method_shown(self, method: str) -> None:
        """The lesson has chosen a method."""

    def report(self, error: MapMergeError) -> None:
        """Tell the person what is wrong."""


class Hall(Protocol):
    """A page with a museum."""

    @property
    def desk(self) -> PageSnapshot | None:
        """What is on the page."""

    def hang(self, inputs: MergeInputs, method: str, config: Any, label: str) -> None:
        """Put these maps and settings on the page, without merging them."""

    def treat(self, method: str, config: Any) -> None:
        """Take these settings, and merge."""

    def museum_left(self, desk: PageSnapshot | None) -> None:
        """Put back what was on the page before."""

    def museum_entered(self, open_: bool) -> None:
        """The museum was opened or closed."""

    def report(self, error: MapMergeError) -> None:
        """Tell the person what is wrong."""
