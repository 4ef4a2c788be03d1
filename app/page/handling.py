"""The part of a page that is about a person's hand: map 2 is moved, and robots are placed."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import viser

from algorithms.common.errors import MapMergeError
from algorithms.common.pose import Pose2
from algorithms.files.observation_file import OBSERVATION_FILE, observations_to_bytes
from algorithms.methods.manual_merge import ManualMerge, known_answers, refine
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import ObservationDetail, Step
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import PairProblem
from app.drawing.legend import legend
from app.drawing.scene_layout import SceneLayout
from app.model.run_state import RunState
from app.model.view_modes import MAP
from app.page.editing.map_drag_controller import MapDragController
from app.page.editing.placement_controller import PlacementController
from app.page.page_snapshot import PageSnapshot
from app.page.panels.result_panel import result_html
from app.page.part import Part


class Handling(Part):
    """The part of a Page that is done by hand."""

    _method: RunState | None = None  # of the last run whose answer was not made by hand
    _refining: tuple[ManualMerge, Pose2] | None = None  # where map 2 was when its refinement began

    def _handle_with(self, gui: viser.GuiApi) -> None:
        """Add both to the page."""
        both = self._turn, self.session.drawing
        self._hand = MapDragController(gui, self._channel, self._stage, self._maps, *both, self)
        self._placing = PlacementController(
            self._observation, self._channel, self._stage, self._maps, *both, self
        )

    def _fade(self) -> None:
        """What was found is out of date."""
        if self._result is not None:
            told = result_html(self._result, self._inputs, self._config, self._conflicts, faded=True)
            self._plots.tell(told)
        self._export.offer(None)
        self._what_if.offer(None)

    # --- the robots by hand: see editing/placement_controller.py ------------------------------------

    def placing_asked(self) -> None:
        """The robots are to be placed: whatever else is going on ends."""
        self._lesson.leave()
        self.session.stop()
        self._hand.end()

    def placing_begins(self, layout: SceneLayout) -> None:
        """The maps are shown side by side, and stay so."""
        self._farewell()
        self._comparison.clear()
        self._fade()
        if self._run.view != MAP:
            self._run.view = MAP
            self._turn_view()
        self._maps.load(replace(self._inputs, observations=()), layout, self._palette)
        shown = {"frames": layout.frames(), "legend": legend(self._palette, MAP, RunState())}
        self._stage.hud(mood="idle", progress=None, readout="", **shown)
        self._stage.layer("readout", None)

    def observed(self, observations: tuple[Observation, ...]) -> None:
        """These are the observations now; what was found with others no longer counts."""
        self._inputs = replace(self._inputs, observations=observations)
        self._result, self._story, self._method = None, RunState(), None
        self._merged = self._asked = False
        self._plots.clear()
        self._run.merge.disabled = not self._inputs.complete
        self._research_changes()
        self._timeline.note(self._desk())

    def placing_ends(self) -> None:
        """Everything as usual, with the observations there are."""
        desk = self._timeline.desk
        with self.session.drawing:
            if desk is not None:
                self._show_inputs(self._inputs)
                self._restore(desk)

    def _placing_done(self) -> None:
        if self._placing.active:
            self._show_inputs(self._inputs)

    def save_observations(self, observations: tuple[Observation, ...]) -> None:
        """Send observation.yaml."""
        self._save(OBSERVATION_FILE, observations_to_bytes(observations))

    # --- map 2 by hand: see editing/map_drag_controller.py ------------------------------------------

    @property
    def scales(self) -> ManualMerge | None:
        """What a transform is weighed on; None where something is missing, or wrong, which is told."""
        i, config = self._inputs, self._tuning.config
        if i.ref is None or i.mov is None or not i.observations:
            return None
        method = self._method
        known = known_answers(method.get(MergeResult)) if method and method.config == config else ()
        try:
            return ManualMerge(PairProblem(i.ref, i.mov, i.observations), config, known)
        except MapMergeError as error:
            self._report(error)
            return None

    @property
    def found(self) -> Pose2 | None:
        """What the method has found; None before."""
        return self._method.answer if self._method is not None else None

    @property
    def on_map(self) -> bool:
        """Whether the map is looked at."""
        return self._run.view == MAP

    @property
    def follows(self) -> bool:
        """Whether the camera is to go along."""
        return self._run.follow

    def hand_asked(self) -> None:
        """A person wants map 2 in their hand: whatever else is going on ends."""
        self._lesson.leave()
        self.session.stop()

    def hand_begins(self) -> None:
        """What was found is out of the way from now on; blink and curtain go along with the hand."""
        self._farewell()
        self._comparison.offer(None, self._palette)
        if self._run.view != MAP:
            self._run.view = MAP
            self._turn_view()
        self._fade()
        self._tell_legend()

    def hand_moved(self, T_ref_mov: Pose2) -> None:
        """Map 2 was put there."""
        self._timeline.note(self._desk())

    def hand_taken(self, result: MergeResult) -> None:
        """This is to be the answer."""
        story = RunState(self._tuning.config)
        for stage, detail in (
            ("observe", ObservationDetail(result.encounters)),
            ("fuse", result.fusion),
            ("verdict", result),
        ):
            story.tell(Step(stage, detail, 0.0))
        with self.session.drawing:
            self._timeline.note(replace(self._desk(), hand=result.T_ref_mov), "take it by hand")
            self._answered(story, result, self._tuning.config, live=False)
            self._timeline.amend(story)
            self._stage.flush()

    def hand_refines(self, scales: ManualMerge, T_ref_mov: Pose2) -> None:
        """Search from there; where it ends map 2 is in the hand again."""
        search = partial(refine, scales, T_ref_mov, self._run.seed)
        job = self._job(pace=self._run.pace, steps=search)
        if job is not None:
            self._refining = scales, T_ref_mov
            self.session.request(job)

    def _refined(self, story: RunState, result: MergeResult) -> None:
        if self._refining is None:
            return
        self._plots.show(story, follow=False)
        self._hand.take_up(self._refining[0], result.T_ref_mov)
        self._timeline.note(self._desk(), "refine by hand")

    def hand_snaps(self) -> None:
        """Take the best of the whole circle: known already, or looked for."""
        tuning, method = self._tuning, self._method
        result = method.get(MergeResult) if method and method.config == tuning.config else None
        label = "snap to the proven optimum"
        if method is not None and result is not None and result.proven_optimal:
            self._go_to(replace(self._desk(), outcome=method, goal="merge"), label)
            return
        proof = replace(tuning.config.proof, whole_circle=True)
        tuning.restore(tuning.method, replace(tuning.config, proof=proof))
        self._go_to(replace(self._desk(), goal="merge"), label)

    def hand_leaves(self) -> None:
        """Everything as it was before."""
        method = self._method
        known = method if method is not None and method.config == self._tuning.config else None
        self._go_to(replace(self._desk(), outcome=known))

    def _go_to(self, desk: PageSnapshot, label: str = "") -> None:
        self._timeline.note(desk, label)
        self._restore(desk)
