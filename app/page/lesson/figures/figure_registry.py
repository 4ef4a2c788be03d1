"""Every picture by its name: what it needs, what can be moved in it, and what the map shows beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import radians

import numpy as np

from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.steps import (
    AugmentDetail,
    CandidatesDetail,
    HoughDetail,
    ObservationDetail,
    ProofDetail,
    ProvenDetail,
    RefineDetail,
    ShiftDetail,
    Step,
    WeighedDetail,
)
from algorithms.optimisation.optimiser import SearchState
from app.drawing.draw_items import Item, mark, path
from app.drawing.palette import Palette, css
from app.drawing.scene_layout import SceneLayout
from app.drawing.svg.scan_plot import sector
from app.model.run_state import RunState
from app.page.lesson.figures import chain_figure, knowledge_figure, verdict_figure, window_figure
from app.page.lesson.figures import fit_figure as fits
from app.page.lesson.figures import map_figures as maps
from app.page.lesson.figures import proof_figure as proofs
from app.page.lesson.figures import search_figures as search
from app.page.lesson.figures import sighting_figure as sighting
from app.page.lesson.figures import spectra_figures as spectra
from app.page.lesson.figures.figure_slider import FigureSlider
from app.page.lesson.lesson_run import FEW, LessonRun
from app.page.lesson.side_runs import SideRuns
from app.page.lesson.sighting_look import SIGHTING

At = Sequence[int]


@dataclass(frozen=True)
class OtherWay:
    """Another way to draw a picture, which a thing to try asks for.

    draw   : as that of the picture
    places : where the dials go, so that it is seen
    dials  : what can be moved in it; None: the same as in the picture
    """

    draw: Callable[[LessonRun, At, Palette], str]
    places: tuple[int, ...]
    dials: tuple[FigureSlider, ...] | None = None

    @staticmethod
    def held(draw: Callable[[LessonRun, At, Palette], str], *dials: FigureSlider) -> OtherWay:
        """One with handles that move these dials."""
        return OtherWay(draw, tuple(dial.start for dial in dials), dials)


@dataclass(frozen=True)
class LessonFigure:
    """How one step is drawn.

    needs : what the run must have come to
    draw  : makes the SVG, given where the dials stand
    run   : the run as far as the map shows it
    dials : what can be moved; asked once ``needs`` is there
    ink   : what is drawn over the map besides
    turn  : how far map 2 is turned where it lies beside map 1; None: as the run has it
    compares : makes the merges that it compares, which run while it is looked at; None: it has none
    early : those come before the lesson's own run, for the picture shows nothing else
    ways : other ways to draw it, by their names
    """

    needs: tuple[type, ...]
    draw: Callable[[LessonRun, At, Palette], str]
    run: Callable[[LessonRun, At], RunState]
    dials: Callable[[LessonRun], tuple[FigureSlider, ...]] = lambda _: ()
    ink: Callable[[LessonRun, At, SceneLayout, Palette], list[Item]] = lambda *_: []
    turn: Callable[[LessonRun, At], float] | None = None
    compares: Callable[[LessonRun], SideRuns] | None = None
    early: bool = False
    ways: Mapping[str, OtherWay] = field(default_factory=dict)


def _up_to(kind: type) -> Callable[[LessonRun, At], RunState]:
    return lambda lesson, at: lesson.run_until(kind)


def _nth(kind: type) -> Callable[[LessonRun, At], RunState]:
    return lambda lesson, at: lesson.run_until(kind, min(at[0], len(lesson.all(kind)) - 1))


def _searching(
    states_of: Callable[[LessonRun], list[SearchState]], ahead: int
) -> Callable[[LessonRun, At], RunState]:
    """The run up to the candidates, and then this search in the best one's box."""

    def run_until(lesson: LessonRun, at: At) -> RunState:
        states, run = states_of(lesson), lesson.run_until(CandidatesDetail)
        state = states[min(at[0] + ahead, len(states) - 1)]
        run.add(Step("refine", RefineDetail(0, 1, lesson.box, state), 0.0))
        return run

    return run_until


def _looking(lesson: LessonRun, at: At) -> RunState:
    """The run up to a look at the proof, to the last one where none is chosen."""
    chosen = proofs.looks(lesson)
    return lesson.run_until(ProofDetail, chosen[min(at[0], len(chosen) - 1) if at else -1])


