"""Folder "By hand": put map 2 where a person wants it, with numbers, and what the walls say of it."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees, isfinite, radians
from typing import Any

import viser

from algorithms.common.pose import FloatArray, Pose2, pose_error
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.methods.merge_result import MergeResult
from app.drawing.palette import LIGHT, QUIET
from app.model import verdict_text as words
from app.model.objective_label import measure_of
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put, small, table
from app.report.result_rows import named

HOW = (
    "Drag map 2. To turn it, drag the knob, or hold Shift or Alt. Arrow keys: one cell, with "
    "Shift 1 cm; [ and ]: 0.5°, with Shift 0.1°. The empty ground still pans."
)
MOVE, BEGIN_HINT = "Move map 2 by hand", "Drag and turn it over map 1, or correct what the method found."
ABOUT, ORIGIN = "Numbers are of", "the origin of map 2"
ABOUT_HINT = "A turn that is typed is about this point of map 2, which stays where it is."
SEEN, MIDDLE = "robot 2, where it was seen", "the middle of map 2"
LABELS = "T: Δx (m)", "T: Δy (m)", "T: Δθ (°)"
AT_LABELS = "x in map 1 (m)", "y in map 1 (m)", "turn Δθ (°)"
HINTS = "Right, in map 1.", "Up, in map 1.", "Counter-clockwise; the two numbers above stay."
FAR = 1e5  # metres
BUTTONS = (
    ("Refine from here", QUIET, "The method's own search, in its box around this place."),
    (
        "Snap to proven optimum",
        QUIET,
        "The best of the whole circle: it is the method's answer, no longer yours.",
    ),
    ("Take this as the answer", LIGHT.ref, "Its verdict stays with it."),
)


class TransformPanel:
    """Widgets; they know nothing of maps."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._names, self._seen = UNNAMED, True
        self._folder = gui.add_folder("By hand", order=62.0, visible=False)
        with self._folder:
            icon = viser.Icon.HAND_MOVE
            self._begin = gui.add_button(MOVE, icon=icon, color=QUIET, hint=BEGIN_HINT)
            self._how = gui.add_html(how_html(UNNAMED), visible=False)
            self._about = gui.add_dropdown(ABOUT, (SEEN, ORIGIN), hint=ABOUT_HINT, visible=False)
            number = {"min": -FAR, "max": FAR, "visible": False}
            self._x, self._y, self._turn = (
                gui.add_number(label, 0.0, step=step, hint=hint, **number)
                for label, step, hint in zip(AT_LABELS, (0.01, 0.01, 0.1), HINTS, strict=True)
            )
            self._says = gui.add_html("", visible=False)
            self._refine, self._snap, self._take = (
                gui.add_button(label, color=colour, visible=False, hint=hint)
                for label, colour, hint in BUTTONS
            )

    def connect(
        self,
        toggle: Action,
        typed: Callable[[str, float], None],
        refine: Action,
        snap: Action,
        take: Action,
        about: Action,
    ) -> None:
        """What is done with map 2 in hand.

        typed : x, y or theta; metres, radians; in viser's loop
        about : the numbers are to be those of another point
        """
        on_press((self._begin, toggle), (self._refine, refine), (self._snap, snap), (self._take, take))
        self._typed = typed
        for handle in (self._x, self._y, self._turn):
            handle.on_update(self._read)
        on_choice(self._about, about)

    @property
    def of_origin(self) -> bool:
        """Whether the numbers are T's, which are of map 2's origin."""
        return self._about.value == self._names.told(ORIGIN)

    def offer(self, possible: bool, names: RobotNames = UNNAMED) -> None:
        """Whether there is anything to move."""
        self._folder.visible, told = possible, names.told
        of_origin, self._names = self.of_origin, names
        self._offer_points(of_origin)
        put(self._begin, label=told(MOVE), hint=told(BEGIN_HINT))
        put(self._how, content=how_html(names))
        for handle, hint in zip((self._x, self._y, self._turn), HINTS, strict=True):
            put(handle, hint=told(hint))

    def _offer_points(self, of_origin: bool) -> None:
        """Of which points of map 2 the numbers may be."""
        options = tuple(map(self._names.told, (SEEN if self._seen else MIDDLE, ORIGIN)))
        put(self._about, label=ABOUT, hint=self._names.told(ABOUT_HINT))
        put(self._about, options=options, value=options[of_origin])

    def open(self, yes: bool, refine: bool = False, prove: bool = False, seen: bool = True) -> None:
        """Show what moves map 2; which buttons depends on what the method can do.

        seen : whether it is known where robot 2 was seen, about which map 2 is turned; else about its middle
        """
        self._seen = seen
        self._offer_points(self.of_origin)
        self._begin.label = "Leave it as it was" if yes else self._names.told(MOVE)
        for handle in (self._how, self._about, self._x, self._y, self._turn, self._says, self._take):
            handle.visible = yes
        self._refine.visible, self._snap.visible = yes and refine, yes and prove

    def show(self, T: Pose2, at: FloatArray) -> None:
        """Where map 2 lies.

        T  : T_ref_mov
        at : (2,) where the point that it is turned about lies in map 1; metres
        """
        x, y = (T.xy if self.of_origin else at).tolist()
        labels = LABELS if self.of_origin else AT_LABELS
        values = x, y, degrees(T.theta)
        for handle, label, value in zip((self._x, self._y, self._turn), labels, values, strict=True):
            put(handle, label=self._names.told(label))
            handle.value = round(value, 3)

    def tell(self, html: str) -> None:
        self._says.content = html

    async def _read(self, event: viser.GuiEvent[Any]) -> None:  # in the loop: nothing overwrites it before
        if event.client_id is None:
            return  # set by ``show``
        fields = {"x": self._x, "y": self._y, "theta": self._turn}
        field = next(name for name, handle in fields.items() if handle is event.target)
        value = event.target.value
        self._typed(field, radians(value) if field == "theta" else value)


def how_html(names: RobotNames) -> str:
    return small(names.told(HOW))


def weighed_html(result: MergeResult, config: Any, method: Pose2 | None, names: RobotNames = UNNAMED) -> str:
    """HTML of what the walls say of a transform, and how far it is off the method's."""
    verdict = result.verdict
    rows: list[tuple[str, ...]] = []
    if result.value is not None and isfinite(result.value):
        measure = measure_of(config)
        rows.append((measure.row, measure.number(result.value)))
    rows += [
        ("likely right", words.likelihood(verdict.probability)),
        ("contradicted, as the maps are", f"{verdict.rigid_contradiction:.1%}"),
        ("wall in view of both", f"{verdict.shared_wall:.1f} m"),
    ]
    if result.weighed[0].deviations:
        off = "robot 2 off its sighting" if result.encounters else "off what is known"
        rows.append((off, f"{verdict.deviation:.1f} σ"))
    if method is not None:
        apart, turn = pose_error(result.T_ref_mov, method, result.pivot)
        rows.append(("off the method's answer", f"{apart:.2f} m, {degrees(turn):.1f}°"))
    return box(names.told(words.of_hand(result)), words.mood(verdict)) + table(named(rows, names))
