"""A robot that is added to a fleet: its map's two files, in whatever order they come."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PurePath
from threading import RLock
from typing import Any

import viser

from algorithms.common.errors import MapMergeError
from algorithms.files.map_file import map_from_bytes, read_map
from algorithms.maps.grid_map import GridMap
from app.model.merge_inputs import Upload
from app.page.cancellable_task import CancellableTask
from app.page.fleet.fleet_panel import NO_SAMPLE, FleetPanel
from app.page.fleet.sample_robots import sample_robots
from app.page.panels.html_widgets import on_choice, put
from app.page.panels.uploaded_file import taken_from, upload_of
from app.system.cancellation import CancellableReader, Cancelled

MISSING = {"yaml": "Now load its image, too.", "image": "Now load its YAML file, too."}


class RobotFiles:
    """Of one tab.

    action : held while an action of the person is carried out
    task   : says what is being read, and lets it be left
    add    : is given the robot's name and its map
    """

    def __init__(
        self,
        panel: FleetPanel,
        action: RLock,
        task: CancellableTask,
        add: Callable[[str, GridMap], None],
        report: Callable[[MapMergeError], None],
    ) -> None:
        self._panel, self._action, self._task, self._add, self._report = panel, action, task, add, report
        self._files: dict[str, Upload] = {}
        panel.yaml.on_upload(lambda event: self._arrived("yaml", event))
        panel.image.on_upload(lambda event: self._arrived("image", event))
        on_choice(panel.sample, self._sample_chosen)

    def _sample_chosen(self) -> None:
        name = self._panel.sample.value
        path = sample_robots().get(name)
        if path is None:
            return
        put(self._panel.sample, value=NO_SAMPLE)  # it can be chosen again
        with self._action:
            try:
                grid = read_map(path)
            except MapMergeError as error:
                self._report(error)
                return
            self._add(name.replace(", ", "_"), grid)

    def _arrived(self, kind: str, event: viser.GuiEvent[Any]) -> None:
        file = taken_from(event)
        if file is None:
            return
        with self._action:
            self._files[kind] = upload_of(file, kind)
            text, image = self._files.get("yaml"), self._files.get("image")
            if text is None or image is None:
                self._panel.waiting(MISSING[kind])
                return
            self._files.clear()
            self._panel.waiting("")
            try:
                with self._task(f"Reading {image.name}.") as check:
                    content = CancellableReader(image.content, check)
                    grid = map_from_bytes(text.name, text.content, image.name, content)
            except Cancelled:
                return
            except MapMergeError as error:
                self._report(error)
                return
            self._add(PurePath(text.name).stem, grid)
