"""Folder "From camera and scan": what robot 1 saw, where both robots stood, how it is looked at."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from math import degrees, radians
from typing import Any

import viser

from algorithms.common.robot_names import RobotNames
from algorithms.detection.footprint import SIZES, Footprint
from algorithms.detection.svm_detector import LEAST_PROBABILITY
from algorithms.detection.tag_detector import FAMILIES, TAG_SIZES
from algorithms.maps.grid_map import FARTHEST
from app.drawing.palette import LIGHT, QUIET, STOP
from app.model.files.file_reader import upload_at
from app.model.merge_inputs import Upload
from app.model.observation_draft import ObservationDraft
from app.model.sighting.look_settings import Finder, LookSettings
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put
from app.page.panels.uploaded_file import taken_from

FINDERS: dict[str, Finder] = {
    "The trained one": "trained",
    "My own, uploaded": "own",
    "Tags (AprilTag, ArUco)": "tags",
}
BOXY, ROUND = "boxy", "round"
SHAPE, USE_MAP = "robot 2 is", "use map 1"
KINDS = ".jpg,.jpeg,.png,.bmp,.webp,.ppm,.pgm,.yaml,.yml,.csv,.npz"
INTRO = (
    "Robot 1's image, camera and laser scan of one moment: the detector finds robot 2, the laser measures it."
)
# number -> label, hint; of observation_panel's FIELDS those that no sensor tells
PLACES = {
    "x1": ("robot 1, x (m)", "In map 1."),
    "y1": ("robot 1, y (m)", "In map 1."),
    "turn1": ("robot 1, heading (°)", "Counter-clockwise from map 1's x axis."),
    "x2": ("robot 2, x (m)", "In map 2."),
    "y2": ("robot 2, y (m)", "In map 2."),
}
SMALL = "margin:2px 12px 6px;font-size:12px;line-height:1.45;opacity:.85"


class SensorsPanel:
    """Widgets; they know nothing of robots. sighting.js lets files be dropped on its table."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._gui = gui
        title = "From camera and scan"
        with gui.add_folder(title, order=25.0, expand_by_default=False, visible=False) as self._folder:
            self._intro = gui.add_html("")
            self._table = gui.add_html("")
            hint = "One or several; each is known by what it holds."
            icon = viser.Icon.UPLOAD
            self._files = gui.add_upload_button(
                "Choose files", mime_type=KINDS, color=QUIET, hint=hint, icon=icon
            )
            hint = "The image, the scan and the robots' places that ship with this sample."
            icon = viser.Icon.PHOTO
            self._sample = gui.add_button("From the sample", color=QUIET, hint=hint, icon=icon, visible=False)
            hint = "Each line of encounters.csv is a time at which robot 1 saw robot 2."
            self._row = gui.add_dropdown("Encounter", ("1",), hint=hint, visible=False)
            self._fault = gui.add_html("", visible=False)
            hint = "Of a camera without a calibration, horizontally; bearings are then counted in pixels."
            view: Any = {"min": 0.0, "max": 179.0, "step": 0.1, "hint": hint}
            self._view = gui.add_number("field of view (°)", 0.0, **view)
            self._where = gui.add_html("")
            with gui.add_folder("Where the robots stood", expand_by_default=False):
                self._places = {
                    name: self._place(label, hint, name) for name, (label, hint) in PLACES.items()
                }
            with gui.add_folder("Detector and robot", expand_by_default=False):
                self._add_settings(gui)
            icon = viser.Icon.EYE
            self._look = gui.add_button("Look", color=LIGHT.ref, icon=icon, disabled=True)
            icon = viser.Icon.PLAYER_STOP
            self._stop = gui.add_button("Stop looking", color=STOP, icon=icon, visible=False)
            self._show = gui.add_button("Show what was seen", color=QUIET, visible=False)
            self._forget = gui.add_button("Forget these files", color=QUIET, visible=False)

    def _place(self, label: str, hint: str, name: str) -> Any:
        far, step = (360.0, 0.1) if name == "turn1" else (FARTHEST, 0.01)
        return self._gui.add_number(label, 0.0, min=-far, max=far, step=step, hint=hint)

    def _add_settings(self, gui: viser.GuiApi) -> None:
        hint = "The trained one finds robots with paper boards, on which it was trained."
        self._finder = gui.add_dropdown("detector", tuple(FINDERS), hint=hint)
        hint = "Boxes of less are not looked at."
        least: Any = {"min": 0.05, "max": 0.95, "step": 0.05, "hint": hint}
        self._least = gui.add_slider("least probability", initial_value=LEAST_PROBABILITY, **least)
        hint = "Which tags the robots carry."
        self._family = gui.add_dropdown("tag family", tuple(FAMILIES), hint=hint, visible=False)
        hint = "Side of the black square. With it no scan is needed; 0 where it is not known."
        side: Any = {"min": 0.0, "max": TAG_SIZES[1], "step": 0.001, "hint": hint}
        self._tag_size = gui.add_number("tag size (m)", 0.0, visible=False, **side)
        usual, (low, high) = Footprint(), SIZES
        self._shape = gui.add_dropdown(SHAPE, (BOXY, ROUND), hint="Its outline, as the laser meets it.")
        size: Any = {"min": low, "max": high, "step": 0.01}
        self._length = gui.add_number("length (m)", usual.length, **size)
        self._width = gui.add_number("width (m)", usual.width, **size)
        size = {"min": low / 2, "max": high / 2, "step": 0.005, "visible": False}
        self._radius = gui.add_number("radius (m)", 0.2, **size)
        hint = "What map 1 shows as wall is no robot, and nothing behind a wall is."
        self._use_map = gui.add_checkbox(USE_MAP, True, hint=hint)

    def connect(
        self, take: Callable[[Upload], None], sample: Action, row: Callable[[int], None], forget: Action
    ) -> None:
        """What is done with a file that came, in viser's loop, and where a person wants others.

        row : another line of the encounters, from 0
        """

        async def arrived(event: viser.GuiEvent[Any]) -> None:  # before the next one takes its place
            file = taken_from(event)
            if file is not None:
                take(upload_at(file.name, file.content))

        self._files.on_upload(arrived)
        on_press((self._sample, sample), (self._forget, forget))
        on_choice(self._row, lambda: row(int(self._row.value) - 1))

    def connect_look(
        self,
        typed: Callable[[str, float], None],
        changed: Action,
        look: Action,
        stop: Action,
        show: Action,
    ) -> None:
        """What is done where a person says where the robots stood, how to look, and looks.

        typed : one of PLACES; metres, radians; called in viser's loop
        """
        for name, handle in self._places.items():

            async def read(event: viser.GuiEvent[Any], name: str = name) -> None:  # before it is overwritten
                if event.client_id is not None:  # not set from here
                    value = float(event.target.value)
                    typed(name, radians(value) if name == "turn1" else value)

            handle.on_update(read)
        for handle in self._settings_widgets:
            on_choice(handle, changed)
        on_press((self._look, look), (self._stop, stop), (self._show, show))

    @property
    def _settings_widgets(self) -> tuple[Any, ...]:
        size = self._shape, self._length, self._width, self._radius
        return (self._finder, self._least, self._family, self._tag_size, *size, self._use_map, self._view)

    @property
    def settings(self) -> LookSettings:
        """As the widgets stand."""
        if self._shape.value == ROUND:
            body = Footprint.disc(round(float(self._radius.value), 4))
        else:
            body = Footprint(round(float(self._length.value), 4), round(float(self._width.value), 4))
        return LookSettings(
            FINDERS[self._finder.value],
            round(float(self._least.value), 4),
            self._family.value,
            round(float(self._tag_size.value), 4),
            body,
            bool(self._use_map.value),
            radians(float(self._view.value)),
        )

    def take_settings(self, look: LookSettings) -> None:
        """Set the widgets as they stood."""
        body = look.body
        put(self._finder, value=next(name for name, finder in FINDERS.items() if finder == look.finder))
        put(self._least, value=look.least_probability)
        put(self._family, value=look.family)
        put(self._tag_size, value=look.tag_size)
        put(self._shape, value=ROUND if body.round else BOXY)
        if body.round:
            put(self._radius, value=body.length / 2)
        else:
            put(self._length, value=body.length)
            put(self._width, value=body.width)
        put(self._use_map, value=look.use_map)
        put(self._view, value=round(degrees(look.field_of_view), 1))
        self.show_settings()

    def visible(self, yes: bool) -> None:
        """Whether there are two maps."""
        put(self._folder, visible=yes)

    def offer(self, sample: bool, rows: int, row: int | None) -> None:
        """Whether the sample has what is asked for here; how many encounters there are, and which it is."""
        put(self._sample, visible=sample)
        options = tuple(str(number) for number in range(1, max(1, rows) + 1))
        put(self._row, options=options, value=str((row or 0) + 1), visible=rows > 1 and row is not None)

    def show_files(self, told: Mapping[str, str], says: str, bad: bool, any_: bool, calibrated: bool) -> None:
        """What is there.

        says       : what is missing, or (``bad``) does not fit; "" for nothing
        any_       : whether there is anything to forget
        calibrated : whether nobody has to say how wide the camera sees
        """
        put(self._table, content=files_html(told, self._files._impl.uuid))
        put(self._fault, content=box(says, "refused" if bad else "plain") if says else "", visible=bool(says))
        put(self._forget, visible=any_)
        put(self._view, visible=not calibrated)

    def show_settings(self) -> None:
        """Those that do something."""
        tags, round_ = FINDERS[self._finder.value] == "tags", self._shape.value == ROUND
        put(self._least, visible=not tags)
        for handle in (self._family, self._tag_size):
            put(handle, visible=tags)
        for handle in (self._length, self._width):
            put(handle, visible=not round_)
        put(self._radius, visible=round_)

    def name(self, names: RobotNames) -> None:
        """What the robots are called."""
        put(self._intro, content=f'<p style="{SMALL}">{escape(names.told(INTRO))}</p>')
        for name, (label, hint) in PLACES.items():
            put(self._places[name], label=names.told(label), hint=names.told(hint))
        put(self._shape, label=names.told(SHAPE))
        put(self._use_map, label=names.told(USE_MAP))

    def show_places(self, at: ObservationDraft, source: str, names: RobotNames) -> None:
        """Where the robots stood; ``source``: who says so."""
        numbers = places_of(at)
        for name, value in numbers.items():
            shown = round(degrees(value) if name == "turn1" else value, 3)
            put(self._places[name], value=shown)
        put(self._where, content=where_html(at, source, names))

    def possible(self, look: bool, busy: bool, seen: bool) -> None:
        """Whether there is all that a look needs, whether one is under way, if one can be shown again."""
        put(self._look, disabled=not look, visible=not busy)
        put(self._stop, visible=busy)
        put(self._show, visible=seen and not busy)


