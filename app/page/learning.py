"""The part of a page that is about the lesson and the museum: what they borrow, and how it comes back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import viser

from algorithms.common.errors import MapMergeError
from algorithms.methods.steps import AugmentDetail
from app.drawing.draw_items import Item
from app.drawing.legend import legend
from app.drawing.scene_layout import SceneLayout
from app.model.merge_inputs import Files, MergeInputs
from app.model.run_state import RunState
from app.model.view_modes import LESSON, MAP, MUSEUM
from app.page.lesson.lesson_controller import LessonController
from app.page.lesson.lesson_texts import lesson_folder, museum_folder
from app.page.lesson.museum_controller import MuseumController
from app.page.page_snapshot import PageSnapshot
from app.page.part import Part


class Learning(Part):
    """The part of a Page that teaches."""

    def _learn_with(self, gui: viser.GuiApi, lesson: Path | None) -> None:
        """Add both to the page; ``lesson`` is the folder of its texts, None for those that come along."""
        self._lesson = LessonController(self, gui, self._tuning, self._turn, lesson or lesson_folder())
        self._museum = MuseumController(self, gui, self._turn, museum_folder())
        self._channel.on("left", self._left)

    def _left(self) -> None:
        """The lesson's dock is gone: that of the plots, which came beside it, gets its width."""
        if not self._lesson.open:
            self._plots.visible(True)

    def _learn(self, what: str) -> None:
        """Open or close the one or the other."""
        if what == LESSON and self._lesson.open:
            self._lesson.leave()
        elif what == LESSON:
            self._lesson.enter()
        elif self._museum.open:
            self._museum.leave()
        else:
            self._lesson.leave()
            self._museum.enter()

    # --- the lesson -------------------------------------------------------------------------------

    @property
    def layout(self) -> SceneLayout:
        """Where the maps lie in the scene."""
        return self._maps.layout

    def entered(self, open_: bool) -> None:
        """The lesson takes the place of the plots, or gives it back."""
        self._hand.end()
        self._placing_done()
        self._farewell()
        self._run.open(LESSON, open_)
        self._plots.visible(not open_)
        self._comparison.clear()
        self._forget_place()
        self._stage.layer("lesson", None)
        if open_ and self._run.view != MAP:
            self._run.view = MAP
            self._turn_view()
        self._press()

    def came_back(self) -> None:
        """Show again what there was before the lesson."""
        if self._timeline.desk is not None:
            self._restore(self._timeline.desk)

    def method_shown(self, method: str) -> None:
        """The lesson has chosen a method."""
        self._run.restore(method, self._run.seed)

    def report(self, error: MapMergeError) -> None:
        """Something the lesson needs cannot be used."""
        self._report(error)

    def present(
        self, story: RunState, says: str, ink: list[Item], turn: float | None, look: bool, busy: bool
    ) -> None:
        """Show a run on the map, as far as the story goes, and what the lesson draws over it."""
        with self.session.drawing, self._client.atomic():
            self._story = story
            if self._run.view != MAP:
                self._draw(story, live=False)
            elif story.reached(AugmentDetail):
                self._run_view.show(story, self._tuning.config, camera=look, live=True)
            else:
                self._maps.apart()
            if turn is not None and self._run.view == MAP:
                self._maps.turned(turn)
            self._stage.layer("lesson", ink if self._run.view == MAP else None)
            mood = "running" if busy else "idle"
            shown = legend(self._palette, self._run.view, story, mode=self._comparison.mode)
            self._stage.hud(state=says, mood=mood, progress=None, legend=shown)
            self._stage.flush()

    # --- the museum -------------------------------------------------------------------------------

    @property
    def desk(self) -> PageSnapshot | None:
        """What is on the page, with what has come of it."""
        return self._timeline.desk

    def museum_entered(self, open_: bool) -> None:
        """The museum was opened or closed."""
        self._run.open(MUSEUM, open_)
        self._press()

    def hang(self, inputs: MergeInputs, method: str, config: Any, label: str) -> None:
        """Put an exhibit on the page, without merging it."""
        self.session.stop()
        self._lesson.shut()
        self._tuning.restore(method, config)
        self._run.restore(method, 0)
        self._files.restore(Files(inputs.name))
        with self.session.drawing:
            if self._show_inputs(inputs):
                self._timeline.note(self._desk(), label)

    def treat(self, method: str, config: Any) -> None:
        """Take the settings that cure an exhibit, and merge."""
        self._tuning.restore(method, config)
        self._run.restore(method, 0)
        self._merge()

    def museum_left(self, desk: PageSnapshot | None) -> None:
        """Put back what was on the page before the visit."""
        if desk is not None:
            self._timeline.note(desk, "leave the museum")
            self._restore(desk)
