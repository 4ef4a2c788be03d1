"""The pictures of the lesson: whole SVGs of what the run found, light and dark, wherever a dial stands."""

from __future__ import annotations

import re
from itertools import product
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from looks import lesson_of
from svg_shapes import dots, lines

from algorithms.common.pose import Pose2
from algorithms.files.case_folder import read_case
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS, run
from algorithms.methods.steps import HoughDetail, RefineDetail, ShiftDetail
from algorithms.spectra.augmented_map import augment
from algorithms.spectra.hough_spectra import hough_transform
from app.drawing.palette import DARK, LIGHT, css
from app.drawing.scene_layout import lay_out
from app.drawing.svg.map_plot import RasterView, around, walls
from app.drawing.svg.svg_canvas import WIDE, SvgCanvas, SvgPlot, ticks
from app.drawing.svg.verdict_bars import FULL, bars, values
from app.model.merge_inputs import MergeInputs
from app.page.lesson import equations
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.figures.figure_slider import FigureSlider, place_of, shown
from app.page.lesson.figures.spectra_figures import strongest
from app.page.lesson.lesson_run import FEW, LessonRun
from app.page.lesson.lesson_texts import PLACEHOLDER, files, filled, lesson_folder, read_step, with_settings
from app.page.lesson.placeholders import NUMBERS, numbers_of
from app.page.lesson.sighting_look import STAND_IN
from app.system import data_paths as paths

CONFIG = METHODS["spectra-proven"].defaults
SVG = "{http://www.w3.org/2000/svg}"


def corners(dials: tuple[FigureSlider, ...]) -> list[tuple[int, ...]]:
    """Where every dial stands at its start, and at its ends."""
    return list(product(*(sorted({dial.start, 0, dial.count - 1}) for dial in dials)))


@pytest.mark.parametrize("which", ["lesson", "refused"])
@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
@pytest.mark.parametrize("name", PICTURES)
def test_every_picture_is_whole_wherever_its_dials_stand(request, which, name, palette):
    lesson = request.getfixturevalue(which)
    picture = PICTURES[name]
    layout = lay_out(lesson.inputs.ref, lesson.inputs.mov, lesson.inputs.at)
    places = corners(picture.dials(lesson))
    ways = [(picture.draw, at) for at in places] + [(way.draw, way.places) for way in picture.ways.values()]
    for draw, at in ways:
        drawn = draw(lesson, at, palette)
        root = ElementTree.fromstring(drawn)
        assert root.attrib["aria-label"]
        words = [e.text for e in root.iter(f"{SVG}text")]
        assert words
        for bad in ("nan", "inf", "None"):
            assert not [text for text in words if bad in text]
            assert f'"{bad}' not in drawn
        assert picture.run(lesson, at).last is not None
        for item in picture.ink(lesson, at, layout, palette):
            assert np.isfinite(item["p"]).all()


@pytest.mark.parametrize("path", files(lesson_folder()), ids=lambda path: path.stem)
def test_every_text_that_comes_along_names_pictures_equations_and_numbers_that_are_there(path, lesson):
    step = read_step(path, PICTURES, NUMBERS)
    assert step.picture
    assert step.equations
    assert step.trials
    for trial in step.trials:
        assert trial.answer
    numbers = numbers_of(lesson)
    for text in (step.body, *(trial.answer for trial in step.trials)):
        assert not PLACEHOLDER.search(filled(text, numbers))
        assert "…" not in filled(text, numbers).replace(text, "")
    assert {name for group in step.equations for name in group} <= set(equations.names())


@pytest.mark.parametrize("path", files(lesson_folder()), ids=lambda path: path.stem)
def test_a_picture_in_parts_has_words_and_equations_for_each_part_and_every_other_way_is_tried(path, lesson):
    step = read_step(path, PICTURES, NUMBERS)
    picture = PICTURES[step.picture]
    if len(step.equations) > 1:
        (dial,) = picture.dials(lesson)
        parts = range(dial.count)
        assert len(step.equations) == len({step.words(part) for part in parts}) == dial.count
        assert all(step.formulas(part) and step.words(part).strip() for part in parts)
    assert {trial.show for trial in step.trials if trial.show} == set(picture.ways)


@pytest.mark.parametrize("path", files(lesson_folder()), ids=lambda path: path.stem)
def test_every_button_changes_the_picture_of_its_step_and_no_number_is_missing_then(path, lesson, small_case):
    """Here, or on the sample that the page opens with."""
    step = read_step(path, PICTURES, NUMBERS)
    for trial in (trial for trial in step.trials if trial.settings):
        config = with_settings(lesson.config, trial.settings)
        tried = lesson_of(small_case, config, lesson.sides)
        if not changed(step.picture, lesson, tried):
            opened = read_case(paths.samples()[STAND_IN])
            assert changed(step.picture, *(lesson_of(opened, each, {}) for each in (lesson.config, config)))
        text = filled(f"{step.body} {trial.answer}", numbers_of(tried))
        assert not re.search(r"…|–|\b1 (turns|peaks|places|answers|candidates)\b", text), trial.button


