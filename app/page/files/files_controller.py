"""What is done with samples and files: they become the pair on the page, a fleet, or a part of a sighting."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from threading import Lock

import viser

from algorithms.common.errors import InputFileError, MapMergeError
from algorithms.files.case_folder import read_case
from algorithms.files.fleet_archive import MOST_FILES
from algorithms.files.fleet_file import read_fleet
from algorithms.files.map_file import read_map
from app.model.files.file_kinds import is_project
from app.model.files.file_reader import FileReader, OpenedFiles, upload_at
from app.model.files.file_roles import swapped, with_other
from app.model.merge_inputs import Files, MergeInputs, Upload
from app.page.files.files_html import rows_of
from app.page.files.files_panel import SUFFIXES
from app.page.fleet.fleet_controller import FleetController
from app.page.fleet.fleet_panel import NO_SAMPLE
from app.page.fleet.sample_robots import sample_robots
from app.page.panels.html_widgets import on_choice, put
from app.page.project.project_controller import ProjectController
from app.page.tab import Tab
from app.system import data_paths as paths
from app.system.cancellation import Cancelled, Check, never_cancelled
from app.web.browser_events import Numbers
from app.web.upload import MAX_UPLOADS

BY_ITSELF = "open it by itself"
DAY, LAST_DAY = 86_400.0, 1_000_000.0  # seconds; days since 1970, the year 4700
MOST_DATES = 200  # of files that are sent at once; more make too long a message
LARGE = 1_000_000  # bytes, or pixels of a PNG; to read less takes no time to speak of
Load = Callable[[MergeInputs, str], None]


class FilesController:
    """Of one tab.

    load     : shows a pair of maps, as an action of the person that is called so
    fleet    : takes fleets, and robots of the one that is shown
    sighting : takes a file of the sighting from camera and scan
    projects : takes a project
    """

    def __init__(
        self,
        tab: Tab,
        load: Load,
        fleet: FleetController,
        sighting: Callable[[Upload], None],
        projects: ProjectController,
    ) -> None:
        self._state, self._panel, self._task = tab.state, tab.panels.files, tab.panels.task
        self._locks, self._notices = tab.state.locks, tab.notices
        self._load, self._fleet, self._sighting, self._projects = load, fleet, sighting, projects
        self._reader = FileReader()
        self._arrived: list[Upload | None] = []  # None: there was no room for it
        self._lock = Lock()
        self._panel.connect(self.take_sample, self._gather, self._use_form, self._forget)
        self._robots = tab.panels.fleet.sample
        on_choice(self._robots, self._take_sample_robot)
        dates = Numbers(0, MOST_DATES)
        tab.events.on("sent", self._sent, button=str, count=int, whole=bool, days=dates)
        does = ("remove", "map1", "map2", "use", "swap")
        tab.events.on("file", self._change, what=does, n=int)
        tab.state.subscribe("setup", lambda: self._panel.name(self._state.inputs.names))
        tab.display.messages.hud(open={"button": self._panel.button, "suffixes": list(SUFFIXES)})

    # --- files come ---------------------------------------------------------------------------------

    def _gather(self, file: viser.UploadedFile) -> None:
        """A file has arrived; more of the same choice may follow. Called in viser's loop."""
        with self._lock:
            size = sum(len(upload.content) for upload in self._arrived if upload is not None)
            room = size + len(file.content) <= MAX_UPLOADS and len(self._arrived) < MOST_FILES
            if len(self._arrived) <= MOST_FILES:
                self._arrived.append(upload_at(file.name, file.content) if room else None)

    def _sent(self, button: str, count: int, whole: bool, days: list[float]) -> None:
        """All that was chosen at once has been sent, of which so many files arrived; not ``whole``: it was
        left.

        days : since 1970, when each was last written; empty where there are too many
        """
        if button != self._panel.button:
            return
        with self._lock:
            count = max(0, count) if whole else len(self._arrived)
            taken, self._arrived = self._arrived[:count], self._arrived[count:]
        if len(days) == len(taken):
            dates = [day * DAY if 0 < day < LAST_DAY else None for day in days]
            taken = [one and replace(one, modified=date) for one, date in zip(taken, dates, strict=True)]
        uploads = [upload for upload in taken if upload is not None]
        if whole and uploads:
            self.open(uploads)
        if whole and len(uploads) < len(taken):
            found = f"hold more than {MAX_UPLOADS // 10**6} MB, or are more than {MOST_FILES:,}"
            self._notices.report(InputFileError("These files", found, "open fewer at once"))

    def open(self, uploads: Sequence[Upload]) -> None:
        """Take these files, given at once, for what they are."""
        project = next((each for each in uploads if is_project(each.name, each.content)), None)
        if project is not None:
            self._open_project(project, alone=len(uploads) == 1)
            return
        with self._locks.action:
            shown = self._fleet.shown is not None

            def read(check: Check) -> OpenedFiles:
                return self._reader.open(self._panel.files, uploads, self._state.inputs, shown, check)

            self._show(uploads, read, f"load {_name_of(uploads)}")

    def _open_project(self, upload: Upload, alone: bool) -> None:
        """Go on with a project."""
        try:
            if not alone:
                raise InputFileError(upload.name, "is a project, and other files came with it", BY_ITSELF)
            with self._locks.action, self._reading([upload]) as check:
                project = self._projects.read(upload, check)
        except Cancelled:
            return
        except MapMergeError as error:
            self._notices.report(error)
            return
        self._projects.open(project)

    # --- what a person does with them ---------------------------------------------------------------

    def _use_form(self, number: int, made: Upload) -> None:
        """What was filled in for the image of a map is used as its YAML file."""
        files = self._panel.files
        self._show_pair(replace(files, uploads={**files.uploads, f"yaml{number}": made}), f"load {made.name}")

    def _change(self, what: str, n: int) -> None:
        """A button in the list was pressed, in the line of this number of those that have buttons."""
        with self._locks.action:
            files = self._panel.files
            if what == "swap":
                self._show_pair(swapped(files), "swap the maps")
                return
            rows = [row for row in rows_of(files) if row.does]
            if not 0 <= n < len(rows) or what not in rows[n].does:
                return
            row = rows[n]
            if what != "remove" and isinstance(row.at, int):
                self._show_pair(with_other(files, row.at, 2 if what == "map2" else 1), f"load {row.name}")
                return
            left = {key: upload for key, upload in files.uploads.items() if key != row.at}
            if row.at in ("image1", "image2") and (text := left.get(f"yaml{row.at[-1]}")) and text.by_form:
                del left[f"yaml{row.at[-1]}"]
            others = tuple(other for k, other in enumerate(files.others) if k != row.at)
            self._show_pair(Files(files.sample, left, others), f"remove {row.name}")

    def _forget(self) -> None:
        with self._locks.action:
            self._show_pair(Files(self._panel.files.sample), "forget the files")

    def take_sample(self, name: str) -> None:
        """Show a sample in place of what is on the page; nothing where there is none of that name."""
        with self._locks.action:
            before = self._panel.files
            pair, fleet = paths.samples().get(name), paths.fleets().get(name)
            if (pair is None and fleet is None) or name == self._state.files.sample:
                return
            try:
                case = None if pair is None else read_case(pair)
                robots = None if fleet is None else read_fleet(fleet)
            except MapMergeError as error:
                self._panel.show(before)
                self._notices.report(error)
                return
            self._panel.show(Files(name))
            if robots is not None:
                self._fleet.load(robots, name)
            elif case is not None:
                self._load(MergeInputs.of(case), "")

    def _take_sample_robot(self) -> None:
        menu = self._robots
        name, path = menu.value, sample_robots().get(menu.value)
        if path is None:
            return
        put(menu, value=NO_SAMPLE)  # it can be chosen again
        with self._locks.action:
            try:
                self._fleet.add_robots([(name.replace(", ", "_"), read_map(path))])
            except MapMergeError as error:
                self._notices.report(error)

    # --- what comes of it ---------------------------------------------------------------------------

    def _show_pair(self, files: Files, label: str) -> None:
        """Show the pair that these files make up, where they are others."""
        with self._locks.action:
            before = self._panel.files
            if files.uploads == before.uploads and files.sample == before.sample:
                self._panel.show(files)
                self._state.update(files=files)
                return

            def read(check: Check) -> OpenedFiles:
                return self._reader.pair_of(files, self._state.inputs, check)

            self._show(list(files.uploads.values()), read, label)

    def _show(self, uploads: Sequence[Upload], read: Callable[[Check], OpenedFiles], label: str) -> None:
        """Read, and show what has come of it; what cannot be used is told, what was left leaves no trace."""
        try:
            with self._reading(uploads) as check:
                opened = read(check)
        except Cancelled:
            return
        except MapMergeError as error:
            self._notices.report(error)
            return
        before = self._state.files
        self._panel.show(opened.files, opened.greys)
        if opened.fleet is not None:
            name, fleet = opened.fleet
            self._fleet.load(fleet, name)
        elif opened.inputs is not None:
            self._load(opened.inputs, label)
        else:
            self._state.update(files=opened.files)
            if opened.robots:
                self._fleet.add_robots(opened.robots)
        if self._state.files is not opened.files:  # it was too large
            self._panel.show(before)
        for upload in opened.sighting:
            self._sighting(upload)
        if opened.errors:
            self._notices.report(opened.errors[0])

    @contextmanager
    def _reading(self, uploads: Sequence[Upload]) -> Iterator[Check]:
        """Say that files are read where that takes a while; it can be left then."""
        new = [upload for upload in uploads if upload not in self._panel.files.uploads.values()]
        large = [upload for upload in new if _large(upload)]
        if not large:
            yield never_cancelled
            return
        size = sum(len(upload.content) for upload in new) / 1e6
        more = f" and {len(new) - 1} more" if len(new) > 1 else ""
        with self._task(f"Reading {large[0].name}{more}, {size:.3g} MB.") as check:
            yield check


def _name_of(uploads: Sequence[Upload]) -> str:
    """What files that were given at once are called: by the folder of all of them, else by the first."""
    (folder, *others) = {upload.folder.split("/")[0] for upload in uploads}
    if folder and not others:
        return folder
    return uploads[0].name + (f" and {len(uploads) - 1} more" if uploads[1:] else "")


def _large(upload: Upload) -> bool:
    """Whether it takes a while to read. A PNG may be much larger than its file."""
    wide, high = (int.from_bytes(upload.content[k : k + 4], "big") for k in (16, 20))
    pixels = wide * high if upload.content.startswith(b"\x89PNG") else 0
    return max(len(upload.content), pixels) >= LARGE
