"""The part of a page that its session tells of its work: what is drawn, and what is said of it."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from algorithms.common.errors import MapMergeError, NoAnswerError
from algorithms.methods import registry as methods
from algorithms.methods.manual_merge import BY_HAND
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import AugmentDetail, CauseDetail, Step, TriedDetail
from algorithms.verdict.contradictions import Contradictions, find_conflicts
from app.drawing.legend import in_hand, legend
from app.jobs.worker_pool import WorkerDiedError
from app.model import status_text as words
from app.model import verdict_text
from app.model.merge_inputs import MergeInputs
from app.model.merge_job import MergeJob
from app.model.run_state import RunState
from app.model.view_modes import HEIGHTS, MAP, SWARM
from app.page.panels.html_widgets import box
from app.page.panels.result_panel import result_html
from app.page.part import Part
from app.report.replay.make_replay import replay_of
from app.report.result_files import ResultFiles
from app.web import callback_errors as mishap


class Telling(Part):
    """The part of a Page that listens to its session."""

    _weighed: tuple[tuple[MergeResult, MergeInputs, Any], tuple[Contradictions, str]] | None = None

    # --- what the session tells -------------------------------------------------------------------

    def begun(self, job: MergeJob) -> None:
        """A run starts."""
        if job.goal == "cause":
            self._run.stoppable("run", True)
            return
        self._hush()
        self._run.stoppable("run", True)
        if self._farewell():  # who was looked at is not left on the map while something else is said
            self._comparison.clear()
            self._maps.apart()
        if job.pace > 0:  # told step by step; a run at once leaves what is seen until it has ended
            self._comparison.clear()
        self._stage.layer("readout", None)  # of a place that will look otherwise
        self._stage.hud(state="Starting.", mood="running", progress=0.0, readout="")
        self._stage.flush()

    def show(self, job: MergeJob, story: RunState) -> None:
        """Draw the newest state."""
        if job.goal == "cause":
            self._seek(story)
            return
        self._story = story
        with self._client.atomic():
            if job.pace > 0:
                self._draw(story, live=True)
            elif self._run.view == SWARM:
                self._draw(story, live=False)
            self._plots.show(story, follow=job.goal == "merge")
            self._stage.hud(pressed=[*self._run.pressed, self._plots.page])
            self._stage.hud(state=words.sentence(story), mood="running", progress=words.progress(story))
            self._stage.flush()

    def ending(self, job: MergeJob, story: RunState) -> None:
        """What is to be said of an answer: with large maps it takes longer than to draw it."""
        result = story.get(MergeResult)
        if result is not None and job.steps is None:
            self._weigh(result, job.config)

    def _weigh(self, result: MergeResult, config: Any) -> tuple[Contradictions, str]:
        """Where the maps contradict each other, and the page of the result; worked out once."""
        of = (result, self._inputs, config)
        if self._weighed is None or any(a is not b for a, b in zip(self._weighed[0], of, strict=True)):
            found = find_conflicts(result.fusion)
            self._weighed = of, (found, result_html(result, self._inputs, config, found))
        return self._weighed[1]

    def waits(self, job: MergeJob, before: int) -> None:
        """Others are at work: other tabs' runs, or the end of a step of one that was left."""
        if job.goal == "cause":
            return
        place = f"{before} before this one" if before else "this one is next"
        self._stage.hud(state=f"The processors are busy: {place}.", mood="running")
        self._stage.flush()

    def ended(self, job: MergeJob, story: RunState) -> None:
        """The run came to its goal."""
        i = self._inputs
        if job.ref is not i.ref or job.mov is not i.mov or job.observations != i.observations:
            raise RuntimeError("an answer of other maps than those on the page")  # never shown as theirs
        self._run.stoppable("run", False)
        if job.goal == "cause":
            self._explain(story.get(CauseDetail))
            return
        result = story.get(MergeResult)
        with self._client.atomic():
            if result is not None and job.steps is not None:
                self._refined(story, result)
            elif result is None:
                self._story = story
                self._plots.show(story, follow=False)
                self._maps_preview(job)
                self._stage.hud(state=words.UP_TO_DATE, mood="idle", progress=None)
            else:
                self._answered(story, result, job.config, live=job.pace > 0)
                self._timeline.amend(story)
            self._stage.hud(pressed=[*self._run.pressed, self._plots.page])
            self._stage.flush()
        if result is not None and job.steps is None and not result.verdict.accepted:
            cause = partial(methods.find_cause, job.ref, job.mov, job.observations)
            self.session.request(replace(job, goal="cause", steps=cause, pace=0.0))

    # --- after a refusal: a simple change under which the maps would agree? ---------------------------

    def _seek(self, story: RunState) -> None:
        """Tell below the verdict what is being tried."""
        tried, result = story.get(TriedDetail), self._result
        if tried is None or result is None:
            return
        seeking = f"Why? {tried.index + 1} of {tried.total}: {tried.clause}?"
        with self._client.atomic():
            self._tell_result(result.with_hint(seeking))
            self._stage.flush()

    def _explain(self, cause: CauseDetail | None) -> None:
        """Put the cause, if one was found, into the result."""
        result, story = self._result, self._story
        if result is None or cause is None:
            return
        told = result.with_hint(cause.hint)
        with self._client.atomic():
            self._tell_result(told)
            if cause.hint:
                story.tell(Step("explain", told, 0.0))
                self._result = told
                self._export.offer(ResultFiles(told, self._inputs, self._config))
                self._timeline.amend(story)
            self._stage.flush()

    def _tell_result(self, result: MergeResult) -> None:
        self._plots.tell(result_html(result, self._inputs, self._config, self._conflicts))

    def _answered(self, story: RunState, result: MergeResult, config: Any, live: bool) -> None:
        """Show an answer and everything that led to it."""
        self._farewell()
        self._story, self._result, self._config = story, result, config
        if result.method != BY_HAND:
            self._method = story
        self._plots.show(story, follow=True)
        self._conflicts, told = self._weigh(result, config)
        self._plots.tell(told)
        self._export.offer(ResultFiles(result, self._inputs, config))
        self._what_if.offer(result)
        i = self._inputs
        if result.method == BY_HAND:  # there was no run that could be told again
            self._export.replay.visible(False)
        elif i.ref is not None and i.mov is not None:
            job = MergeJob(i.ref, i.mov, i.observations, config, result.method, result.seed)
            self._export.replay.offer(i.name, partial(replay_of, job, self.session.told_again, i))
        self._draw(story, live=live)
        self._comparison.offer(self._conflicts, self._palette)
        self._stage.hud(mood=verdict_text.mood(result.verdict), progress=None)
        self._say(story, result)
        self._museum.told(self._inputs, result.method, config, result)

    def stopped(self, job: MergeJob, story: RunState) -> None:
        """Someone pressed Stop."""
        self._run.stoppable("run", False)
        if job.goal == "cause":
            if self._result is not None:
                self._tell_result(self._result)
            return
        if self._maps.together:
            self._comparison.offer(None, self._palette)
        if job.steps is not None and self._refining is not None:
            self._hand.take_up(*self._refining)
            return
        self._stage.hud(state=f"Stopped, unfinished. {words.sentence(story)}", mood="stopped", progress=None)
        self._stage.flush()

    def failed(self, job: MergeJob, story: RunState, error: Exception) -> None:
        """The run could not go on."""
        self._run.stoppable("run", False)
        if job.goal == "cause":  # the verdict stands without it
            if self._result is not None:
                self._tell_result(self._result)
            return
        if isinstance(error, NoAnswerError):
            self._unanswered(story, error)
            return
        died = isinstance(error, WorkerDiedError)
        if isinstance(error, MapMergeError) and not died:
            self._report(error)
            return
        text = str(error) if died else mishap.words(error)
        self._notify("The run ended", text, "red")
        self._stage.hud(state=text, mood="failed", progress=None)
        self._stage.flush()

    def _unanswered(self, story: RunState, refusal: NoAnswerError) -> None:
        """The method found no transform: the maps go back to where they were, with the reason."""
        self._story, self._method = story, None
        self._result = self._conflicts = self._config = None
        with self._client.atomic():
            self._comparison.clear()
            self._export.offer(None)
            self._what_if.offer(None)
            self._plots.show(story, follow=True)
            self._plots.tell(box(str(refusal), "refused"))
            self._maps.apart()
            self._draw(story, live=False)
            self._stage.hud(state=str(refusal), mood="refused", progress=None)
            self._stage.flush()

    # --- drawing ----------------------------------------------------------------------------------

    def _draw(self, story: RunState, live: bool, look: bool = False) -> None:
        view, camera = self._run.view, self._run.follow
        if look and view == MAP and (self._placing.active or self._hand.active):
            self._stage.look_down(self._maps.extent())
        if view == MAP and self._placing.active:
            self._placing.redraw()
        elif view == MAP and self._hand.active:
            self._hand.redraw()
        elif view == MAP:
            self._run_view.show(story, self._tuning.config, camera or look, live)
        elif view == HEIGHTS:
            self._heights.show(story.get(AugmentDetail), self._palette, look)
        else:
            self._swarm.show(story, self._palette, look)
        self._stage.hud(pressed=[*self._run.pressed, self._plots.page])
        self._tell_legend()

    def _tell_legend(self) -> None:
        """What the colours of the picture mean."""
        view, mode = self._run.view, self._comparison.mode
        held = view == MAP and self._hand.active and mode == "overlay"
        usual = legend(self._palette, view, self._story, mode=mode)
        self._stage.hud(legend=in_hand(self._palette) if held else usual)

    def _say(self, story: RunState, result: MergeResult) -> None:
        """The verdict; over the swarm whether it found the proven optimum, and the verdict's first word."""
        found, reason = words.found_it(story), result.verdict.reason
        if result.method == BY_HAND:
            reason = verdict_text.of_hand(result, taken=True)
        brief = f"{found} {reason.split(':')[0]}."
        self._stage.hud(state=words.typeset(brief if found and self._run.view == SWARM else reason))

    def _maps_preview(self, job: MergeJob) -> None:
        if self._run.view == MAP:
            self._run_view.preview(self._story, job.config)
            self._stage.hud(legend=legend(self._palette, MAP, self._story, preview=True))
        elif self._run.view == HEIGHTS:
            self._draw(self._story, live=False)