def _lines(lesson: LessonRun, at: At, layout: SceneLayout, palette: Palette) -> list[Item]:
    """The strongest lines of both maps, the chosen one of each with its number."""
    detail, items = lesson.get(AugmentDetail), []
    reach = 2.0 * lesson.config.augment.spread
    first, second, step = lesson.votes
    for votes, lifted, anchor, frame in (
        (first, detail.ref, layout.anchor_ref, "scene"),
        (second, detail.mov, layout.anchor_mov, "map2"),
    ):
        for k, (theta, rho) in enumerate(spectra.strongest(votes, step)):
            ends = spectra.line_through(theta, rho, lifted.x_hat, reach) - anchor
            chosen = k == at[0]
            name = {"t": str(k + 1), "tp": ends[1], "size": 13} if chosen else {}
            colour, width = (palette.conflict, 3.0) if chosen else (palette.particle, 1.5)
            items.append(path(ends, colour, frame, w=width, halo=True, **name))
    return items


def _moves(lesson: LessonRun, at: At, layout: SceneLayout, palette: Palette) -> list[Item]:
    """Every particle's last step, and the three pulls on the chosen one."""
    states, j = lesson.few, min(at[1], FEW - 1)
    k = min(at[0] + 1, len(states) - 1)
    before, after = states[max(0, k - 1)], states[k]
    items = [
        path(np.array([start, end]) - layout.anchor_ref, palette.particle, alpha=0.7, w=1)
        for start, end in zip(before.poses[:, :2], after.poses[:, :2], strict=True)
    ]
    if after.pulls is not None:
        here = before.poses[j, :2] - layout.anchor_ref
        pulls = zip(after.pulls[:, j, :2], (palette.ref, palette.best, palette.particle), strict=True)
        items += [path(np.array([here, here + pull]), colour, w=3.5, halo=True) for pull, colour in pulls]
    return items


def _swarm_dials(lesson: LessonRun) -> tuple[FigureSlider, ...]:
    few = lesson.few
    # at first the particle with the longest way to go
    far = int(np.hypot(*(few[0].poses - few[0].best)[:, :2].T).argmax())
    return (FigureSlider("move", max(1, len(few) - 1), 1), FigureSlider("particle", FEW, far))


def _compared(lesson: LessonRun) -> tuple[FigureSlider, ...]:
    """Which merge the map shows, once all of them are over."""
    runs = knowledge_figure.runs_of(lesson)
    count = len(runs.each)
    return (FigureSlider("on the map", count, count - 1),) if runs.next is None else ()


def _seen_by_laser(lesson: LessonRun, at: At, layout: SceneLayout, palette: Palette) -> list[Item]:
    """The box's directions from where robot 1 stood, and the laser points on the other robot."""
    look = lesson.look
    one = None if look is None or not look.own else look.calibrated.one
    if look is None or one is None:
        return []
    camera, seen, place = look.calibrated.camera, one.position, look.observer
    reach = 1.2 * seen.range if seen else 3.0
    corners = place.apply(sector(one, camera, reach)) - layout.anchor_ref
    items = [path(corners, palette.particle, alpha=0.8, w=1.5, close=True, fill=css(palette.particle, 0.18))]
    if one.cluster is not None:
        points = place.apply(look.scan.mounting.apply(one.cluster.points)) - layout.anchor_ref
        items += [mark("dot", point, palette.mov, r=2.5) for point in points]
    if seen is not None:
        items.append(mark("cross", place.apply(seen.point()) - layout.anchor_ref, palette.best, r=6))
    return items


_TURN = FigureSlider("off the best turn (°)", window_figure.TURNS, first=0, step=360 / window_figure.TURNS)
_HALF = search.TURN_STEPS // 2
_LINE = FigureSlider("line", spectra.LINES)
_OFF = FigureSlider("off the best (°)", search.TURN_STEPS, _HALF, -_HALF * search.TURN_STEP, search.TURN_STEP)


