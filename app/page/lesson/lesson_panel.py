"""The dock of the lesson: one step at a time, with its text, equations, picture, and things to try."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from functools import partial
from html import escape

import viser

from app.drawing.palette import QUIET
from app.page.lesson.equations import equations_html, symbols_html, with_symbols
from app.page.lesson.figures.figure_slider import FigureSlider, place_of, shown
from app.page.lesson.lesson_texts import Exercise
from app.page.panels.html_widgets import Action, box, on_choice, on_press, put

BACK, NEXT, LEAVE = "◀ Back", "Next ▶", "Leave"
CHECK, DONE = "Check", "✓"
OPEN_SAMPLE = "Open {name}"
ANSWER, HIDE, PUT_BACK = "Show the answer", "Hide the answer", "Put it back"
NOTES = '<details class="mm-notes"><summary>For teachers</summary>'
BUTTONS = (  # what they do lesson.js does by itself
    '<span class="mm-aids"><button type="button" data-mm-link title="A link to this step, and its QR code">'
    'Link</button><button type="button" data-mm-presenter aria-pressed="false" '
    'title="The picture large, for a class. Press P">Present</button></span>'
)
WIDTH = 424
MOST_TRIALS, MOST_DIALS = 4, 3


def emphasised(text: str) -> str:
    """HTML of words, those between asterisks in italics, symbols with their indices below."""
    return with_symbols(re.sub(r"\*(\S[^*]*)\*", r"<em>\1</em>", escape(text)))


class LessonPanel:
    """Widgets; they know nothing of the method."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._titles: tuple[str, ...] = ("…",)
        self._first = 1  # number of the first step
        self._dials: tuple[FigureSlider, ...] = ()
        self._panel = gui.add_panel(visible=False)
        with self._panel.add_tab("Lesson", icon=viser.Icon.SCHOOL):
            self._moves = gui.add_button_group("", (BACK, NEXT, LEAVE))
            self._step = gui.add_dropdown("Step", self._titles)
            self._title = gui.add_html("")
            self._body = gui.add_markdown("")
            self._equations = gui.add_html("")
            self._missing = gui.add_html("", visible=False)
            self._sample_button = gui.add_button("…", color=QUIET, visible=False)
            self._picture = gui.add_html("")
            self._sliders = [
                gui.add_slider(f"dial {k + 1}", min=0, max=1, step=1, initial_value=0, visible=False)
                for k in range(MOST_DIALS)
            ]
            self._asks, self._buttons = [], []
            for _ in range(MOST_TRIALS):
                self._asks.append(gui.add_html("", visible=False))
                self._buttons.append(gui.add_button("…", color=QUIET, visible=False))
            self._check = gui.add_html("", visible=False)
            self._check_button = gui.add_button(CHECK, color=QUIET, visible=False)
            self._foot = gui.add_html("")
        self._panel.dock_left()
        self._panel.set_width(WIDTH)

    def connect(
        self,
        go: Callable[[int], None],
        move: Callable[[int], None],
        leave: Action,
        slide: Action,
        try_: Callable[[int], None],
        check: Action,
        take_sample: Action,
    ) -> None:
        """What is done where a person goes through the lesson.

        go    : to the step of this number, from 0
        move  : by so many steps from where one is
        slide : a slider of the picture was moved
        try_  : the thing to try of this number
        check : whether what the step asks for was done
        take_sample : the one that is offered is to be opened
        """
        moves = {BACK: partial(move, -1), NEXT: partial(move, 1), LEAVE: leave}
        self._moves.on_click(lambda event: moves[event.target.value]())

        def chosen() -> None:
            if self._step.value in self._titles:
                go(self._titles.index(self._step.value))

        on_choice(self._step, chosen)
        for slider in self._sliders:
            on_choice(slider, slide)
        on_press(*((button, partial(try_, k)) for k, button in enumerate(self._buttons)))
        on_press((self._check_button, check), (self._sample_button, take_sample))

    def visible(self, yes: bool) -> None:
        put(self._panel, visible=yes)
        if yes:
            self._panel.set_width(WIDTH)

    def contents(self, titles: Sequence[str], first: int, done: Collection[int] = ()) -> None:
        """Name the steps; ``first``: the number of the first of them; ``done``: numbers of those whose
        question was answered.
        """
        self._first = first
        ticks = dict.fromkeys(done, f" {DONE}")
        self._titles = tuple(f"{k}. {title}{ticks.get(k, '')}" for k, title in enumerate(titles, first))
        put(self._step, options=self._titles)

    def text(
        self,
        index: int,
        title: str,
        foot: str = "",
        sample: str = "",
        notes: str = "",
        done: Collection[int] = (),
    ) -> None:
        """Show the title of a step, and below it what a teacher should know.

        sample : name of the one that it is shown on; empty where it is none
        done   : numbers of the steps whose question was answered
        """
        put(self._step, value=self._titles[index])
        dots = "".join(f"<i{' data-on' if k <= index else ''}></i>" for k in range(len(self._titles)))
        first = self._first
        step, last = first + index, first + len(self._titles) - 1
        where = f"step {step} of {last}"
        self._title.content = (
            f'<div class="mm-lesson" data-step="{step}" data-first="{first}" data-last="{last}" '
            f'data-sample="{escape(sample)}" data-done="{",".join(map(str, sorted(done)))}">'
            f"<h3>{escape(title)}</h3>{BUTTONS}"
            f"<small>{len(done)} of {len(self._titles)} done</small>"
            f'<span class="mm-dots" role="img" aria-label="{where}" title="{where}">{dots}</span></div>'
        )
        told = f'<div class="mm-foot">{escape(foot)}</div>' if foot else ""
        self._foot.content = f"{NOTES}<p>{emphasised(notes)}</p></details>{told}" if notes else told

    def beside(self, words: str, equations: Sequence[str]) -> None:
        """Show what stands beside a picture: Markdown, and equations by their names."""
        put(self._body, content=with_symbols(words))
        put(self._equations, content=equations_html(equations) + symbols_html(equations))

    def check(self, ask: str, done: bool, said: str = "") -> None:
        """Show what a student is asked to do; empty where a step asks for nothing.

        said : what the page found when it was asked the last time
        """
        words = f" <b>{said}</b>" if said else ""
        tick = f" <b>{DONE} Done.</b>" if done else words
        attribute = " data-mm-done" if done else ""
        html = f'<div class="mm-check"{attribute}><b>Check yourself</b> {emphasised(ask)}{tick}</div>'
        put(self._check, content=html, visible=bool(ask))
        put(self._check_button, visible=bool(ask))

    def missing(self, words: str, sample: str) -> None:
        """Say what the maps do not show, and offer a sample that does; empty where they do."""
        put(self._missing, content=f'<div class="mm-missing">{emphasised(words)}</div>', visible=bool(words))
        put(self._sample_button, label=OPEN_SAMPLE.format(name=sample), visible=bool(words and sample))

    def broken(self, index: int, title: str, what: str) -> None:
        """Tell what is wrong with the text of a step."""
        self.text(index, title)
        self.beside("", ())
        self.picture("")
        self.dials((), ())
        self.trials((), ())
        self.check("", done=False)
        self.missing("", "")
        self._equations.content = box(f"This text cannot be read. {what}", "refused")

    def picture(self, svg: str) -> None:
        """Show a picture, or a line in its place."""
        if svg and not svg.startswith("<svg"):
            svg = f'<div class="mm-wait">{escape(svg)}</div>'
        self._picture.content = f'<div class="mm-frame">{svg}</div>' if svg else ""

    def dials(self, dials: tuple[FigureSlider, ...], places: Sequence[int]) -> None:
        """Show what can be moved in the picture, and where it stands."""
        self._dials = dials
        for k, slider in enumerate(self._sliders):
            there = k < len(dials) and dials[k].count > 1
            if there:
                dial = dials[k]
                ends = {"min": shown(dial, 0), "max": shown(dial, dial.count - 1)}
                put(slider, **ends, step=dial.step, label=dial.label)
                put(slider, value=shown(dial, places[k]))
            put(slider, visible=there)

    @property
    def places(self) -> tuple[int, ...]:
        """Where the dials stand."""
        return tuple(
            place_of(dial, float(slider.value)) if dial.count > 1 else 0
            for dial, slider in zip(self._dials, self._sliders, strict=False)
        )

    def trials(self, trials: Sequence[Exercise], answers: Sequence[str]) -> None:
        """Show what there is to try; ``answers``: the answer to each, "" where it is not shown yet."""
        for k, (ask, button) in enumerate(zip(self._asks, self._buttons, strict=True)):
            there = k < len(trials)
            if there:
                answer = f'<div class="mm-answer">{emphasised(answers[k])}</div>' if answers[k] else ""
                put(ask, content=f'<div class="mm-try"><b>Try</b> {emphasised(trials[k].ask)}{answer}</div>')
                on, off = (trials[k].button, PUT_BACK) if trials[k].button else (ANSWER, HIDE)
                put(button, label=off if answers[k] else on)
            put(ask, visible=there)
            put(button, visible=there)
