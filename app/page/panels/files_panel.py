"""Folder "Maps": samples and uploads."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from html import escape
from pathlib import PurePath
from threading import RLock

import viser

from algorithms.common.errors import MapMergeError
from algorithms.common.source_file import SourceFile
from algorithms.files.case_folder import read_case
from algorithms.files.fleet_archive import fleet_from_zip
from algorithms.files.fleet_file import read_fleet
from algorithms.files.map_file import READABLE_SUFFIXES, map_from_bytes, parse_meta
from algorithms.files.observation_file import known_from_bytes
from algorithms.maps.grid_map import GridMap
from algorithms.observations.fleet import Fleet
from app.drawing.palette import QUIET
from app.model.merge_inputs import Files, MapSlot, MergeInputs, Upload
from app.page.cancellable_task import CancellableTask
from app.page.panels.html_widgets import Action, on_press, put
from app.page.panels.image_form import ImageForm
from app.page.panels.uploaded_file import short_name, taken_from, upload_of
from app.system import data_paths as paths
from app.system.cancellation import CancellableReader, Cancelled, Check, never_cancelled

NONE = "(choose)"
# key -> label of the button, what the picker offers
SLOTS = {
    "yaml1": ("Map 1: YAML", ".yaml,.yml"),
    "image1": ("Map 1: image", ",".join(READABLE_SUFFIXES)),
    "yaml2": ("Map 2: YAML", ".yaml,.yml"),
    "image2": ("Map 2: image", ",".join(READABLE_SUFFIXES)),
    "observation": ("What is known: YAML", ".yaml,.yml"),
}

NO_YAML = (
    "Map {}'s image has no YAML file yet: load it, or fill in the form below the image and press “Use this "
    "map”."
)
LARGE = 1_000_000  # bytes; to read less takes no time to speak of


Known = dict[tuple[Upload, Upload], GridMap]


def _large(upload: Upload) -> bool:
    """Whether it takes a while to read. A PNG may be much larger than its file; a map's YAML file is read
    with its image.
    """
    wide, high = (int.from_bytes(upload.content[k : k + 4], "big") for k in (16, 20))
    pixels = wide * high if upload.content.startswith(b"\x89PNG") else 0
    return max(len(upload.content), pixels) >= LARGE


def inputs_from(
    uploads: dict[str, Upload], known: Known | None = None, check: Check = never_cancelled
) -> MergeInputs:
    """What the files so far make up: a map where both its files are there, observations.

    known  : maps that were read before, by their two files; holds these in the end
    check  : is called now and then, and may leave the work by raising
    raises : MapMergeError that names the file, the finding and the remedy
    """
    known = {} if known is None else known
    now: Known = {}

    def read(number: int) -> MapSlot:
        text, image = uploads.get(f"yaml{number}"), uploads.get(f"image{number}")
        if text is None:
            return MapSlot(missing=NO_YAML.format(number) if image is not None else "")
        named = short_name(
            parse_meta(text.name, text.content).image
        )  # what is wrong with it is reported at once
        if image is None:
            return MapSlot(missing=f"Map {number}'s YAML file is here. Load its image, too: {named}.")
        grid = known.get((text, image))
        if grid is None:
            content = CancellableReader(image.content, check)
            grid = map_from_bytes(text.name, text.content, image.name, content)
        now[text, image] = grid
        if named == image.name or text.by_form:
            return MapSlot(grid)
        doubt = f"{text.name} names the image {named}; loaded is {image.name}. Do they belong together?"
        return MapSlot(grid, doubt=doubt)

    inputs = MergeInputs(tuple(map(read, (1, 2))), name="your files" if uploads else "")
    if seen := uploads.get("observation"):
        told = inputs.knowing(known_from_bytes(seen.name, seen.content))
        inputs = told.read_from(SourceFile.of(seen.name, seen.content))
    known.clear()  # of what is not there any more
    known.update(now)
    return inputs


class FilesPanel:
    """Chooses what is merged.

    save   : sends a file to the person
    action : held while an action of the person is carried out
    task   : says what is being done, where it takes a while, and lets it be left
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        chosen: str,
        save: Callable[[str, bytes], None],
        action: RLock,
        task: CancellableTask,
    ) -> None:
        self._uploads: dict[str, Upload] = {}
        self._known: Known = {}
        self._placed = False
        # viser calls back from a thread of its own for each file: two that were dropped together must
        # not be read, and shown, across each other
        self._action, self._task = action, task
        samples = {**paths.samples(), **paths.fleets()}
        names = [chosen] if chosen and chosen not in samples else []
        with gui.add_folder("Maps", order=10.0):
            start, hint = chosen or NONE, "A pair that came along."
            options = (NONE, *names, *samples)
            self._sample = gui.add_dropdown("Sample", options, initial_value=start, hint=hint)
            self._sample.on_update(lambda _: self._take_sample())
            self._forms: dict[int, ImageForm] = {}
            with gui.add_folder("Upload your own", expand_by_default=False):
                self._status = gui.add_html(self._table())
                for key, (label, kinds) in SLOTS.items():
                    button = gui.add_upload_button(label, mime_type=kinds, color=QUIET)
                    button.on_upload(partial(self._arrived, key))
                    if key.startswith("image"):
                        number = int(key[-1])
                        use = partial(self._take, f"yaml{number}")
                        self._forms[number] = ImageForm(gui, number, self._action, use, save)
                hint = "fleet.yaml and the maps that it names: three robots or more."
                self._fleet = gui.add_upload_button("Fleet: zip", mime_type=".zip", color=QUIET, hint=hint)
                self._fleet.on_upload(self._fleet_arrived)
                self._forget_them = gui.add_button("Forget uploads", color=QUIET, visible=False)
                self._forget_them.on_click(lambda _: self._forget())
            hint = "A third robot, and a fourth: all of them become one map."
            icon = viser.Icon.PLUS
            self._more = gui.add_button("Add robots", hint=hint, icon=icon, color=QUIET, visible=False)
        self._taken = chosen or NONE

    def connect(self, load: Callable[[MergeInputs], None], report: Callable[[MapMergeError], None]) -> None:
        """What is done with the inputs that were chosen, and where a file cannot be used."""
        self._load, self._report = load, report

    def connect_fleet(self, load: Callable[[Fleet, str], None], more: Action) -> None:
        """What is done with a fleet that was chosen, and where two maps are to become one."""
        self._load_fleet = load
        on_press((self._more, more))

    def extendable(self, yes: bool) -> None:
        """Whether there are two maps that can become a fleet."""
        put(self._more, visible=yes)

    @property
    def files(self) -> Files:
        """Where what is on the page came from."""
        return Files("" if self._taken == NONE else self._taken, dict(self._uploads))

    def restore(self, files: Files) -> None:
        """Show again where inputs came from, and load nothing."""
        with self._action:
            self._uploads = dict(files.uploads)
            self._offer_forms()
            self._tell()
            self._taken = files.sample or NONE
            put(self._sample, value=self._taken)

    def placed(self, yes: bool) -> None:
        """Whether there is an observation, wherever it came from."""
        if self._placed != yes:
            self._placed = yes
            self._tell()

    def _take_sample(self) -> None:
        with self._action:
            name = self._sample.value
            pair, fleet = paths.samples().get(name), paths.fleets().get(name)
            if (pair is None and fleet is None) or name == self._taken:
                return
            try:
                case = None if pair is None else read_case(pair)
                robots = None if fleet is None else read_fleet(fleet)
            except MapMergeError as error:
                self._sample.value = self._taken
                self._report(error)
                return
            self._forget_uploads(name)
            if robots is not None:
                self._load_fleet(robots, name)
            elif case is not None:
                self._load(MergeInputs.of(case))

    def _forget_uploads(self, name: str) -> None:
        """What is on the page comes from elsewhere now: from a sample of that name."""
        self._taken = name
        self._uploads.clear()
        self._offer_forms()
        self._tell()

    def _fleet_arrived(self, event: viser.GuiEvent[viser.GuiUploadButtonHandle]) -> None:
        file = taken_from(event)
        if file is None:
            return
        with self._action:
            upload = upload_of(file, "fleet.zip")
            try:
                with self._task(f"Reading {upload.name}, {len(upload.content) / 1e6:.3g} MB.") as check:
                    fleet = fleet_from_zip(upload.name, upload.content)
                    check()
            except (Cancelled, MapMergeError) as error:
                if isinstance(error, MapMergeError):
                    self._report(error)
                return
            self._forget_uploads(NONE)
            put(self._sample, value=NONE)
            self._load_fleet(fleet, PurePath(upload.name).stem)

    def _arrived(self, key: str, event: viser.GuiEvent[viser.GuiUploadButtonHandle]) -> None:
        file = taken_from(event)
        if file is not None:
            self._take_upload(key, file)

    def _take_upload(self, key: str, file: viser.UploadedFile) -> None:
        self._take(key, upload_of(file, key))

    def _take(self, key: str, upload: Upload) -> None:
        with self._action:
            before = dict(self._uploads)
            self._uploads[key] = upload
            text = self._uploads.get(key.replace("image", "yaml"))
            if key.startswith("image") and text is not None and text.by_form:
                del self._uploads[key.replace("image", "yaml")]  # it was filled in for another image
            try:
                inputs = self._read(upload)
            except (Cancelled, MapMergeError) as error:
                self._uploads = before  # and what is on the page stays there
                self._offer_forms()
                if isinstance(error, MapMergeError):
                    self._tell(key)
                    self._report(error)
                return
            self._show(inputs)

    def _read(self, upload: Upload) -> MergeInputs:
        """What the files make up now that this one has come; raises Cancelled where Stop was pressed."""
        if not _large(upload):
            self._offer_forms()
            return inputs_from(self._uploads, self._known)
        with self._task(f"Reading {upload.name}, {len(upload.content) / 1e6:.3g} MB.") as check:
            self._offer_forms(check)
            return inputs_from(self._uploads, self._known, check)

    def _offer_forms(self, check: Check = never_cancelled) -> None:
        """A form for every image that came without a YAML file; raises MapMergeError as ``inputs_from``."""
        for number, form in self._forms.items():
            form.show(self._uploads.get(f"image{number}"), self._uploads.get(f"yaml{number}"), check)

    def _forget(self) -> None:
        with self._action:
            self._uploads.clear()
            self._offer_forms()
            self._show(MergeInputs())

    def _show(self, inputs: MergeInputs) -> None:
        """What was on the page gives way to the uploads: nobody merges other maps than they think."""
        self._tell()
        self._taken = NONE
        put(self._sample, value=NONE)
        self._load(inputs)

    def _tell(self, bad: str = "") -> None:
        """Show which files are there; bad: the one that cannot be used."""
        self._status.content = self._table(bad)
        put(self._forget_them, visible=bool(self._uploads))

    def _table(self, bad: str = "") -> str:
        rows = []
        for key, (label, _) in SLOTS.items():
            upload = self._uploads.get(key)
            sign, colour, name = "·", "#9CA3AF", "missing"
            if key == bad:
                sign, colour, name = "✗", "#D55E00", "cannot be used"
            elif upload is not None:
                name = "filled in below" if upload.by_form else escape(upload.name)
                sign, colour = "✓", "#009E73"
            elif key == "observation" and self._placed and self._uploads:
                sign, colour, name = "✓", "#009E73", "placed by hand"
            rows.append(
                f'<tr><td style="color:{colour};width:1.2em">{sign}</td>'
                f"<td>{label}</td><td style='opacity:.75;overflow-wrap:anywhere'>{name}</td></tr>"
            )
        return f'<table style="font-size:12px;margin:2px 10px 6px;width:92%">{"".join(rows)}</table>'
