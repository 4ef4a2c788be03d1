"""Several methods on the loaded pair: what is chosen, what runs, what came of each, which is looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from threading import Event, RLock
from typing import Protocol

import numpy as np
import viser

from algorithms.methods.registry import DEFAULT_METHOD, METHODS
from app.drawing.png import png_base64
from app.drawing.svg.thumbnail import thumbnail
from app.evaluation.comparison_files import contest_archive
from app.evaluation.method_comparison import ComparedRun, compare_methods
from app.jobs.background_job import BackgroundJob, beside_the_page
from app.jobs.executor import Executor
from app.model.merge_inputs import MergeInputs
from app.page.research.comparison_panel import ALL, FAMILIES, Card, ComparePanel, CompareWishes
from app.page.research.host import ResearchHost
from app.page.research.other_result import OtherResult
from app.page.research.run_summary import outcome_of
from app.web.browser_events import BrowserEvents

FIRST = (DEFAULT_METHOD, "paper-argmax", "sift")  # ticked in the beginning: quick, and one of each family


class Host(ResearchHost, Protocol):
    """The page, as far as it is asked from here."""

    def look(self, guest: OtherResult) -> None:
        """Show what a method has found over map 1."""

    def back(self) -> None:
        """Show one's own result again."""


class ComparisonController:
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
        self._chosen = {name for name in FIRST if name in METHODS}
        self._pair = MergeInputs()
        self._found: dict[str, OtherResult] = {}
        self._pictures: dict[str, str] = {}
        self._asked: list[str] = []  # of the run at hand, in their order
        self._waiting: list[str] = []  # of those, whose end is not known yet
        self._guest: OtherResult | None = None
        wishes = CompareWishes(self._run, self._stop, self._group, self._save)
        self._panel = ComparePanel(gui, wishes)
        self._work = BackgroundJob(self, drawing, "comparison", self._panel.say)
        channel.on("pick", self._pick, method=tuple(METHODS), yes=bool)
        channel.on("show", self._show, method=tuple(METHODS))
        self._draw()

    def close(self) -> None:
        """The tab is gone."""
        self._work.stop()

    # --- what the page tells ----------------------------------------------------------------------

    def loaded(self, inputs: MergeInputs) -> None:
        """These inputs are on the page; what was found on others is forgotten."""
        old, self._pair = self._pair, inputs
        if not inputs.same_pair(old):
            self._work.stop()
            self._waiting.clear()
            self._found.clear()
            self._pictures.clear()
            self._panel.say("")
        self._draw()

    def changed(self) -> None:
        """A setting, the method or the seed is another: what was found may be out of date."""
        self._draw()

    def recoloured(self) -> None:
        """The page is dark, or light again."""
        self._pictures.clear()
        self._draw()

    def shown(self, guest: OtherResult | None) -> None:
        """This lies over map 1 now; None: the page's own."""
        if self._guest is not guest:
            self._guest = guest
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
        with self._turn, self._drawing:
            (self._chosen.add if yes else self._chosen.discard)(method)
            self._draw()

    def _group(self, word: str) -> None:
        with self._turn, self._drawing:
            words = {family: short for family, (_, short) in FAMILIES.items()}
            self._chosen = {name for name, method in METHODS.items() if word in (ALL, words[method.family])}
            self._draw()

    def _run(self) -> None:
        with self._turn, self._drawing:
            i, seed = self._host.inputs, self._host.seed
            case = i.case()
            if case is None or not self._chosen:
                return
            self._asked = [name for name in METHODS if name in self._chosen]
            self._waiting = list(self._asked)
            for name in self._asked:
                self._found.pop(name, None)
                self._pictures.pop(name, None)
            configs = {name: self._host.settings_for(name) for name in self._asked}

            def work(stop: Event) -> Iterator[tuple[OtherResult, str]]:
                pairs = [(case.name, case)]
                for score in compare_methods(pairs, configs, self._executor(1), seed, stop):
                    guest = OtherResult(score.method, configs[score.method], seed, score.trial)
                    yield guest, self._painted(guest, i)  # here nobody waits for it

            self._work.start(work)
            self._draw()

    def _stop(self) -> None:
        with self._turn, self._drawing:
            if self._work.stop():
                self._panel.say(f"Stopped. {self._count()}")
            self._waiting.clear()
            self._draw()

    def _show(self, method: str) -> None:
        """A card was pressed: look at it, or back where it is looked at already."""
        with self._turn:
            guest = self._found.get(method)
            if guest is None or guest.trial.pose is None:
                return
            if guest is self._guest:
                self._host.back()
            else:
                self._host.look(guest)

    def _save(self) -> None:
        case = self._pair.case()
        if case is None or not self._found:
            return
        scores = [ComparedRun(case.name, name, guest.trial) for name, guest in self._found.items()]
        configs = {name: guest.config for name, guest in self._found.items()}
        self._host.save("compared.zip", lambda: contest_archive(case, scores, configs, self._host.seed))

    # --- what the work tells ----------------------------------------------------------------------

    def told(self, part: tuple[OtherResult, str]) -> None:
        """A method has ended."""
        guest, picture = part
        self._found[guest.method], self._pictures[guest.method] = guest, picture
        self._waiting.remove(guest.method)
        self._panel.say(self._count(), 1 - len(self._waiting) / len(self._asked))
        self._draw()

    def over(self, why: str) -> None:
        """All have ended, or no further one can."""
        self._waiting.clear()
        self._panel.say(why or f"{self._count()} It took {self._work.seconds:.1f} s.")
        self._draw()

    def _count(self) -> str:
        done = sum(name in self._found for name in self._asked)
        return f"{done} of {len(self._asked)} done."

    # --- drawing ----------------------------------------------------------------------------------

    def _draw(self) -> None:
        with self._drawing:
            self._panel.possible(len(self._chosen), self._pair.complete, self._work.busy, bool(self._found))
            self._panel.show({name: self._card(name) for name in METHODS})

    def _card(self, name: str) -> Card:
        card, guest = Card(name in self._chosen), self._found.get(name)
        if name in self._waiting:
            return replace(card, state="runs" if name == self._waiting[0] else "waits")
        if guest is None:
            return card
        default = guest.config == METHODS[name].defaults
        current = guest.config == self._host.settings_for(name) and guest.seed == self._host.seed
        return replace(
            card,
            state="done",
            outcome=outcome_of(guest.trial),
            picture=self._picture(guest),
            shown=guest is self._guest,
            old="" if current else "out of date",
            note="" if default else "your settings",
        )

    def _picture(self, guest: OtherResult) -> str:
        """The merged map as a data URI; made once in the colours of the page."""
        if guest.method not in self._pictures:
            self._pictures[guest.method] = self._painted(guest, self._pair)
        return self._pictures[guest.method]

    def _painted(self, guest: OtherResult, i: MergeInputs) -> str:
        pose = guest.trial.pose
        if pose is None or i.ref is None or i.mov is None:
            return ""
        pixels = thumbnail(i.ref, i.mov, pose, self._host.palette)
        opaque = np.full((*pixels.shape[:2], 1), 255, dtype=np.uint8)
        return f"data:image/png;base64,{png_base64(np.concatenate([pixels, opaque], axis=2))}"
