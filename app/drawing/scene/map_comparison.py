"""How two maps are compared where one lies over the other: overlay, blink, curtain, difference; and what came
of them.
"""

from __future__ import annotations

from typing import Any, get_args

from algorithms.common.pose import FloatArray
from algorithms.verdict.contradictions import Contradiction, Contradictions
from app.drawing.browser_messages import BrowserMessages
from app.drawing.palette import Palette, css
from app.drawing.scene.map_layers import Mode
from app.drawing.scene.map_view import MapView
from app.model.contradiction_text import MOST_PLACES

MODES: tuple[Mode, ...] = get_args(Mode)


def rings(places: tuple[Contradiction, ...], anchor: FloatArray) -> list[dict[str, Any]]:
    """The places that are ringed on the map, as map_comparison.js draws them; metres of the scene."""
    return [
        {"n": n, "at": [place.x - float(anchor[0]), place.y - float(anchor[1])], "r": place.radius}
        for n, place in enumerate(places[:MOST_PLACES], 1)
    ]


class MapComparison:
    """The mode a person has chosen, and what there is to compare."""

    def __init__(self, messages: BrowserMessages, maps: MapView) -> None:
        self._messages, self._maps = messages, maps
        self._conflicts: Contradictions | None = None
        self._modes: tuple[Mode, ...] = ()
        self.mode: Mode = "overlay"

    def offer(self, conflicts: Contradictions | None, palette: Palette) -> None:
        """Map 2 lies over map 1: compare them; ``conflicts`` None where their cells are not merged."""
        self._conflicts = conflicts
        self._modes = MODES if conflicts is not None else ("overlay", "blink", "curtain")
        if self._maps.ground.corrected() is None:
            self._modes = tuple(mode for mode in self._modes if mode != "result")
        if self.mode not in self._modes:
            self.mode = "overlay"
        found = rings(conflicts.places, self._maps.layout.anchor_ref) if conflicts is not None else []
        self._maps.compare(self.mode, conflicts)
        self._messages.compare(modes=list(self._modes), mode=self.mode, places=found)
        self.recolour(palette)

    def recolour(self, palette: Palette) -> None:
        colours = {f"map{number}": css(colour) for number, colour in enumerate(palette.maps, 1)}
        self._messages.compare(colours={**colours, "conflict": css(palette.conflict)})

    def outdate(self) -> None:
        """What was found where is out of date; the maps still lie there."""
        self._messages.compare(places=[])

    def clear(self) -> None:
        """There is nothing to compare."""
        self._conflicts, self._modes, self.mode = None, (), "overlay"
        self._maps.compare("overlay", None)
        self._messages.compare(modes=[], mode="overlay", places=[])

    def choose(self, mode: Mode) -> bool:
        """Compare in this way from now on; whether there is anything to compare in it."""
        if mode not in self._modes:
            return False
        self.mode = mode
        self._maps.compare(mode, self._conflicts)
        self._messages.compare(mode=mode)
        return True
