"""What the proof proves, and what it does not, as it is drawn."""

from __future__ import annotations

import numpy as np
import pytest
from svg_shapes import dots, lines, words

from algorithms.methods.steps import ProvenDetail
from app.drawing.palette import LIGHT
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.figures.proof_figure import CELLS, between_the_lattice, looks
from app.page.lesson.placeholders import numbers_of


def test_the_places_of_the_lattice_lie_a_cell_apart_and_none_is_higher_than_the_proven_best(lesson):
    drawn = between_the_lattice(lesson, (), LIGHT)
    tried = dots(drawn, LIGHT.particle)[: 2 * CELLS + 1]
    assert np.diff(tried[:, 0]) == pytest.approx(324 / (2 * CELLS), abs=0.2)
    assert tried[:, 1].argmin() == CELLS  # y is down: the best is in the middle
    curve = max(lines(drawn, LIGHT.margin), key=len)
    assert len(curve) > 100


def test_its_numbers_are_those_of_the_text_and_of_the_page(lesson):
    said, numbers = words(between_the_lattice(lesson, (), LIGHT)), numbers_of(lesson)
    assert numbers["proven_value"] in said
    assert lesson.rows["error to the truth"] in said
    blocks = words(PICTURES["proof"].draw(lesson, (len(looks(lesson)) - 1,), LIGHT))
    assert any(word.startswith(f"{numbers['blocks']} blocks") for word in blocks)


def test_where_nothing_fits_nothing_is_said_to_be_proven(refused):
    drawn = between_the_lattice(refused, (), LIGHT)
    if refused.get(ProvenDetail).state.best is None:
        assert "No transform" in " ".join(words(drawn))
    else:
        assert "proven" in " ".join(words(drawn))
