"""The dock of what was seen: the outcome, the image with its boxes, the scan, the gradients; and Use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import viser

from app.drawing.palette import LIGHT
from app.page.panels.html_widgets import Action, box, on_press, put, says_html

AGAIN, CLOSE = "Look again", "Close"
OPEN = '<div class="mm-sighting"></div>'  # by which sighting.js knows that the dock is open
NARROW, WIDE = 424, 560
ROOM = 1200  # pixels of the map, from which the dock is the wider one
NEXT = "as one more observation"


def places(observations: int) -> tuple[str, ...]:
    """What a sighting can be used as, where there are so many observations."""
    if observations == 1:
        return "in place of the observation", NEXT
    return *(f"in place of observation {number}" for number in range(1, observations + 1)), NEXT


@dataclass(frozen=True)
class SightingPage:
    """All that the dock shows of a look; every one of them HTML, but for these.

    outcome, mood : a sentence, and how it ended: accepted, refused
    usable        : whether it can be used
    cannot        : why not, where the outcome does not say so, as a sentence
    old           : whether it is out of date
    observations  : how many there are already
    """

    outcome: str
    mood: str
    usable: bool
    cannot: str
    old: bool
    observations: int
    picture: str
    boxes: str
    scan: str
    gradients: str


class SightingDock:
    """Widgets; they know nothing of robots."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        gui = client.gui
        self._panel = gui.add_panel(visible=False)
        with self._panel.add_tab("Sighting", icon=viser.Icon.EYE):
            self._moves = gui.add_button_group("", (AGAIN, CLOSE))
            self._says = gui.add_html(OPEN)
            self._outcome = gui.add_html("")
            self._cannot = gui.add_html("")
            self._as = gui.add_dropdown("Use it", (NEXT,), visible=False)
            icon = viser.Icon.CHECK
            self._use = gui.add_button("Use this sighting", color=LIGHT.ref, icon=icon, visible=False)
            self._parts = {name: gui.add_html("") for name in ("picture", "boxes", "scan", "gradients")}
        self._panel.dock_left()
        self._panel.set_width(NARROW)

    def connect(self, again: Action, close: Action, use: Callable[[int | None], None]) -> None:
        """What is done where a person presses.

        use : is given which observation it takes the place of, from 0; None: it is one more
        """
        moves = {AGAIN: again, CLOSE: close}
        self._moves.on_click(lambda event: moves[event.target.value]())
        on_press((self._use, lambda: use(self._place)))

    @property
    def _place(self) -> int | None:
        return None if self._as.value == NEXT else self._as.options.index(self._as.value)

    def visible(self, yes: bool) -> None:
        """Open it, as wide as there is room for, or close it."""
        put(self._panel, visible=yes)
        if yes:
            self._panel.set_width(WIDE if self._client.camera.image_width >= ROOM else NARROW)

    def say(self, words: str, share: float | None = None) -> None:
        """What is going on; nothing for ""."""
        put(self._says, content=OPEN + (says_html(words, share) if words else ""))

    def fail(self, why: str) -> None:
        """It could not be looked."""
        self.say("")
        put(self._outcome, content=box(why, "refused"))

    def clear(self) -> None:
        """Nothing was seen."""
        for handle in (self._outcome, self._cannot, *self._parts.values()):
            put(handle, content="")
        put(self._use, visible=False)
        put(self._as, visible=False)

    def show(self, page: SightingPage) -> None:
        """Show what was seen."""
        put(self._outcome, content=box(page.outcome, page.mood, faded=page.old))
        put(self._cannot, content=box(page.cannot, "plain") if page.cannot else "")
        options = places(page.observations)
        kept = self._as.value if self._as.value in options and self._as.visible else options[0]
        put(self._as, options=options, value=kept, visible=page.observations > 0)
        put(self._use, visible=True, disabled=not page.usable)
        for name, handle in self._parts.items():
            part = getattr(page, name)
            put(handle, content=f'<div class="mm-outdated">{part}</div>' if page.old and part else part)
