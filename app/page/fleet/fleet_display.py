"""Draws a fleet: its maps, its words above them, its panel."""

from __future__ import annotations

from algorithms.common.pose import FloatArray
from app.drawing.fleet_layout import FleetLayout, lay_out_fleet
from app.drawing.scene.fleet_view import Edge, edges_of, nearest_edge
from app.drawing.scene_layout import Rect, rect_of, union
from app.model.fleet_state import FleetState
from app.page.fleet.fleet_html import poses_html
from app.page.tab import Tab
from app.report.fleet_report import summary

READY = "A fleet of {} robots. Press Merge; or press a pair to open it."
OPENED = "Of the fleet {}: {} and {}. What is merged or taken here goes back into it."
NEAR = 0.02  # of the picture's size: so near to a line is a click on it


class FleetDisplay:
    """Of one tab; whoever calls holds the drawing lock."""

    def __init__(self, tab: Tab) -> None:
        self._state, self._panels, self._messages = tab.state, tab.panels, tab.display.messages
        self._page, self._view = tab.display, tab.display.views.fleet
        self._layout: FleetLayout | None = None
        self._edges: list[Edge] = []

    def show(self, look: bool = False, follow: bool = True) -> None:
        """Draw the fleet.

        look   : the camera goes there
        follow : also where the person has moved it
        """
        state = self._state.fleet
        if state is None:
            return
        self._layout = layout = lay_out_fleet(state.fleet.maps, state.groups())
        self._edges = edges_of(state, layout)
        self._view.show(state, layout, self._edges, self._state.palette)
        if look:
            self._messages.look_down(self.extent, follow=follow)
        self._panels.run.merge.disabled = bool(state.live)  # robots that run are merged by themselves
        anchor, box = layout.anchors[state.fleet.anchor], layout.boxes[0]
        self._messages.hud(
            case=state.name,
            names=[state.fleet.anchor] * 2,  # whose frame all is told in
            frames=[[*anchor.tolist(), *box], None],
            measure=True,
            readout="",
        )
        self._panels.charts.tell(poses_html(state), turn=not state.live)
        self._page.show_legend()
        self._page.show_buttons()
        self._messages.flush()

    def hide(self) -> None:
        self._view.hide()
        self._messages.flush()

    def say_outcome(self) -> None:
        """What became of the fleet, above the maps."""
        state = self._state.fleet
        if state is not None:
            said, mood = _outcome(state)
            words = said or READY.format(len(state.robots))
            self.say(words, mood if said else "idle", None)

    def say(self, words: str, mood: str, share: float | None) -> None:
        """Words above the maps, and the share of the work that is done."""
        self._messages.hud(state=words, mood=mood, progress=share)
        self._messages.flush()

    def show_panel(self, on: bool) -> None:
        """Have the panel show the fleet where the page does (``on``), or one of its pairs, else nothing."""
        state = self._state.fleet
        self._panels.knowledge.visible(state is None or state.opened is not None or not on)
        if state is None or not (on or state.opened is not None):
            self._panels.fleet.show(None)
        elif state.opened is not None:
            said = OPENED.format(state.name, state.opened.ref, state.opened.mov)
            self._panels.fleet.show(state, said)
        else:
            self._panels.fleet.show(state)

    @property
    def extent(self) -> Rect:
        """All that is drawn."""
        if self._layout is None:
            return -5.0, -5.0, 5.0, 5.0
        return union(self._layout.extent, *(rect_of(edge.ends) for edge in self._edges))

    def edge_at(self, place: FloatArray) -> Edge | None:
        """The sighting at a place of the scene."""
        x0, y0, x1, y1 = self.extent
        return nearest_edge(self._edges, place, NEAR * max(x1 - x0, y1 - y0))


def _outcome(state: FleetState) -> tuple[str, str]:
    """What became of it, and its mood; "" before all is merged."""
    if state.result is None:
        return "", "plain"
    return summary(state.result, len(state.robots)), "accepted" if state.result.whole else "refused"
