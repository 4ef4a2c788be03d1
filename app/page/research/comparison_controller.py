"""Several methods on the loaded pair: what is chosen, what runs, what came of each, which is looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from threading import Event
from typing import Any

import numpy as np

from algorithms.methods.registry import DEFAULT_METHOD
from app.drawing.png import png_base64
from app.drawing.svg.thumbnail import thumbnail
from app.evaluation.compared_methods import COMPARED
from app.evaluation.comparison_files import contest_archive
from app.evaluation.method_comparison import ComparedRun, compare_methods
from app.jobs.background_job import BackgroundJob, beside_the_page
from app.jobs.executor import Executor
from app.model.merge_inputs import MergeInputs
from app.page.cancellable_task import DownloadTask
from app.page.page_state import PageState
from app.page.research.comparison_panel import ALL, FAMILIES, Card, ComparePanel
from app.page.research.other_result import OtherResult, outcome_of
from app.page.research.other_result_controller import OtherResultController
from app.web.browser_events import BrowserEvents

MAKING = "Making the files: tables and pictures."
FIRST = (DEFAULT_METHOD, "paper-argmax", "sift")  # ticked in the beginning: quick, and one of each family


class ComparisonController:
    """Of one tab.

    deliver  : sends a file, once it is made
    executor : makes what the methods run on
    """

    def __init__(
        self,
        state: PageState,
        panel: ComparePanel,
        events: BrowserEvents,
        others: OtherResultController,
        deliver: DownloadTask,
        executor: Callable[[int], Executor] = beside_the_page,
    ) -> None:
        self._state, self._panel, self._others = state, panel, others
        self._deliver, self._executor, self._locks = deliver, executor, state.locks
        self._chosen = {name for name in FIRST if name in COMPARED}
        self._pair = MergeInputs()
        self._found: dict[str, OtherResult] = {}
        self._pictures: dict[str, str] = {}
        self._asked: list[str] = []  # of the run at hand, in their order
        self._waiting: list[str] = []  # of those, whose end is not known yet
        self._work = BackgroundJob(self, self._locks.drawing, "comparison", panel.say)
        panel.connect(self._run, self._stop, self._group, self._save)
        events.on("pick", self._pick, method=tuple(COMPARED), yes=bool)
        events.on("show", self._show, method=tuple(COMPARED))
        state.subscribe("setup", self._setup_changed)
        state.subscribe("other", self._draw)
        state.subscribe("palette", self._recolour)
        self._setup_changed()

    def close(self) -> None:
        self._work.stop()

    # --- what the page tells ----------------------------------------------------------------------

    def _setup_changed(self) -> None:
        """What was found on other inputs is forgotten; with other settings it is out of date."""
        old, self._pair = self._pair, self._state.inputs
        if not self._pair.same_pair(old):
            self._work.stop()
            self._waiting.clear()
            self._found.clear()
            self._pictures.clear()
            self._panel.say("")
        self._draw()

    def _recolour(self) -> None:
        self._pictures.clear()
        self._draw()

    @property
    def found(self) -> tuple[MergeInputs, dict[str, OtherResult], set[str]]:
        """The pair, what came of methods on it, and those that are ticked: for a tab that is reloaded."""
        return self._pair, dict(self._found), set(self._chosen)

    def resume(self, found: tuple[MergeInputs, dict[str, OtherResult], set[str]] | None) -> None:
        """Take up what an earlier tab had found on the pair that is loaded."""
        if found is not None and found[0].same_pair(self._pair):
            _, self._found, self._chosen = found
            self._draw()

    # --- what a person asks for -------------------------------------------------------------------

    def _pick(self, method: str, yes: bool) -> None:
        with self._locks.action, self._locks.drawing:
            (self._chosen.add if yes else self._chosen.discard)(method)
            self._draw()

    def _group(self, word: str) -> None:
        with self._locks.action, self._locks.drawing:
            words = {family: short for family, (_, short) in FAMILIES.items()}
            self._chosen = {name for name, method in COMPARED.items() if word in (ALL, words[method.family])}
            self._draw()

    def _run(self) -> None:
        with self._locks.action, self._locks.drawing:
            i, seed = self._state.inputs, self._state.seed
            case = i.case()
            if case is None or not self._chosen:
                return
            self._asked = [name for name in COMPARED if name in self._chosen]
            self._waiting = list(self._asked)
            for name in self._asked:
                self._found.pop(name, None)
                self._pictures.pop(name, None)
            configs = {name: self._config_of(name) for name in self._asked}

            def work(stop: Event) -> Iterator[tuple[OtherResult, str]]:
                pairs = [(case.name, case)]
                for score in compare_methods(pairs, configs, self._executor(1), seed, stop):
                    other = OtherResult(score.method, configs[score.method], seed, score.trial)
                    yield other, self._painted(other, i)  # here nobody waits for it

            self._work.start(work)
            self._draw()

    def _config_of(self, name: str) -> Any:
        return self._state.config_for(COMPARED[name].method)

    def _stop(self) -> None:
        with self._locks.action, self._locks.drawing:
            if self._work.stop():
                self._panel.say(f"Stopped. {self._count()}")
            self._waiting.clear()
            self._draw()

    def _show(self, method: str) -> None:
        """A card was pressed: look at it, or back where it is looked at already."""
        with self._locks.action:
            other = self._found.get(method)
            if other is None or other.trial.pose is None:
                return
            if other is self._state.other:
                self._others.back()
            else:
                self._others.look(other)

    def _save(self) -> None:
        case = self._pair.case()
        if case is None or not self._found:
            return
        scores = [ComparedRun(case.name, name, other.trial) for name, other in self._found.items()]
        configs = {name: other.config for name, other in self._found.items()}
        seed = self._state.seed
        self._deliver(MAKING, "compared.zip", lambda check: contest_archive(case, scores, configs, seed))

    # --- what the work tells ----------------------------------------------------------------------

    def part_done(self, part: tuple[OtherResult, str]) -> None:
        other, picture = part
        self._found[other.method], self._pictures[other.method] = other, picture
        self._waiting.remove(other.method)
        self._panel.say(self._count(), 1 - len(self._waiting) / len(self._asked))
        self._draw()

    def ended(self, why: str) -> None:
        self._waiting.clear()
        self._panel.say(why or f"{self._count()} It took {self._work.seconds:.1f} s.")
        self._draw()

    def _count(self) -> str:
        done = sum(name in self._found for name in self._asked)
        return f"{done} of {len(self._asked)} done."

    # --- drawing ----------------------------------------------------------------------------------

    def _draw(self) -> None:
        with self._locks.drawing:
            self._panel.possible(len(self._chosen), self._pair.complete, self._work.busy, bool(self._found))
            self._panel.show({name: self._card(name) for name in COMPARED})

    def _card(self, name: str) -> Card:
        card, other = Card(name in self._chosen), self._found.get(name)
        if name in self._waiting:
            return replace(card, state="runs" if name == self._waiting[0] else "waits")
        if other is None:
            return card
        default = other.config == COMPARED[name].defaults
        current = other.config == self._config_of(name) and other.seed == self._state.seed
        return replace(
            card,
            state="done",
            outcome=outcome_of(other.trial, self._pair.names),
            picture=self._picture(other),
            shown=other is self._state.other,
            old="" if current else "out of date",
            note="" if default else "your settings",
            names=self._pair.names,
        )

    def _picture(self, other: OtherResult) -> str:
        """The merged map as a data URI; made once in the colours of the page."""
        if other.method not in self._pictures:
            self._pictures[other.method] = self._painted(other, self._pair)
        return self._pictures[other.method]

    def _painted(self, other: OtherResult, i: MergeInputs) -> str:
        pose = other.trial.pose
        if pose is None or i.ref is None or i.mov is None:
            return ""
        pixels = thumbnail(i.ref, i.mov, pose, self._state.palette)
        opaque = np.full((*pixels.shape[:2], 1), 255, dtype=np.uint8)
        return f"data:image/png;base64,{png_base64(np.concatenate([pixels, opaque], axis=2))}"
