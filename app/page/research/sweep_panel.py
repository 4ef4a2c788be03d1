"""Tab "Sweep": which setting takes which values, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from html import escape
from typing import Any

import viser
from viser import uplot

from app.drawing.palette import LIGHT, QUIET, STOP, css
from app.model.settings import Setting
from app.model.status_text import typeset
from app.page.panels.chart_widgets import nothing
from app.page.panels.html_widgets import Action, on_choice, on_press, put, says_html
from app.page.research.comparison_panel import SMALL
from app.page.research.sweep_curves import AGREEMENT, Numbers, measures
from app.page.research.sweep_request import Wanted

NOTHING = "none"
FONT = "11px system-ui, sans-serif"
Row = tuple[int, Sequence[str]]


class AxisFields:
    """The fields of one setting; which of them are there depends on what kind of setting it is."""

    def __init__(self, gui: viser.GuiApi, label: str, none: bool, hint: str) -> None:
        self._none = (NOTHING,) if none else ()
        self._suggested = (0.0, 1.0)
        self.setting = gui.add_dropdown(label, self._none or ("…",), hint=hint)
        how: Any = {"visible": False, "hint": "First and last value."}
        self._range = gui.add_vector2("from, to", (0.0, 1.0), step=0.01, **how)
        how["hint"] = "How many, both ends included."
        self._count = gui.add_number("values", 5, min=2, max=60, step=1, **how)
        how["hint"] = "1, 2, 4, 8 instead of 1, 2, 3, 4."
        self._factor = gui.add_checkbox("equal factors", False, **how)

    def offer(self, labels: Sequence[str], chosen: str) -> None:
        """The settings there are to choose from."""
        options = (*self._none, *labels)
        put(self.setting, options=options)
        put(self.setting, value=chosen)

    def suggest(self, setting: Setting | None, low: float, high: float, by_factor: bool) -> None:
        """Show the fields that this setting has, with these values; None: no setting."""
        bounds = setting.bounds if setting is not None else None
        if bounds is not None:
            step = 1.0 if setting is not None and setting.whole else min(bounds.step, 0.01)
            self._range.step = step
            self._range.precision = 0 if step >= 1 else 4 if bounds.high <= 1 else 2
            self._range.value = self._suggested = (low, high)
            self._factor.value = by_factor
        put(self._range, visible=bounds is not None)
        put(self._count, visible=bounds is not None)
        put(self._factor, visible=bounds is not None and bounds.high > 0)

    @property
    def untouched(self) -> bool:
        """Whether the range is still the one that was suggested."""
        return tuple(self._range.value) == self._suggested

    @property
    def wanted(self) -> Wanted | None:
        """What is asked for; None where no setting is chosen."""
        label = self.setting.value
        if label in (NOTHING, "…"):
            return None
        low, high = self._range.value
        return Wanted(label, float(low), float(high), int(self._count.value), self._factor.value)


class SweepPanel:
    """Widgets; they know nothing of a run."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._of = gui.add_html("")
        first = "Which setting changes from merge to merge."
        second = "Another one: every value of it with every value of the first."
        self.axes = AxisFields(gui, "setting", False, first), AxisFields(gui, "second", True, second)
        hint = "Merges per point, each with its own seed."
        self._seeds = gui.add_number("seeds", 5, min=1, max=50, step=1, hint=hint)
        icon = viser.Icon.CHART_DOTS
        self._run = gui.add_button("Run the sweep", color=LIGHT.ref, icon=icon, disabled=True)
        icon = viser.Icon.PLAYER_STOP
        self._stop = gui.add_button("Stop sweeping", color=STOP, icon=icon, visible=False)
        self._says = gui.add_html(says_html(""))
        self._measures = gui.add_button_group("", measures(judged=True), visible=False)
        gui.add_html('<div class="mm-curve"></div>')  # research.js finds the chart below it
        self._curve = self._chart(gui)
        self._heat = gui.add_html("")
        self._points = gui.add_html("")
        self._save = gui.add_button(
            "Download tables and figure", color=QUIET, icon=viser.Icon.DOWNLOAD, visible=False,
            hint="A zip: a row per point, a row per merge, the times, and the figure as PNG and SVG.",
        )  # fmt: skip
        self._drawn: Any = None  # the scales of the chart: it is built anew for others

    def connect(
        self,
        run: Action,
        stop: Action,
        choose: Callable[[AxisFields], None],
        measure: Action,
        save: Action,
    ) -> None:
        """What is done where a person sweeps; ``choose``: another setting was chosen in these fields."""
        on_press((self._run, run), (self._stop, stop), (self._measures, measure), (self._save, save))
        for fields in self.axes:
            on_choice(fields.setting, partial(choose, fields))

    def _chart(self, gui: viser.GuiApi) -> viser.GuiUplotHandle:
        colour, here = css(LIGHT.ref), css(LIGHT.best)
        still = {"x": False, "y": False, "setScale": False}
        edge = {"width": 0, "stroke": colour, "points": {"show": False}}
        dots = {"show": True, "size": 7, "fill": colour, "stroke": colour, "width": 1}
        ring = {"show": True, "size": 13, "fill": "rgba(204,121,167,.35)", "stroke": here, "width": 2}
        return gui.add_uplot(
            nothing(4),
            (
                uplot.Series(label="setting"),
                uplot.Series(label="highest", **edge),  # type: ignore[typeddict-item]
                uplot.Series(label="lowest", **edge),  # type: ignore[typeddict-item]
                uplot.Series(label="mean", stroke=colour, width=1.8, points=dots),  # type: ignore[typeddict-item]
                uplot.Series(label="the sliders", stroke=here, width=0, points=ring),  # type: ignore[typeddict-item]
            ),
            bands=(uplot.Band(series=(1, 2), fill="rgba(0,114,178,.18)"),),
            title="…",
            legend=uplot.Legend(show=False),
            cursor=uplot.Cursor(y=False, drag=still, points={"show": False}),
            height=210,
            padding=(10, 14, 0, 0),
            visible=False,
        )

    # --- reading ----------------------------------------------------------------------------------

    @property
    def seeds(self) -> int:
        return int(self._seeds.value)

    @property
    def measure(self) -> str:
        return self._measures.value

    # --- writing ----------------------------------------------------------------------------------

    def tell_method(self, title: str) -> None:
        """Which method is swept."""
        says = "Merge the loaded maps again and again while a setting changes. Method: "
        says += f"<b>{escape(title)}</b>; all else as its sliders stand."
        put(self._of, content=f'<p style="{SMALL}">{says}</p>')

    def possible(self, ready: bool, busy: bool, harvest: bool) -> None:
        """Whether there is a pair, whether a sweep runs, whether any of its points is there."""
        put(self._run, disabled=not ready, visible=not busy)
        put(self._stop, visible=busy)
        put(self._save, visible=harvest and not busy)

    def say(self, words: str, share: float | None = None) -> None:
        """How far the sweep is, or why there is none."""
        self._says.content = says_html(words, share)

    def clear(self) -> None:
        self._heat.content = self._points.content = ""
        self._measures.visible = self._curve.visible = False

    def offer(self, judged: bool) -> None:
        """What can be drawn of this sweep."""
        options = measures(judged)
        if tuple(self._measures.options) != options:
            self._measures.options = options
            self._measures.value = AGREEMENT
        self._measures.visible = True

    def curve(
        self, title: str, label: str, ticks: Sequence[tuple[float, str]], log: bool,
        across: tuple[float, float], up: tuple[float, float], data: tuple[Numbers, ...],
    ) -> None:  # fmt: skip
        """Draw a curve; ``ticks`` are the places of its x axis that are named."""
        drawn = (title, label, tuple(ticks), log, across, up)
        if drawn != self._drawn:
            self._drawn = drawn
            named: Any = {"splits": tuple(at for at, _ in ticks), "values": tuple(word for _, word in ticks)}
            self._curve.scales = {
                "x": uplot.Scale(time=False, range=across, **({"distr": 3} if log else {})),  # type: ignore[typeddict-item]
                "y": uplot.Scale(range=up),
            }
            self._curve.axes = (
                uplot.Axis(label=label, labelSize=16, labelFont=FONT, font=FONT, size=26, **named),
                uplot.Axis(font=FONT, size=46),
            )
            self._curve.title = title
        self._curve.data = data
        self._heat.content = ""
        put(self._curve, visible=True)

    def heat(self, svg: str) -> None:
        put(self._heat, content=f'<div class="mm-heat">{svg}</div>')
        put(self._curve, visible=False)

    def points(self, head: Sequence[str], rows: Sequence[Row], here: int | None) -> None:
        """List points by their number, a button each that loads their settings."""
        if not rows:
            self._points.content = ""
            return
        cells = "".join(f"<span>{escape(word)}</span>" for word in head)
        listed = "".join(
            f'<button type="button" data-mm-point="{n}" aria-pressed="{str(n == here).lower()}" '
            f'title="Load these settings into the sliders">'
            + "".join(f"<span>{escape(typeset(cell))}</span>" for cell in row)
            + "</button>"
            for n, row in rows
        )
        self._points.content = f'<div class="mm-points"><p>{cells}</p>{listed}</div>'