def changed(name: str, before: LessonRun, after: LessonRun) -> bool:
    at = tuple(dial.start for dial in PICTURES[name].dials(before))
    return PICTURES[name].draw(before, at, LIGHT) != PICTURES[name].draw(after, at, LIGHT)


def test_every_picture_and_every_equation_is_in_the_lesson():
    steps = [read_step(path, PICTURES, NUMBERS) for path in files(lesson_folder())]
    assert {step.picture for step in steps} == set(PICTURES)
    named = {name for step in steps for group in step.equations for name in group}
    assert named == set(equations.names())


def test_every_number_is_known_at_the_end_of_a_run_and_none_before_its_stage(lesson, small_case):
    numbers = numbers_of(lesson)
    assert set(numbers) == set(NUMBERS)
    assert not [words for words in numbers.values() if "nan" in words]
    early = numbers_of(LessonRun(MergeInputs.of(small_case), CONFIG))
    assert "range" in early
    assert "camera_bearing" not in early
    assert "verdict" not in early


def test_the_accumulator_that_is_shown_is_what_the_spectrum_is_summed_from(lesson):
    first, second, _ = lesson.votes
    match = lesson.get(HoughDetail).match
    for votes, spectrum in ((first, match.ref), (second, match.mov)):
        energy = (votes**2).sum(axis=1)  # eq. (11)
        assert np.allclose(energy / energy.sum(), spectrum)


@settings(max_examples=25)
@given(theta=st.floats(0, np.pi - 0.01), rho=st.floats(-2, 2))
def test_the_strongest_line_is_the_wall_that_was_drawn(theta, rho):
    size, cell = 160, 0.05
    grid = GridMap(np.full((size, size), FREE, np.int8), cell, Pose2(-4, -4))
    along = np.arange(-2.5, 2.5, cell / 3)
    normal = np.array([np.cos(theta), np.sin(theta)])
    points = rho * normal + along[:, None] * (-normal[1], normal[0])
    at = np.floor(grid.grid_coordinates(points)).astype(int)
    inside = np.all((at >= 0) & (at < size), axis=1)
    cells = grid.cells.copy()
    cells[at[inside, 1], at[inside, 0]] = OCCUPIED
    lifted = augment(GridMap(cells, cell, Pose2(-4, -4)), np.zeros(2), np.eye(2) * 9, 100)
    (found, distance), *_ = strongest(hough_transform(lifted, 360, cell), cell, 1)
    c = np.cos(found - theta)  # past 180° a line has the other sign of ρ
    assert abs(c) > np.cos(np.radians(3))
    assert distance * np.sign(c) == pytest.approx(rho, abs=0.15)


def test_the_same_line_is_not_found_twice_across_the_end_of_the_circle():
    votes = np.zeros((180, 101))
    votes[0, 60] = 5.0  # θ = 0°, ρ = +10 bins
    votes[179, 40] = 4.0  # θ = 179°, ρ = −10 bins: nearly the same line
    votes[90, 50] = 3.0
    assert [theta for theta, _ in strongest(votes, 0.1)] == pytest.approx([0.0, np.pi / 2])


@pytest.mark.parametrize("pixels", [20, 90, 800])
def test_no_wall_is_lost_however_small_the_picture(pixels, lesson):
    grid = lesson.inputs.ref
    low, high = grid.corners().min(axis=0), grid.corners().max(axis=0)
    view = RasterView(around((low + high) / 2, float((high - low).max()) / 2), pixels, pixels)
    mask = walls(grid, view)
    row, col, seen = view.pixels_of(grid.points)
    assert seen.all()
    assert mask[row, col].all()


def test_up_is_up_in_a_picture():
    cells = np.full((10, 10), FREE, np.int8)
    cells[8, 2] = OCCUPIED  # high up, at the left
    mask = walls(GridMap(cells, 1.0), RasterView((0, 0, 10, 10), 10, 10))
    assert np.argwhere(mask).tolist() == [[1, 2]]


def test_the_swarm_of_the_lesson_is_small_and_tells_its_pulls(lesson):
    assert len(lesson.few[0].poses) == FEW
    assert all(state.pulls is not None for state in lesson.few[1:])
    assert lesson.few[-1].stopped


