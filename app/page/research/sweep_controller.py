"""A setting swept on the loaded pair: what is asked for, how far it is, and what its points are good for."""

from __future__ import annotations

from collections.abc import Callable
from threading import RLock
from typing import Any, Protocol

import viser

from algorithms.common.errors import SettingError
from algorithms.files.case_folder import Case
from algorithms.methods.registry import METHODS
from app.evaluation import sweep_axes as axes
from app.evaluation.checkpoint import Checkpoint
from app.evaluation.parameter_sweep import SweepPlan, SweepPoint, done_before, sweep
from app.evaluation.sweep_files import sweep_archive
from app.jobs.background_job import BackgroundJob, beside_the_page
from app.jobs.executor import Executor
from app.model.merge_inputs import MergeInputs
from app.model.settings import Setting, settings_of
from app.page.panels.settings_panel import FRONT, idle
from app.page.research import sweep_curves as curves
from app.page.research.heatmap import heat_svg
from app.page.research.host import ResearchHost
from app.page.research.run_summary import sentence
from app.page.research.sweep_panel import NOTHING, SweepPanel, SweepWishes
from app.page.research.sweep_request import labelled, planned, suggestion
from app.web.browser_events import BrowserEvents

Swept = tuple[MergeInputs, Case | None, SweepPlan | None, dict[int, SweepPoint], Checkpoint]
"""A pair, and what was swept on it as far as it came; with the journal, to go on from there."""


class Host(ResearchHost, Protocol):
    """The page, as far as it is asked from here."""

    @property
    def method(self) -> str:
        """The method of the panel."""

    def mark(self, measure: str) -> None:
        """Let the button of this measure be seen to be the chosen one."""

    def load_settings(self, method: str, config: Any) -> None:
        """Put settings into the sliders, as if a person had moved them."""


