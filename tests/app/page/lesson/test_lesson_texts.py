"""The files of the lesson: equations that are typeset and up to date, texts that say what is wrong."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from algorithms.common.errors import InputFileError
from app.page.lesson import equations
from app.page.lesson.lesson_texts import files, filled, lesson_folder, read_step
from app.page.lesson.placeholders import NUMBERS

GOOD = """\
---
title: A step
picture: hough
equations: [line]
try:
  - ask: Set it to 1.
    button: Set it
    set: {augment.intensity: 1}
    answer: Nothing changes.
---
The range is {range_m} m.
"""


def step(folder: Path, text: str = GOOD):
    path = folder / "01-mine.md"
    path.write_text(text, encoding="utf-8")
    return read_step(path, ["hough"], NUMBERS)


@pytest.mark.parametrize("name", equations.names())
def test_every_equation_is_typeset_from_its_newest_source(name):
    source = equations.folder() / f"{name}.tex"
    drawn = source.with_suffix(".svg").read_text(encoding="utf-8")
    made_from = ElementTree.fromstring(drawn).attrib["data-source"]
    assert made_from == equations.read_equation(source).digest, "run make equations"


def test_no_typeset_equation_has_lost_its_source():
    assert sorted(path.stem for path in equations.folder().glob("*.svg")) == equations.names()


@pytest.mark.parametrize("name", equations.names())
def test_an_equation_takes_the_colour_and_the_size_of_the_words_around_it(name):
    drawn = ElementTree.parse(equations.folder() / f"{name}.svg").getroot()
    colours = {e.attrib[k] for e in drawn.iter() for k in ("fill", "stroke") if k in e.attrib}
    assert colours <= {"currentColor", "none"}
    assert drawn.attrib["width"].endswith("em")
    assert not [e for e in drawn.iter() if "id" in e.attrib]  # they would clash on a page


def test_an_equation_stands_with_its_number():
    page = equations.equations_html(["gaussian", "augmented"])
    assert re.findall(r"<small>(.*?)</small>", page) == ["(4)", "(5)"]


def test_an_equation_without_a_number_is_told(tmp_path):
    path = tmp_path / "mine.tex"
    path.write_text("x = y\n")
    with pytest.raises(InputFileError, match=r"mine\.tex: .*% \(4\)"):
        equations.read_equation(path)


def test_a_step_is_read_with_its_trials(tmp_path):
    read = step(tmp_path)
    assert (read.title, read.picture, read.equations) == ("A step", "hough", ("line",))
    (trial,) = read.trials
    assert trial.settings == ((("augment", "intensity"), 1.0),)
    assert filled(read.body, {"range_m": "2.97"}) == "The range is 2.97 m."
    assert filled(read.body, {}) == "The range is … m."


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("{range_m}", "{rnage_m}", r"holds \{rnage_m\}, which is no number"),
        ("Nothing changes.", "It is {nonsense} now.", r"holds \{nonsense\}"),
        ("picture: hough", "picture: hoof", "picture is 'hoof'; known are hough"),
        ("[line]", "[lime]", "equations holds 'lime'; known are"),
        ("title: A step\n", "", "title is missing"),
        ("title:", "titel:", "titel is not a known key; did you mean title"),
        ("augment.intensity: 1", "augment.intensty: 1", "did you mean augment.intensity"),
        ("augment.intensity: 1", "augment.intensity: 9999", "must lie in"),
        ("augment.intensity: 1", "augment.intensity: much", "not a finite number"),
        ("    button: Set it\n", "", "button and set are not both there"),
        ("  - ask: Set it to 1.\n    button", "  - button", "try 1: ask is missing"),
        ("title: A step", "title: [", "front matter of a text"),
        ("---\ntitle", "title", "no front matter"),
        ("The range is {range_m} m.", "", "no text below"),
    ],
)
def test_what_is_wrong_with_a_step_is_told_with_its_file(tmp_path, old, new, said):
    assert old in GOOD
    with pytest.raises(InputFileError, match=said) as told:
        step(tmp_path, GOOD.replace(old, new, 1))
    assert "01-mine.md" in str(told.value)


def test_a_folder_without_texts_is_told(tmp_path):
    with pytest.raises(InputFileError, match="holds no text"):
        files(tmp_path)
    assert len(files(lesson_folder())) >= 12