@pytest.mark.parametrize("move", [1, 4])
def test_what_pulls_at_a_particle_begins_where_it_is_and_goes_no_farther_past_its_star_than_it_may(
    lesson, move
):
    most = lesson.config.swarm.omega * lesson.config.swarm.tau
    for j in range(FEW):
        drawn = PICTURES["swarm"].draw(lesson, (move - 1, j), LIGHT)
        nearby = [path for path in lines(drawn, LIGHT.best) if path[:, 0].min() > 216]
        (star,) = (path for path in nearby if len(path) == 10)
        shafts = [path for path in nearby if len(path) == 2]
        place = next(dot for dot in dots(drawn, LIGHT.text) if dot[0] > 216)
        for start, end in shafts:
            assert start == pytest.approx(place, abs=0.2)
            towards, pull = (star.min(axis=0) + star.max(axis=0)) / 2 - place, end - start
            assert (np.abs(pull) <= most * np.abs(towards) + 2).all()
            assert (pull * towards >= -2).all()


def test_the_map_shows_the_candidate_that_the_dial_stands_at(lesson):
    told = lesson.all(ShiftDetail)
    for k in range(len(told)):
        story = PICTURES["shift"].run(lesson, (k,))
        assert story.shifts[-1] is told[k]


@pytest.mark.parametrize("of", ["lesson", "refused"])
def test_what_speaks_against_a_merge_points_to_the_left_and_what_speaks_for_it_to_the_right(of, request):
    verdict = request.getfixturevalue(of).get(MergeResult).verdict
    drawn = [
        (float(rect.get("x")), float(rect.get("width")), rect.get("fill"))
        for rect in ElementTree.fromstring(bars(verdict, LIGHT)).iter(f"{SVG}rect")
    ]
    for colour, against in ((css(LIGHT.mov), False), (css(LIGHT.conflict), True)):
        mine = [(x, width) for x, width, fill in drawn if fill == colour]
        moved = [by for by in verdict.contributions.values() if (by < 0) == against]
        assert len(mine) == len(moved)
        assert all((x + width if against else x) == pytest.approx(WIDE / 2, abs=0.1) for x, width in mine)
        assert sorted(width for _, width in mine) == pytest.approx(
            sorted(min(1, abs(by) / FULL) * WIDE / 2 for by in moved), abs=0.1
        )


def test_every_bar_of_the_verdict_says_its_value_and_all_add_up(lesson, refused):
    for verdict in (lesson.get(MergeResult).verdict, refused.get(MergeResult).verdict):
        texts = [text.text for text in ElementTree.fromstring(bars(verdict, LIGHT)).iter(f"{SVG}text")]
        assert set(values(verdict)) == set(verdict.contributions)
        assert set(values(verdict).values()) <= set(texts)
        total = verdict.typical_score + sum(verdict.contributions.values())
        assert any(text.endswith(f"{abs(total):.1f}") for text in texts)


def test_words_in_a_picture_are_never_markup():
    sheet = SvgCanvas(20)
    sheet.text(0, 10, "<img src=x onerror=1> & Δθ")
    (text,) = ElementTree.fromstring(sheet.svg('a "title" <b>')).iter(f"{SVG}text")
    assert text.text == "<img src=x onerror=1> & Δθ"


@given(low=st.floats(-1e4, 1e4), width=st.floats(1e-3, 1e4), most=st.integers(1, 12))
def test_ticks_are_few_round_and_inside(low, width, most):
    found = ticks(low, low + width, most)
    slack = 1e-6 * (abs(low) + width)
    assert len(found) <= most + 1
    assert all(low - slack <= value <= low + width + slack for value in found)


def test_a_plot_puts_its_corners_on_its_corners():
    plot = SvgPlot(SvgCanvas(100), 10, 20, 200, 50, (-1, 1), (0, 5))
    assert plot.at([(-1, 0), (1, 5)]).tolist() == [[10, 70], [210, 20]]


@given(count=st.integers(1, 50), place=st.integers(0, 49), step=st.sampled_from([0.5, 1.0]))
def test_a_dial_knows_its_place_by_its_number(count, place, step):
    dial = FigureSlider("", count, 0, -3.0, step)
    assert place_of(dial, shown(dial, place)) == min(place, count - 1)


def test_the_readme_for_teachers_names_every_picture_and_every_number():
    told = (lesson_folder().parent / "README.md").read_text(encoding="utf-8")
    assert {name for name in PICTURES if f"`{name}`" not in told} == set()
    assert {name for name in NUMBERS if f"`{{{name}}}`" not in told} == set()


def test_of_each_search_one_snapshot_is_kept_and_nothing_else_is_left_out(lesson, small_case):
    told = run("spectra-proven", small_case.ref, small_case.mov, small_case.observations, CONFIG)
    every = [step.detail for step in told]
    kept = [step.detail for step in lesson.steps]
    searches = [detail for detail in kept if isinstance(detail, RefineDetail)]
    assert [detail.index for detail in searches] == list(range(CONFIG.refine.candidates))[: len(searches)]
    assert all(detail.state.stopped for detail in searches)
    others = [[type(d) for d in some if not isinstance(d, RefineDetail)] for some in (every, kept)]
    assert others[0] == others[1]
    assert sum(isinstance(detail, RefineDetail) for detail in every) > len(searches)
