"""Draws the step of the lesson at hand: its words and its picture in the dock, its run on the map."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from app.drawing.draw_items import Item
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.lesson.checks.effects import missing
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.figures.figure_slider import FigureSlider, place_of
from app.page.lesson.lesson_panel import LessonPanel
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.lesson_texts import StepText, filled
from app.page.lesson.placeholders import numbers_of
from app.page.page_display import PageDisplay
from app.page.page_state import PageState
from app.system import data_paths as paths

OWN = "Your own settings and results come back when you leave."
WAIT = "Working it out on these maps …"
NO_MAPS = "The lesson is about two maps and a sighting: load them, or choose the sighting as what you know."
SAMPLE_HAS = "A sample has two maps and a sighting."
NAMED = "office_r2_r1"  # the sample that is offered where there is nothing to show
NOT_HERE = "The method as it is set does not come to this. Choose another method, or put its settings back."


@dataclass(frozen=True)
class OnMap:
    """What a step shows on the map.

    run  : as far as the step goes
    ink  : what is drawn over it
    turn : by which map 2 is turned beside map 1; None: not at all
    busy : whether it is being worked out
    done : share of that, where it is known
    """

    run: RunState
    ink: list[Item] | None = None
    turn: float | None = None
    busy: bool = False
    done: float | None = None


class LessonDisplay:
    """Draws a step; whoever calls is drawing; ``places`` of the dials: empty where they begin."""

    def __init__(self, state: PageState, display: PageDisplay, panel: LessonPanel) -> None:
        self._state, self._display, self._panel = state, display, panel
        self.places: tuple[int, ...] = ()
        self._dials: tuple[FigureSlider, ...] = ()  # those of the picture that is shown
        self.way = ""  # in which a thing to try has the picture drawn

    def dock(self, open_: bool, turned: bool) -> None:
        """Open the dock or close it; ``turned``: the map is in view from now on, and was not before."""
        self._panel.visible(open_)
        self._display.show_research(open_ or self._state.research)  # the sliders move the lesson, too
        self._display.views.comparison.clear()
        self._display.clear_read_out()
        self._display.messages.layer("lesson", None)
        if turned:
            self._display.show_view()
        self._display.show_buttons()

    def words(
        self,
        index: int,
        text: StepText,
        lesson: LessonRun,
        answered: Collection[int],
        done: Collection[int] = (),
    ) -> None:
        """Show a step's title and what to try, and say where the maps do not show what it is about.

        answered : numbers of those things to try whose answers are shown
        done     : numbers of the steps whose question was answered
        """
        numbers, told = numbers_of(lesson) if lesson.possible else {}, lesson.inputs.names.told
        sample = lesson.inputs.name if lesson.inputs.name in paths.samples() else ""
        self._panel.text(index, told(text.title), OWN, sample, filled(told(text.notes), numbers), done)
        answers = enumerate(filled(told(trial.answer), numbers) for trial in text.trials)
        self._panel.trials(
            [replace(trial, ask=told(trial.ask)) for trial in text.trials],
            [answer if k in answered else "" for k, answer in answers],
        )

        effect = text.effect
        if effect is not None and missing(effect.test, lesson):
            self._panel.missing(filled(told(effect.missing), numbers), effect.sample)
        elif not lesson.inputs.sighted:
            self._panel.missing(SAMPLE_HAS, NAMED)
        else:
            self._panel.missing("", "")

    def question(self, text: StepText, lesson: LessonRun, done: bool, said: str) -> None:
        """Show what a step asks for; ``said``: what was found when it was checked the last time."""
        numbers, told = numbers_of(lesson) if lesson.possible else {}, lesson.inputs.names.told
        ask = filled(told(text.check.ask), numbers) if text.check is not None else ""
        self._panel.check(ask, done, said)

    def draw_as(self, picture: str, way: str) -> None:
        """Draw a picture in another way from now on, its dials where that is seen."""
        self.way, self.places = way, PICTURES[picture].ways[way].places

    def move(self, dials: Sequence[float], values: Sequence[float]) -> None:
        """Dials by their numbers, moved to where they show these values by a handle in the picture."""
        places = list(self.places)
        for dial, value in zip(dials, values, strict=False):
            if dial in range(len(places)):
                places[int(dial)] = place_of(self._dials[int(dial)], value)
        self.places = tuple(places)

    def picture(self, text: StepText, lesson: LessonRun, done: bool) -> OnMap:
        """Draw a step's picture, or say why there is none yet, and what stands beside it; what belongs to it
        on the map.

        done : the run has come to its end
        """
        palette, picture = self._state.palette, PICTURES.get(text.picture)
        if picture is None or not lesson.possible or not lesson.reached(*picture.needs):
            waiting = "" if picture is None else NO_MAPS if not lesson.inputs.sighted else WAIT
            over = done or not lesson.possible
            self._beside(text, lesson, ())
            self._panel.picture(NOT_HERE if waiting == WAIT and over else waiting)
            self._panel.dials((), ())
            return OnMap(RunState(lesson.config), busy=waiting == WAIT and not over)
        way = picture.ways.get(self.way)
        dials = picture.dials(lesson) if way is None or way.dials is None else way.dials
        places, self._dials = self._placed(dials), dials
        self._panel.dials(dials, places)
        self._beside(text, lesson, places)
        svg = (way or picture).draw(lesson, places, palette)
        self._panel.picture(lesson.inputs.names.told_in_html(svg))
        ink = picture.ink(lesson, places, self._display.views.map.layout, palette)
        turn = picture.turn(lesson, places) if picture.turn else None
        runs = lesson.sides.get(text.picture)
        share = None if runs is None else runs.done
        return OnMap(picture.run(lesson, places), ink, turn, busy=share is not None, done=share)

    def _beside(self, text: StepText, lesson: LessonRun, places: tuple[int, ...]) -> None:
        """Show words and equations; where the picture has parts, those of the part that its dial shows."""
        part = places[0] if places else 0
        numbers = numbers_of(lesson) if lesson.possible else {}
        words = lesson.inputs.names.told_in_html(text.words(part))
        self._panel.beside(filled(words, numbers), text.formulas(part))

    def on_map(self, step: OnMap, says: str, look: bool) -> None:
        """Draw the state's run on the map, and what the lesson draws over it.

        says : the sentence over the map
        look : the camera goes there, too
        """
        messages = self._display.messages
        with self._display.together():
            self._display.show_lesson_step(look, step.turn)
            messages.layer("lesson", step.ink if self._state.view == MAP else None)
            messages.hud(state=says, mood="running" if step.busy else "idle", progress=step.done)
            self._display.show_legend()
            messages.flush()

    def _placed(self, dials: tuple[FigureSlider, ...]) -> tuple[int, ...]:
        """Where the dials stand, or where they begin."""
        if len(self.places) != len(dials):
            self.places = tuple(dial.start for dial in dials)
        self.places = tuple(min(k, dial.count - 1) for k, dial in zip(self.places, dials, strict=True))
        return self.places
