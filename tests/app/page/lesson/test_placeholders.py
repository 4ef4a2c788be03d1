"""The numbers of the lesson are those that the page and the pictures show, on every sample."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape

import pytest
from looks import lesson_of
from svg_shapes import words

from algorithms.files.case_folder import read_case
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from algorithms.observations.observation import encounter
from algorithms.optimisation.particle_swarm import SwarmConfig
from app.drawing.palette import LIGHT
from app.model.objective_label import AGREEMENT
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_run import LessonRun
from app.page.lesson.placeholders import numbers_of
from app.page.panels.result_panel import result_html
from app.report.result_rows import sighting_rows
from app.system import data_paths as paths

DEFAULT = METHODS["spectra-proven"].defaults
QUICK = replace(DEFAULT, swarm=SwarmConfig(particles=10, iterations=1))  # the proof finds what is named

ON_THE_PAGE = {
    "shift_x": "T: Δx",
    "shift_y": "T: Δy",
    "merged_turn": "T: Δθ",
    "acceptance": "acceptance index",
    "contradiction": "contradicted, patches slipped",
    "rigid_contradiction": "contradicted, as the maps are",
    "shared_wall": "wall in view of both",
    "across": "agreeing wall across the others",
    "off_sighting": "robot 2 off its sighting",
    "probability": "likely right",
    "blocks": "blocks bounded",
}
"""Numbers of the lesson, and the row of the result that holds the same."""

IN_PICTURES = {
    "augmentation": ("peak",),
    "merged": ("shift_x", "shift_y", "merged_turn"),
    "answers": ("named_says",),
    "verdict": ("rigid_contradiction", "unbent", "across", "off_sighting"),
}


@pytest.fixture(scope="module", params=sorted(paths.samples()))
def sample(request) -> LessonRun:
    return lesson_of(read_case(paths.samples()[request.param]), QUICK, {})


def test_a_number_of_a_text_is_the_one_that_the_page_and_the_picture_of_its_step_show(sample):
    numbers, result, inputs = numbers_of(sample), sample.get(MergeResult), sample.inputs
    page = result_html(result, inputs, sample.config)
    cells = re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", page.replace("-", "−"))
    shown = dict(zip(cells[::2], cells[1::2], strict=False))
    shown = {unescape(re.sub("<.*?>", "", label)): unescape(value) for label, value in shown.items()}
    assert {name: numbers[name] for name in ON_THE_PAGE} == {
        name: shown[label] for name, label in ON_THE_PAGE.items()
    }
    assert shown[f"eq. (23), {numbers['performance_over']}"] == numbers["performance"]
    assert numbers["value"] == f"{shown['agreement (m of wall)']} m"
    value, at = AGREEMENT.text(result.value), (PICTURES["objective"].dials(sample)[0].start,)
    assert f"A: {value} at the star" in words(PICTURES["objective"].draw(sample, at, LIGHT))
    seen = dict(sighting_rows(inputs.observations[0], encounter(inputs.observations[0])))
    assert (numbers["range"], numbers["x1"]) == (
        seen["range r"],
        seen["x̂₁, seen here"].replace("-", "−"),
    )
    for picture, names in IN_PICTURES.items():
        said = " ".join(words(PICTURES[picture].draw(sample, (), LIGHT)))
        assert [name for name in names if numbers[name] not in said] == [], picture


def test_the_papers_window_is_as_wide_as_the_text_adds_it_up(sample):
    numbers = numbers_of(sample)
    lever = float(numbers["x2_norm_m"].replace(",", ""))
    sigmas = [float(part) for part in re.findall(r"[\d.]+", numbers["paper_sigma"])]
    sides = [float(part) for part in re.findall(r"[\d.]+", numbers["paper_window"])]
    assert sides == pytest.approx([2 * (lever + sigma) for sigma in sigmas], abs=0.075)
