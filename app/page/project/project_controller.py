"""*Save project*, and a project that is opened: all that was done, in a file."""

from __future__ import annotations

from app.model.merge_inputs import Upload
from app.page.cancellable_task import DownloadTask
from app.page.project.project_file import project_from_bytes, project_name, project_to_bytes
from app.page.tab import Tab
from app.page.undo.undo_controller import UndoController
from app.page.undo.undo_history import SavedTab
from app.system.cancellation import Check


class ProjectController:
    """Of one tab; ``deliver``: sends a file, once it is made."""

    def __init__(self, tab: Tab, undo: UndoController, deliver: DownloadTask) -> None:
        self._state, self._history, self._notices = tab.state, tab.history, tab.notices
        self._undo, self._deliver = undo, deliver
        tab.panels.export.connect_project(self._save)

    def read(self, upload: Upload, check: Check) -> SavedTab:
        """What a project holds; raises InputFileError, TooLargeError."""
        return project_from_bytes(upload.name, upload.content, check)

    def open(self, project: SavedTab) -> None:
        """Go on where the project was; to undo its first step leads back to what was here before."""
        with self._state.locks.action:
            self._history.append(project.steps, project.position)
            self._undo.restore_current()

    def _save(self) -> None:
        with self._state.locks.action:
            saved = SavedTab(self._history.steps, self._history.position)
            fleet, inputs = self._state.fleet, self._state.inputs
        if saved.steps:
            name = project_name(inputs.title if fleet is None else fleet.name)
            self._deliver("Making the project's file.", name, lambda check: project_to_bytes(saved, check))
