"""The dock at the left: curves and numbers of the stage at hand. Operators have no dock, but a wider map, and
the last page, the result, in a folder among the others.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.steps import (
    CandidatesDetail,
    HoughDetail,
    PlaneDetail,
    ProofDetail,
    RefineDetail,
    TurnsDetail,
)
from app.drawing.svg.correlation_plot import correlation_svg
from app.model import chart_data as charts
from app.model import status_text as words
from app.model.run_state import RunState
from app.model.step_table import PROOF, RESULT, SHIFT, SWARM, TURN, row_of
from app.page.panels.chart_widgets import add_chart, fill, name_curves, nothing
from app.page.panels.html_widgets import box, put, table

WIDTH = 316
# name of a chart -> its page, how it looks, its height
CHARTS = {
    "hough": (TURN, charts.HOUGH, 190),
    "turns": (TURN, charts.TURNS, 190),
    "circle": (TURN, charts.CIRCLE, 230),
    "x spectra": (SHIFT, charts.X_SPECTRA, 140),
    "x": (SHIFT, charts.SHIFT_X, 140),
    "y spectra": (SHIFT, charts.Y_SPECTRA, 140),
    "y": (SHIFT, charts.SHIFT_Y, 140),
    "climb": (SWARM, charts.CLIMB, 230),
    "proof": (PROOF, charts.PROOF, 250),
}
# what a page says while there is nothing on it
HINTS = {
    TURN: "Which way do the walls run? Press Merge, or move a slider: the Hough spectra of both maps, and "
    "the turns in which they coincide, appear here.",
    SHIFT: "How far is map 2 off? The X and Y spectra of every turn that is tried appear here.",
    SWARM: "The climb of the best value, candidate by candidate, appears here during a merge.",
    PROOF: "Is there a better place anywhere on the circle? What the method “Spectra, swarm, proven optimum” "
    "has ruled out, turn by turn, appears here during a merge.",
    RESULT: "The verdict and its numbers appear here after a merge.",
}


class ChartsPanel:
    """Follows the run until the person chooses a page of it; the next Merge follows again."""

    def __init__(self, client: viser.ClientHandle, turned: Callable[[], None]) -> None:
        gui = client.gui
        self._turned = turned
        self._panel = gui.add_panel()
        self._chosen = False
        self._stages, self._wanted = False, True  # whether the dock is for researchers, and has its place
        self.names = UNNAMED
        self._shown: dict[str, object] = {}  # by the name of a chart or text: what it was made from
        with self._panel.add_tab("Stages", icon=viser.Icon.CHART_LINE):
            self._pages = gui.add_button_group("", (TURN, SHIFT, SWARM, PROOF, RESULT))
            self._pages.on_click(lambda _: self._choose())
            self._hint = gui.add_html("")
            self._proof_says = gui.add_html("")
            self._charts = {name: add_chart(gui, form, height) for name, (_, form, height) in CHARTS.items()}
            self._surface = gui.add_html("")
            self._candidates, self._rivals = gui.add_html(""), gui.add_html("")
            self.result = gui.add_html("")
        self._texts = (self._proof_says, self._surface, self._candidates, self._rivals, self.result)
        self._widgets: list[tuple[Any, tuple[str, ...], str]] = [  # with its pages and its name in ``_shown``
            *((handle, (CHARTS[name][0],), name) for name, handle in self._charts.items()),
            (self._surface, (TURN, SHIFT), "surface"),
            (self._candidates, (SWARM,), "candidates"),
            (self._proof_says, (PROOF,), "proof"),
            (self._rivals, (PROOF,), "proof"),
            (self.result, (RESULT,), "result"),
        ]
        self._folder = gui.add_folder("Result", order=5.0, visible=False)
        with self._folder:
            self._alone = gui.add_html("")
        self._panel.dock_left()
        self._panel.set_width(WIDTH)
        self.page = RESULT
        self._show_page()

    def add_tab(self, title: str, icon: viser.IconName) -> Any:
        """A further tab of the dock, to be filled in a ``with``."""
        return self._panel.add_tab(title, icon=icon)

    def visible(self, yes: bool) -> None:
        """Show the dock, or leave its place to another."""
        self._wanted = yes
        put(self._panel, visible=yes and self._stages)
        if yes and self._stages:
            self._panel.set_width(WIDTH)

    # --- pages ------------------------------------------------------------------------------------

    def _choose(self) -> None:
        if self._pages.value == self.page:
            return  # it was set by us
        self._chosen = True
        self.page = self._pages.value
        self._show_page()
        self._turned()

    def research(self, yes: bool) -> None:
        """Show the dock, or the result alone in a folder."""
        self._stages = yes
        self.visible(self._wanted)
        if not yes:
            self.page = RESULT
        self._show_page()

    def follow(self) -> None:
        """Go along with the run from now on."""
        self._chosen = False

    def name(self, names: RobotNames) -> None:
        """These are the robots whose run is drawn."""
        if names != self.names:
            self.names = names
            for name, (_, form, _) in CHARTS.items():
                name_curves(self._charts[name], form, names)

    def _show_page(self) -> None:
        put(self._pages, value=self.page)
        alone = "" if self._stages else str(self._shown.get("result", ""))
        put(self._alone, content=alone)
        put(self._folder, visible=bool(alone))
        empty = True
        for handle, pages, name in self._widgets:
            shown = self.page in pages and bool(self._shown.get(name))
            put(handle, visible=shown)
            empty = empty and not shown
        put(self._hint, visible=empty)
        if empty:
            put(self._hint, content=box(self.names.told(HINTS[self.page]), "plain"))

    def tell(self, answer: str, turn: bool = False) -> None:
        """Put the answer, as HTML, on its page; ``turn``: and show that page."""
        self.result.content = self._shown["result"] = answer
        if turn:
            self.page = RESULT
        self._show_page()

    # --- a run ------------------------------------------------------------------------------------

    def clear(self) -> None:
        """Nothing is known."""
        self._shown.clear()
        for text in self._texts:
            text.content = ""
        for chart in self._charts.values():
            chart.data = nothing(len(chart.data) - 1)
        self._show_page()

    def show(self, run: RunState, follow: bool) -> None:
        """Draw what has changed since the last call; ``follow`` turns to the page of the stage at hand."""
        detail = run.last.detail if run.last else None
        hough, found, proof = run.get(HoughDetail), run.get(CandidatesDetail), run.get(ProofDetail)
        refine, measure, chosen = run.get(RefineDetail), run.measure, run.at_hand
        if isinstance(detail, TurnsDetail):
            self._forget("hough", "turns", "surface")  # of an earlier run
            self._draw("circle", detail, lambda: charts.circle(detail, measure.name))
        elif hough is not None and detail is hough:
            self._forget("circle", "surface")
        if (plane := run.get(PlaneDetail)) is not None:
            self._forget(*(self._shown.keys() - {"circle", "surface", "result"}))
            self._show_plane(run, plane)
        if hough is not None:
            turn = chosen.T_ref_mov.theta if chosen else None
            self._draw("hough", hough, lambda: charts.hough_spectra(hough.match))
            self._draw("turns", (hough, chosen), lambda: charts.turn_correlation(hough.match, turn))
        if chosen is not None:
            x, y = chosen.x, chosen.y
            self._draw("x spectra", chosen, lambda: charts.shift_spectra(x, charts.X_SPECTRA))
            self._draw("y spectra", chosen, lambda: charts.shift_spectra(y, charts.Y_SPECTRA))
            self._draw("x", chosen, lambda: charts.shift_correlation(x, charts.SHIFT_X))
            self._draw("y", chosen, lambda: charts.shift_correlation(y, charts.SHIFT_Y))
        if refine is not None:
            self._draw("climb", refine, lambda: charts.climb(run.courses, measure))
        if found is not None and self._new("candidates", (found, refine)):
            rows = charts.candidate_rows(found.candidates, run.courses, measure)
            self._candidates.content = table(rows, ("rank", "Δθ", "Δx (m)", "Δy (m)", "look", "swarm"))
        if proof is not None:
            if self._draw("proof", proof, lambda: charts.proof(proof.state, run.ceiling, measure)):
                self._proof_says.content = box(
                    self.names.told(words.proof_says(proof.state, measure)), "plain"
                )
                head = ("on the raster", "Δθ", measure.unit or measure.name, "of the best")
                rows = charts.proof_rows(proof.state, measure)
                self._rivals.content = table(rows, head) if rows else ""
        elif run.reached(Fusion):  # of an earlier run; this method proves nothing
            self._forget("proof")
        if follow and self._stages and not self._chosen:
            self.page = row_of(detail).page or self.page
        self._show_page()

    def _show_plane(self, run: RunState, plane: PlaneDetail) -> None:
        """The best of every turn, and the surface of the turn at hand; after the search that of the best."""
        self._draw("circle", plane, lambda: charts.plane_turns(plane, run.measure))
        at_hand = run.plane if run.plane is not None and run.last.detail is not plane else plane
        top = float(plane.values[0]) if len(plane.values) else 1.0
        if self._new("surface", at_hand.picture and (at_hand.picture, top)) and at_hand.picture is not None:
            self._surface.content = correlation_svg(at_hand.picture, top)

    def _forget(self, *names: str) -> None:
        for name in names:
            self._shown.pop(name, None)

    def _draw(self, name: str, source: object, chart: Callable[[], charts.Chart]) -> bool:
        """Draw a chart, unless it was made from the same; whether it was drawn."""
        new = self._new(name, source)
        if new:
            fill(self._charts[name], chart(), self.names)
        return new

    def _new(self, name: str, source: object) -> bool:
        before, self._shown[name] = self._shown.get(name), source
        return before != source