PICTURES: dict[str, LessonFigure] = {
    SIGHTING: LessonFigure(
        (), sighting.sighting, _up_to(ObservationDetail),
        lambda _: (FigureSlider("part", sighting.PARTS),), _seen_by_laser,
        compares=sighting.runs_of, early=True, ways={
            "counted": OtherWay(sighting.counted, (sighting.WHICH_WAY,)),
            "mean": OtherWay(sighting.mean_taken, (sighting.HOW_FAR,)),
        },
    ),
    "observation": LessonFigure(
        (ObservationDetail,), maps.observation, _up_to(ObservationDetail),
        ways={"laid": OtherWay.held(fits.laid, fits.TURN)},
    ),
    "augmentation": LessonFigure(
        (AugmentDetail,), maps.augmentation, _up_to(AugmentDetail),
        ways={"ring": OtherWay.held(maps.ring, maps.SPREAD)},
    ),
    "dual": LessonFigure((ObservationDetail,), maps.dual, _up_to(ObservationDetail)),
    "hough": LessonFigure(
        (AugmentDetail,), spectra.hough, _up_to(AugmentDetail), lambda _: (_LINE,), _lines,
        ways={"wave": OtherWay.held(spectra.wave, spectra.CELL_X, spectra.CELL_Y)},
    ),
    "spectrum": LessonFigure((HoughDetail,), spectra.spectrum, _up_to(AugmentDetail)),
    "correlation": LessonFigure(
        (HoughDetail,), spectra.correlation, _up_to(HoughDetail),
        lambda lesson: (FigureSlider("slid by (°)", 180, spectra.first_turn(lesson), first=0),),
        turn=lambda lesson, at: radians(at[0]),
    ),
    "turned": LessonFigure(
        (HoughDetail,), maps.turned, _up_to(HoughDetail),
        lambda lesson: (FigureSlider("candidate", len(lesson.get(HoughDetail).match.turns)),),
        turn=lambda lesson, at: lesson.get(HoughDetail).match.turns[at[0]],
    ),
    "shift": LessonFigure(
        (CandidatesDetail,), spectra.shift, _nth(ShiftDetail),
        lambda lesson: (FigureSlider("candidate", len(lesson.all(ShiftDetail))),),
    ),
    "window": LessonFigure(
        (CandidatesDetail,), window_figure.window, _up_to(CandidatesDetail),
        ways={"origins": OtherWay.held(window_figure.origins, _TURN)},
    ),
    "objective": LessonFigure(
        (CandidatesDetail,), search.objective, _up_to(CandidatesDetail), lambda _: (_OFF,),
        ways={"fit": OtherWay.held(fits.fit, fits.ALONG_X, fits.ALONG_Y, fits.TURN)},
    ),
    "samples": LessonFigure(
        (CandidatesDetail,), search.samples, _searching(lambda lesson: lesson.samples, 0),
        lambda lesson: (FigureSlider("throws", len(lesson.samples), 1),),
    ),
    "swarm": LessonFigure(
        (CandidatesDetail,), search.swarm, _searching(lambda lesson: lesson.few, 1), _swarm_dials, _moves
    ),
    "proof": LessonFigure(
        (ProvenDetail,), proofs.proof, _looking,
        lambda lesson: (FigureSlider("look", (count := len(proofs.looks(lesson))), count - 1),),
        ways={"lattice": OtherWay(proofs.between_the_lattice, (), ())},
    ),
    "answers": LessonFigure((MergeResult,), verdict_figure.answers, _up_to(WeighedDetail)),
    "merged": LessonFigure((MergeResult,), maps.merged, _up_to(Fusion)),
    "verdict": LessonFigure(
        (MergeResult,), verdict_figure.verdict, _up_to(MergeResult),
        ways={"without": OtherWay.held(verdict_figure.without, verdict_figure.LEFT, verdict_figure.ADDED)},
    ),
    knowledge_figure.NAME: LessonFigure(
        (MergeResult,), knowledge_figure.knowledge, knowledge_figure.shown_on_map, _compared,
        compares=knowledge_figure.runs_of,
    ),
    chain_figure.NAME: LessonFigure(
        (MergeResult,), chain_figure.chain, _up_to(MergeResult), compares=chain_figure.runs_of,
        ways={
            "second": OtherWay.held(chain_figure.second_sighting, chain_figure.SEEN_X, chain_figure.SEEN_Y)
        },
    ),
}  # fmt: skip
