"""A setting swept on the loaded pair: what is asked for, how far it is, and what its points are good for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from algorithms.common.errors import SettingError
from algorithms.files.case_folder import Case
from algorithms.methods.registry import METHODS
from app.drawing.browser_messages import BrowserMessages
from app.evaluation.sweep import sweep_axes as axes
from app.evaluation.sweep.checkpoint import Checkpoint
from app.evaluation.sweep.parameter_sweep import SweepPlan, SweepPoint, done_before, sweep
from app.evaluation.sweep.sweep_files import sweep_files
from app.jobs.background_job import BackgroundJob, beside_the_page
from app.jobs.executor import Executor
from app.model.merge_inputs import MergeInputs
from app.model.settings import Setting, settings_of
from app.page.cancellable_task import DownloadTask
from app.page.page_state import PageState
from app.page.panels.settings_panel import FRONT, idle
from app.page.research import sweep_curves as curves
from app.page.research.comparison_controller import MAKING
from app.page.research.heatmap import heat_svg
from app.page.research.other_result import sentence
from app.page.research.sweep_panel import NOTHING, AxisFields, SweepPanel
from app.page.research.sweep_request import labelled, planned, suggestion
from app.page.run_controller import RunController
from app.report.result_files import zip_bytes
from app.web.browser_events import BrowserEvents

Swept = tuple[MergeInputs, Case | None, SweepPlan | None, dict[int, SweepPoint], Checkpoint]
"""A pair, and what was swept on it as far as it came; with the journal, to go on from there."""


class SweepController:
    """Of one tab.

    deliver  : sends a file, once it is made
    executor : makes what the points run on
    """

    def __init__(
        self,
        state: PageState,
        panel: SweepPanel,
        messages: BrowserMessages,
        events: BrowserEvents,
        runs: RunController,
        deliver: DownloadTask,
        executor: Callable[[int], Executor] = beside_the_page,
    ) -> None:
        self._state, self._panel, self._messages, self._runs = state, panel, messages, runs
        self._deliver, self._executor, self._locks = deliver, executor, state.locks
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
        self._work = BackgroundJob(self, self._locks.drawing, "sweep", panel.say)
        panel.connect(self._run, self._stop, self._choose, self._draw, self._save)
        events.on("point", self._load, n=int)
        events.on("along", self._along, share=float)
        state.subscribe("setup", self._setup_changed)
        state.subscribe("palette", self._draw)
        self._setup_changed()

    def close(self) -> None:
        self._work.stop()

    # --- what the page tells ----------------------------------------------------------------------

    def _setup_changed(self) -> None:
        """A sweep of other inputs is forgotten; of other settings it is drawn beside those of now."""
        with self._locks.drawing:
            old, self._pair = self._pair, self._state.inputs
            if not self._pair.same_pair(old):
                self._work.stop()
                self._case = self._plan = None
                self._points.clear()
                self._panel.clear()
                self._panel.say("")
            self._offer()
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
        method, config = self._state.method, self._state.config
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

    def _choose(self, fields: AxisFields) -> None:
        with self._locks.action, self._locks.drawing:
            self._suggest(fields)

    def _suggest(self, fields: AxisFields) -> None:
        setting = self._settings.get(fields.setting.value)
        fields.suggest(setting, *suggestion(setting, self._state.config))

    def _run(self) -> None:
        with self._locks.action, self._locks.drawing:
            case = self._state.inputs.case()
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
        method, seed = self._state.method, self._state.seed
        seeds = tuple(range(seed, seed + self._panel.seeds))
        return planned(method, self._state.config, self._settings, x, y, seeds)

    def _stop(self) -> None:
        with self._locks.action, self._locks.drawing:
            if self._work.stop():
                self._panel.say(f"Stopped. {self._count()} Sweep again to go on.")
            self._draw()

    def _load(self, n: int) -> None:
        """A point was pressed: its settings go into the sliders."""
        with self._locks.action:
            plan = self._plan
            if plan is not None and n in self._points:
                self._runs.load_settings(plan.method, self._configs[n])

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
            self._deliver(MAKING, "sweep.zip", lambda check: zip_bytes(sweep_files(case, plan, points)))

    # --- what the work tells ----------------------------------------------------------------------

    def part_done(self, part: SweepPoint) -> None:
        self._points[self._numbers[part.x, part.y]] = part
        done, total = len(self._points), len(self._numbers)
        fresh, left = done - self._known, ""
        if fresh > 0 and done < total:
            left = f" About {max(1, round(self._work.seconds / fresh * (total - done)))} s left."
        self._panel.say(f"{self._count()}{left}", done / total)
        self._draw()

    def ended(self, why: str) -> None:
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
        if plan is None or plan.method != self._state.method:
            return None
        return next((n for n, found in enumerate(self._configs) if found == self._state.config), None)

    def _draw(self) -> None:
        with self._locks.drawing:
            plan, points = self._plan, self._points
            self._panel.possible(self._pair.complete, self._work.busy, bool(points))
            if plan is None:
                return
            here, measure = self._here, self._panel.measure
            self._messages.hud(measure=measure)  # the button that is seen to be pressed
            self._messages.flush()
            if plan.y is not None:
                palette = self._state.palette
                self._panel.heat(heat_svg(plan, points, measure, self._judged, here, palette))
                self._panel.points((), (), None)
                return
            label, title = plan.setting(plan.x).label, curves.title_of(measure, plan, self._judged)
            across, up = curves.reach(plan.x), curves.height(plan, points, measure)
            data = curves.columns(plan, points, measure, here)
            log = curves.by_factor(plan.x)
            self._panel.curve(title, label, curves.ticks(plan), log, across, up, data)
            counted = curves.RIGHT if self._judged else curves.ACCEPTED
            listed = curves.AGREEMENT, counted, curves.TIME
            rows = [(n, curves.row(plan, points[n], listed)) for n in sorted(points)]
            self._panel.points((label, "eq. (23)", counted.lower(), "time"), rows, here)
