"""Folder "Maps": samples, and files of one's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from threading import RLock
from typing import Any

import viser

from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.files.map_file import READABLE_SUFFIXES, YAML_SUFFIXES, GreyImage
from app.drawing.palette import QUIET
from app.model.files.file_kinds import PROJECT_SUFFIX
from app.model.merge_inputs import Files, Upload
from app.page.files.files_html import files_html
from app.page.files.image_form import ImageForm
from app.page.panels.html_widgets import Action, on_choice, on_press, put
from app.page.panels.uploaded_file import taken_from
from app.system import data_paths as paths

NONE = "(choose)"
OF_CAMERAS = (".jpg", ".jpeg", ".webp", ".csv", ".txt", ".npz")
OF_BAGS = (".bag", ".db3", ".mcap")
SUFFIXES = (*YAML_SUFFIXES, *READABLE_SUFFIXES, ".zip", PROJECT_SUFFIX, *OF_BAGS, *OF_CAMERAS)
"""What the names of files end in that are offered, and taken from folders."""


class FilesPanel:
    """Widgets. ``save`` sends a file to the person, ``action`` is held while one of their actions is done."""

    def __init__(
        self, gui: viser.GuiApi, chosen: str, save: Callable[[str, bytes], None], action: RLock
    ) -> None:
        self.files = Files(chosen)
        """What is shown: where what is on the page came from."""
        self._names = UNNAMED
        self._use: Callable[[int, Upload], None] = lambda number, made: None
        samples = {**paths.samples(), **paths.fleets()}
        names = [chosen] if chosen and chosen not in samples else []
        with gui.add_folder("Maps", order=10.0):
            options = (NONE, *names, *samples)
            hint = "Pairs and fleets that came along."
            self._sample = gui.add_dropdown("Sample", options, initial_value=chosen or NONE, hint=hint)
            kinds, icon = ",".join(SUFFIXES), viser.Icon.UPLOAD
            hint = "All at once or one after another; each is known by what it holds."
            self._open = gui.add_upload_button(
                "Open files…", mime_type=kinds, color=QUIET, hint=hint, icon=icon
            )
            self._list = gui.add_html(files_html(self.files, self._names))
            self._forms = {
                number: ImageForm(gui, number, action, partial(self._made, number), save) for number in (1, 2)
            }
            self._forget = gui.add_button("Forget these files", color=QUIET, visible=False)
            hint = "A third robot, and a fourth: all of them become one map."
            icon = viser.Icon.PLUS
            self._more = gui.add_button("Add robots", hint=hint, icon=icon, color=QUIET, visible=False)

    def connect(
        self,
        sample: Callable[[str], None],
        arrived: Callable[[viser.UploadedFile], None],
        use: Callable[[int, Upload], None],
        forget: Action,
    ) -> None:
        """What is done with the sample that is chosen, a file that came, in viser's loop, and the YAML file
        that was filled in for the image of a map.
        """
        self._use = use

        async def take(event: viser.GuiEvent[Any]) -> None:  # before the next one takes its place
            file = taken_from(event)
            if file is not None:
                arrived(file)

        self._open.on_upload(take)
        on_choice(self._sample, lambda: sample(self._sample.value))
        on_press((self._forget, forget))

    def connect_fleet(self, more: Action) -> None:
        """What is done where two maps are to become a fleet."""
        on_press((self._more, more))

    @property
    def button(self) -> str:
        """The id of the button, by which files come."""
        return str(self._open._impl.uuid)

    def extendable(self, yes: bool) -> None:
        """Whether there are two maps that can become a fleet."""
        put(self._more, visible=yes)

    def name(self, names: RobotNames) -> None:
        """What the robots are called."""
        if names != self._names:
            self._names = names
            put(self._list, content=files_html(self.files, names))

    def show(self, files: Files, greys: Mapping[Upload, GreyImage] | None = None) -> None:
        """Show where inputs came from, and load nothing; ``greys``: images that have been decoded."""
        self.files = files
        for number, form in self._forms.items():
            image, text = files.uploads.get(f"image{number}"), files.uploads.get(f"yaml{number}")
            form.show(image, text, None if image is None else (greys or {}).get(image))
        there = files.sample in self._sample.options  # a project may name what another mapmeld has
        put(self._sample, value=files.sample if there else NONE)
        put(self._list, content=files_html(files, self._names))
        put(self._forget, visible=bool(files.uploads or files.others))

    def _made(self, number: int, made: Upload) -> None:
        self._use(number, made)