class SweepController:
    """Of one tab. ``turn`` and ``drawing`` as in the page: the first is taken before the second."""

    def __init__(
        self,
        gui: viser.GuiApi,
        channel: BrowserEvents,
        turn: RLock,
        drawing: RLock,
        host: Host,
        executor: Callable[[int], Executor] = beside_the_page,
    ) -> None:
        self._host, self._turn, self._drawing, self._executor = host, turn, drawing, executor
        self._settings: dict[str, Setting] = {}
        self._offered: Any = None
        self._pair = MergeInputs()
        self._case: Case | None = None  # of the plan
        self._plan: SweepPlan | None = None
        self._points: dict[int, SweepPoint] = {}
        self._numbers: dict[tuple[Any, Any], int] = {}  # of the places of the plan
        self._configs: list[Any] = []  # there
        self._journal = Checkpoint()  # what was swept before in this tab is not merged again
        self._known = 0
        self._panel = SweepPanel(gui, SweepWishes(self._run, self._stop, self._chose, self._draw, self._save))
        self._work = BackgroundJob(self, drawing, "sweep", self._panel.say)
        channel.on("point", self._load, n=int)
        channel.on("along", self._along, share=float)
        self.loaded(MergeInputs())

    def close(self) -> None:
        """The tab is gone."""
        self._work.stop()

    # --- what the page tells ----------------------------------------------------------------------

    def loaded(self, inputs: MergeInputs) -> None:
        """These inputs are on the page, these settings in its panel; a sweep of others is forgotten."""
        with self._drawing:
            old, self._pair = self._pair, inputs
            if not inputs.same_pair(old):
                self._work.stop()
                self._case = self._plan = None
                self._points.clear()
                self._panel.clear()
                self._panel.say("")
            self._offer()
            self._draw()

    def recoloured(self) -> None:
        """The page is dark, or light again."""
        self._draw()

    @property
    def swept(self) -> Swept:
        """The pair and what was swept on it: for a tab that is reloaded."""
        return self._pair, self._case, self._plan, dict(self._points), self._journal

    def resume(self, swept: Swept | None) -> None:
        """Take up what an earlier tab had swept; unfinished, it goes on where that was left."""
        if swept is None:
            return
        pair, case, plan, points, self._journal = swept
        if case is not None and plan is not None and pair.same_pair(self._pair):
            self._begin(case, plan)
            self._points = points
            self._panel.say(self._count())
            self._draw()

    def _offer(self) -> None:
        """The settings of the method that do anything, by their labels."""
        method = self._host.method
        config = self._host.settings_for(method)
        found = [each for each in settings_of(config) if not idle(config, each.path)]
        offered = (method, tuple(each.path for each in found))
        if offered == self._offered:
            return
        self._offered = offered
        found.sort(key=lambda each: FRONT.index(each.path) if each.path in FRONT else len(FRONT))
        self._settings = labelled(found)
        self._panel.tell_method(METHODS[method].title)
        for fields, fallback in zip(self._panel.axes, (self._first(), NOTHING), strict=True):
            chosen = fields.setting.value
            known = chosen in self._settings
            fields.offer(tuple(self._settings), chosen if known else fallback)
            if not known or fields.untouched:
                self._suggest(fields)

    def _first(self) -> str:
        """What is offered first: the spread, whose influence the paper looks at; or whatever there is."""
        spread = (label for label, each in self._settings.items() if each.path == axes.SPREAD)
        return next(spread, next(iter(self._settings), NOTHING))

    # --- what a person asks for -------------------------------------------------------------------

    def _chose(self, which: int) -> None:
        with self._turn, self._drawing:
            self._suggest(self._panel.axes[which])

    def _suggest(self, fields: Any) -> None:
        setting = self._settings.get(fields.setting.value)
        config = self._host.settings_for(self._host.method)
        fields.suggest(setting, *suggestion(setting, config))

    def _run(self) -> None:
        with self._turn, self._drawing:
            case = self._host.inputs.case()
            if case is None:
                return
            try:
                plan = self._planned()
            except SettingError as error:
                self._panel.say(sentence(str(error)))
                return
            self._begin(case, plan)
            self._known = done_before(case, plan, self._journal)
            jobs = len(plan.places()) - self._known
            self._work.start(
                lambda stop: sweep(case, plan, self._executor(max(1, jobs)), self._journal, stop)
            )
            self._draw()

    def _begin(self, case: Case, plan: SweepPlan) -> None:
        """This is what is swept from now on."""
        self._case, self._plan, self._points = case, plan, {}
        self._numbers = {place: n for n, place in enumerate(plan.places())}
        self._configs = [plan.config_at(*place) for place in plan.places()]
        self._panel.offer(judged=self._judged)

    def _planned(self) -> SweepPlan:
        """What the fields ask for; raises SettingError."""
        x, y = (fields.wanted for fields in self._panel.axes)
        method, seed = self._host.method, self._host.seed
        seeds = tuple(range(seed, seed + self._panel.seeds))
        return planned(method, self._host.settings_for(method), self._settings, x, y, seeds)

    def _stop(self) -> None:
        with self._turn, self._drawing:
            if self._work.stop():
                self._panel.say(f"Stopped. {self._count()} Sweep again to go on.")
            self._draw()

    def _load(self, n: int) -> None:
        """A point was pressed: its settings go into the sliders."""
        with self._turn:
            plan = self._plan
            if plan is not None and n in self._points:
                self._host.load_settings(plan.method, self._configs[n])

    def _along(self, share: float) -> None:
        """The chart was pressed, so far along its axis."""
        plan = self._plan
        if plan is not None and plan.y is None and 0 <= share <= 1:
            n = curves.nearest(plan, self._points, share)
            if n is not None:
                self._load(n)

    def _save(self) -> None:
        case, plan, points = self._case, self._plan, list(self._points.values())
        if case is not None and plan is not None and points:
            self._host.save("sweep.zip", lambda: sweep_archive(case, plan, points))

    # --- what the work tells ----------------------------------------------------------------------

    def told(self, part: SweepPoint) -> None:
        """A point is there."""
        self._points[self._numbers[part.x, part.y]] = part
        done, total = len(self._points), len(self._numbers)
        fresh, seconds = done - self._known, self._work.seconds
        left = ""
        if fresh > 0 and done < total:
            left = f" About {max(1, round(seconds / fresh * (total - done)))} s left."
        self._panel.say(f"{self._count()}{left}", done / total)
        self._draw()

    def over(self, why: str) -> None:
        """All points are there, or no further one can be."""
        lost = next((point.failed for point in self._points.values() if point.failed), "")
        said = f"{self._count()} It took {self._work.seconds:.1f} s."
        self._panel.say(why or (f"{said} Could not be run: {sentence(lost)}" if lost else said))
        self._draw()

    def _count(self) -> str:
        return f"{len(self._points)} of {len(self._numbers)} points."

    # --- drawing ----------------------------------------------------------------------------------

    @property
    def _judged(self) -> bool:
        """Whether transforms can be called right or wrong."""
        return self._case is not None and self._case.truth is not None

    @property
    def _here(self) -> int | None:
        """The point whose settings the sliders have."""
        plan = self._plan
        if plan is None or plan.method != self._host.method:
            return None
        config = self._host.settings_for(plan.method)
        return next((n for n, found in enumerate(self._configs) if found == config), None)

    def _draw(self) -> None:
        with self._drawing:
            plan, points = self._plan, self._points
            self._panel.possible(self._pair.complete, self._work.busy, bool(points))
            if plan is None:
                return
            here, measure = self._here, self._panel.measure
            self._host.mark(measure)
            if plan.y is not None:
                palette = self._host.palette
                self._panel.heat(heat_svg(plan, points, measure, self._judged, here, palette))
                self._panel.points((), (), None)
                return
            label = plan.setting(plan.x).label
            self._panel.curve(
                curves.title_of(measure, plan, self._judged),
                label,
                curves.ticks(plan),
                curves.by_factor(plan.x),
                curves.reach(plan.x),
                curves.height(plan, points, measure),
                curves.columns(plan, points, measure, here),
            )
            counted = curves.RIGHT if self._judged else curves.ACCEPTED
            rows = [
                (n, (curves.word_of(plan, plan.x, points[n].x), *self._numbers_of(points[n], counted)))
                for n in sorted(points)
            ]
            self._panel.points((label, "eq. (23)", counted.lower(), "time"), rows, here)

    def _numbers_of(self, point: SweepPoint, counted: str) -> list[str]:
        listed = curves.AGREEMENT, counted, curves.TIME
        told = [(measure, curves.reading(point, measure)) for measure in listed]
        return ["–" if found is None else curves.text_of(found.middle, measure) for measure, found in told]