def places_of(at: ObservationDraft) -> dict[str, float]:
    """Where the robots stood, as far as it is known; metres, radians."""
    numbers = {}
    if at.observer is not None:
        numbers |= {"x1": at.observer.x, "y1": at.observer.y, "turn1": at.observer.theta}
    if at.observed is not None:
        numbers |= {"x2": at.observed[0], "y2": at.observed[1]}
    return numbers


def where_html(at: ObservationDraft, source: str, names: RobotNames) -> str:
    """HTML of where the robots stood, in a line each."""
    unknown = "not known yet: say it below"
    first = second = unknown
    if at.observer is not None:
        o = at.observer
        first = f"{o.x:.2f}, {o.y:.2f} m, {degrees(o.theta):.1f}°"
    if at.observed is not None:
        second = "{:.2f}, {:.2f} m".format(*at.observed)
    rows = "".join(
        f"<tr><td>{escape(names.told(f'robot {k} in map {k}'))}</td><td>{text.replace('-', '−')}</td></tr>"
        for k, text in enumerate((first, second), 1)
    )
    said = f"<caption>{escape(source)}</caption>" if source else ""
    return f'<table class="mm-stood">{said}{rows}</table>'


def files_html(told: Mapping[str, str], button: str) -> str:
    """HTML of a line per file, on which files can be dropped for the button of that id."""
    rows = "".join(
        f"<tr{'' if text else ' data-missing'}><td>{'✓' if text else '·'}</td><th>{escape(name)}</th>"
        f"<td>{escape(text) or 'missing'}</td></tr>"
        for name, text in told.items()
    )
    return (
        f'<div class="mm-sensors" data-mm-files="{escape(button)}"><table>{rows}</table>'
        "<p>Drop files here, all at once.</p></div>"
    )
