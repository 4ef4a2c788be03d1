"""The dock at the left: the curves and numbers of the stage at hand."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser
from viser import uplot

from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AnswersDetail,
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    MatchesDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    TurnsDetail,
    WindowDetail,
)
from algorithms.optimisation.branch_and_bound import ProofState
from app.drawing.palette import LIGHT, css
from app.model import chart_data as charts
from app.model import status_text as words
from app.model.run_state import RunState
from app.page.panels.chart_widgets import dots, empty, entitle, line, plot
from app.page.panels.html_widgets import box, table

TURN, SHIFT, SWARM, PROOF, RESULT = "Turn", "Shift", "Swarm", "Proof", "Result"
WIDTH = 316
LINES = 4  # courses of the search that are drawn

# colours that read on light and on dark panels alike
REF, MOV, MARK, BEST = css(LIGHT.ref), css(LIGHT.mov), css(LIGHT.particle), css(LIGHT.best)
GREY, OPTIMUM, RIVAL, RIM = css(LIGHT.margin), css(LIGHT.answer), css(LIGHT.rival), "#9a8b00"
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
        self._shown: dict[str, object] = {}
        with self._panel.add_tab("Stages", icon=viser.Icon.CHART_LINE):
            self._pages = gui.add_button_group("", (TURN, SHIFT, SWARM, PROOF, RESULT))
            self._pages.on_click(lambda _: self._choose())
            self._hint = gui.add_html("")
            self._hough = plot(
                gui,
                *charts.HOUGH,
                (line("map 1", REF), line("map 2", MOV)),
                190,
            )
            self._turns = plot(
                gui,
                *charts.TURNS,
                (line("CC", GREY), dots("candidates", MARK, 8), dots("at hand", BEST, 10)),
                190,
            )
            self._circle = plot(
                gui,
                charts.CIRCLE[0].format("agreement"),
                charts.CIRCLE[1],
                (line("agreement", GREY), dots("best", BEST, 10)),
                230,
                None,
                (30.0, 45.0, 90.0, 180.0),
            )
            window = uplot.Series(
                label="window", width=0, fill="rgba(107,114,128,.20)", points={"show": False}
            )
            self._shifts: list[tuple[Any, Any]] = []
            for axis, number, names in (("x", "(13)", charts.SHIFT_X), ("y", "(14)", charts.SHIFT_Y)):
                self._shifts.append(
                    (
                        plot(
                            gui,
                            f"{axis.upper()} spectra, eq. {number}; map 2 turned and shifted",
                            f"{axis} (m)",
                            (line("map 1", REF), line("map 2", MOV)),
                            140,
                        ),
                        plot(
                            gui,
                            *names,
                            (window, line("C", GREY), dots("shift", BEST, 9)),
                            140,
                        ),
                    )
                )
            colours = (BEST, MARK, REF, GREY)
            self._climb = plot(
                gui,
                charts.CLIMB[0].format("value"),
                charts.CLIMB[1],
                tuple(line(f"{k + 1}", colour, 2.2 if k == 0 else 1.3) for k, colour in enumerate(colours)),
                230,
                None,
            )
            self._candidates = gui.add_html("")
            self._proof_says = gui.add_html("")
            self._proof = plot(
                gui,
                charts.PROOF[0].format("value"),
                charts.PROOF[1],
                (
                    line("ceiling", GREY, 1.4, fill="rgba(107,114,128,.16)"),
                    line("best met", MARK, 1, fill="rgba(230,159,0,.55)"),
                    line("floor", RIVAL, 1, dash=(3, 4), alpha=0.8),
                    dots("optimum", OPTIMUM, 11, RIM),
                    dots("rivals", RIVAL, 9),
                ),
                250,
                ticks=(30.0, 45.0, 90.0, 180.0),
            )
            self._rivals = gui.add_html("")
            self.result = gui.add_html("")
        self._panel.dock_left()
        self._panel.set_width(WIDTH)
        self.page = TURN
        self._show_page()

    def add_tab(self, title: str, icon: viser.IconName) -> Any:
        """A further tab of the dock, to be filled in a ``with``."""
        return self._panel.add_tab(title, icon=icon)

    def visible(self, yes: bool) -> None:
        """Show the dock, or leave its place to another."""
        self._panel.visible = yes
        if yes:
            self._panel.set_width(WIDTH)

    # --- pages ------------------------------------------------------------------------------------

    def _choose(self) -> None:
        if self._pages.value == self.page:
            return  # it was set by us
        self._chosen = True
        self.page = self._pages.value
        self._show_page()
        self._turned()

    def follow(self) -> None:
        """Go along with the run from now on."""
        self._chosen = False

    def turn_to(self, page: str) -> None:
        """Show a page, unless the person has chosen one."""
        if not self._chosen and page != self.page:
            self.page = page
            self._show_page()

    def _show_page(self) -> None:
        if self._pages.value != self.page:
            self._pages.value = self.page
        for handles, page in (
            ((self._hough, self._turns), TURN if "turn" in self._shown else ""),
            ((self._circle,), TURN if "circle" in self._shown else ""),
            ([handle for pair in self._shifts for handle in pair], SHIFT),
            ((self._climb, self._candidates), SWARM),
            ((self._proof_says, self._proof, self._rivals), PROOF),
            ((self.result,), RESULT),
        ):
            shown = bool(page) and self.page == page and self._filled(page)
            for handle in handles:
                if handle.visible != shown:
                    handle.visible = shown
        empty = not self._filled(self.page)
        if self._hint.visible != empty:
            self._hint.visible = empty
        if empty and HINTS[self.page] not in self._hint.content:
            self._hint.content = box(HINTS[self.page], "plain")

    def _filled(self, page: str) -> bool:
        """Whether there is anything to show on a page."""
        if page == RESULT:
            return bool(self.result.content)
        if page == TURN and "circle" in self._shown:
            return True
        return {TURN: "turn", SHIFT: "shift", SWARM: "candidates", PROOF: "proof"}[page] in self._shown

    def tell(self, answer: str) -> None:
        """Put the answer, as HTML, on its page."""
        self.result.content = answer
        self._show_page()

    # --- a run ------------------------------------------------------------------------------------

    def clear(self) -> None:
        """Nothing is known."""
        self._shown.clear()
        self._candidates.content = self.result.content = ""
        self._proof_says.content = self._rivals.content = ""
        pairs = (chart for pair in self._shifts for chart in pair)
        for chart in (self._hough, self._turns, self._circle, *pairs, self._climb, self._proof):
            chart.data = empty(len(chart.data) - 1)
        self._show_page()

    def show(self, story: RunState, follow: bool) -> None:
        """Draw what has changed since the last call; ``follow`` turns to the page of the stage at hand."""
        detail = story.last.detail if story.last else None
        hough, refine = story.get(HoughDetail), story.get(RefineDetail)
        shift = story.shifts[-1] if story.shifts else None
        found, proof = story.get(CandidatesDetail), story.get(ProofDetail)
        # after the search the best candidate is the one at hand
        at_hand = found.candidates[0] if found else shift.candidate if shift else None
        if isinstance(detail, TurnsDetail):
            self._turn_all(detail, story.measure.name)
        elif hough is not None and detail is hough:
            self._shown.pop("circle", None)
        if hough is not None and self._new("turn", (hough, at_hand)):
            self._hough.data = charts.hough_spectra(hough.match)
            chosen = at_hand.T_ref_mov.theta if at_hand else None
            self._turns.data = charts.turn_correlation(hough.match, chosen)
            around = charts.turn_range(hough.match)
            if self._new("turn scale", around):
                self._turns.scales = {"x": uplot.Scale(time=False), "y": uplot.Scale(range=around)}
        if at_hand is not None and self._new("shift", at_hand):
            for (spectra, correlation), match in zip(self._shifts, (at_hand.x, at_hand.y), strict=True):
                spectra.data = charts.shift_spectra(match)
                correlation.data = charts.shift_correlation(match)
        measure = story.measure
        if refine is not None and self._new("climb", refine):
            self._climb.data = charts.courses(story.courses, LINES)
            entitle(self._climb, charts.CLIMB[0].format(measure.row))
        if found is not None and self._new("candidates", (found, refine)):
            rows = charts.candidate_rows(found.candidates, story.courses, measure)
            head = ("rank", "Δθ", "Δx (m)", "Δy (m)", "look", "swarm")
            self._candidates.content = table(rows, head)
        if proof is not None and self._new("proof", proof):
            self._prove(story, proof.state)
        elif proof is None and story.reached(Fusion):  # of an earlier run; this method proves nothing
            self._shown.pop("proof", None)
        self._show_page()
        if not follow:
            return
        if isinstance(detail, (AugmentDetail, HoughDetail, TurnsDetail)):
            self.turn_to(TURN)
        elif isinstance(detail, (WindowDetail, ShiftDetail, CandidatesDetail)):
            self.turn_to(SHIFT)
        elif isinstance(detail, (RefineDetail, AnswersDetail)):
            self.turn_to(SWARM)
        elif isinstance(detail, (ProofDetail, ProvenDetail)):
            self.turn_to(PROOF)
        elif isinstance(detail, (MatchesDetail, MergeResult)):
            self.turn_to(RESULT)

    def _turn_all(self, detail: TurnsDetail, measure: str) -> None:
        if not self._new("circle", detail):
            return
        self._shown.pop("turn", None)  # of an earlier run, with spectra
        self._circle.scales = {
            "x": uplot.Scale(time=False, range=(-180.0, 180.0)),
            "y": uplot.Scale(range=charts.circle_range(detail)),
        }
        entitle(self._circle, charts.CIRCLE[0].format(measure))
        self._circle.data = charts.circle(detail)

    def _prove(self, story: RunState, state: ProofState) -> None:
        measure, span = story.measure, charts.proof_range(state, story.ceiling)
        # the axis first: its curves are clipped to it
        if self._new("proof scale", span):
            self._proof.scales = {
                "x": uplot.Scale(time=False, range=(-180.0, 180.0)),
                "y": uplot.Scale(range=span),
            }
        entitle(self._proof, charts.PROOF[0].format(measure.row))
        self._proof.data = charts.proof(state, span[1])
        self._proof_says.content = box(words.proof_says(state, measure), "plain")
        rows = charts.proof_rows(state, measure)
        head = ("on the raster", "Δθ", measure.unit or measure.name, "of the best")
        self._rivals.content = table(rows, head) if rows else ""

    def _new(self, name: str, source: object) -> bool:
        before, self._shown[name] = self._shown.get(name), source
        return before is None or before != source
