"""The texts of the lesson: steps and what there is to try, and what is wrong with a file."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from algorithms.common.errors import InputFileError
from app.page.lesson.figures.figure_registry import PICTURES
from app.page.lesson.lesson_panel import emphasised
from app.page.lesson.lesson_texts import (
    Effect,
    Question,
    files,
    filled,
    first_number,
    lesson_folder,
    read_step,
)
from app.page.lesson.placeholders import NUMBERS
from app.system import data_paths as paths

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
The range is {range} m.
"""


def step(folder: Path, text: str = GOOD):
    path = folder / "01-mine.md"
    path.write_text(text, encoding="utf-8")
    return read_step(path, {name: PICTURES[name] for name in ("hough", "sighting")}, NUMBERS)


def test_a_step_is_read_with_its_trials(tmp_path):
    read = step(tmp_path)
    assert (read.title, read.picture, read.equations) == ("A step", "hough", (("line",),))
    (trial,) = read.trials
    assert trial.settings == ((("augment", "intensity"), 1.0),)
    assert filled(read.body, {"range": "2.97"}) == "The range is 2.97 m."
    assert filled(read.body, {}) == "The range is … m."


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("{range}", "{rnage}", r"holds \{rnage\}, which is no number"),
        ("Nothing changes.", "It is {nonsense} now.", r"holds \{nonsense\}"),
        ("picture: hough", "picture: hoof", "picture is 'hoof'; known are hough, sighting"),
        ("[line]", "[lime]", "equations holds 'lime'; known are"),
        ("title: A step\n", "", "title is missing"),
        ("title:", "titel:", "titel is not a known key; did you mean title"),
        ("augment.intensity: 1", "augment.intensty: 1", "did you mean augment.intensity"),
        ("augment.intensity: 1", "augment.intensity: 9999", "must lie in"),
        ("augment.intensity: 1", "augment.intensity: much", "not a finite number"),
        ("    button: Set it\n", "", "button and set are not both there"),
        ("  - ask: Set it to 1.\n    button", "  - button", "try 1: ask is missing"),
        (
            "set: {augment.intensity: 1}",
            "show: counted",
            "show is 'counted'; known are wave",
        ),
        ("    set: {", "    show: mean\n    set: {", "try 1: show is 'mean'"),
        ("title: A step", "title: [", "front matter of a text"),
        ("---\ntitle", "title", "no front matter"),
        ("The range is {range} m.", "", "no text below"),
    ],
)
def test_what_is_wrong_with_a_step_is_told_with_its_file(tmp_path, old, new, said):
    assert old in GOOD
    with pytest.raises(InputFileError, match=said) as told:
        step(tmp_path, GOOD.replace(old, new, 1))
    assert "01-mine.md" in str(told.value)


IN_PARTS = """\
---
title: A step in parts
picture: sighting
equations: [[line], [votes, box]]
try:
  - {ask: Count., button: Count pixels, show: counted, answer: It is rough.}
---
The first.

***

The second, **bold**.
"""


def test_a_text_in_parts_has_words_and_equations_for_each_and_the_last_ones_for_those_that_follow(tmp_path):
    read = step(tmp_path, IN_PARTS)
    assert read.trials[0].show == "counted"
    assert [read.words(part).strip() for part in range(3)] == ["The first.", *["The second, **bold**."] * 2]
    assert [read.formulas(part) for part in range(3)] == [("line",), ("votes", "box"), ("votes", "box")]
    plain = step(tmp_path)
    assert (plain.words(3), plain.formulas(3)) == (plain.body, ("line",))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("show: counted", "show: conted", "show is 'conted'; known are counted, mean"),
        ("show: counted", "show: counted, set: {augment.intensity: 1}", "set and show are both there"),
        ("[votes, box]", "[votes, bix]", "equations holds 'bix'"),
        ("[votes, box]", "[votes, [box]]", "equations holds"),
        ("button: Count pixels, ", "", "button and set are not both there"),
    ],
)
def test_what_is_wrong_with_a_step_in_parts_is_told(tmp_path, old, new, said):
    assert old in IN_PARTS
    with pytest.raises(InputFileError, match=said):
        step(tmp_path, IN_PARTS.replace(old, new, 1))


@pytest.mark.parametrize("path", files(lesson_folder()), ids=lambda path: path.stem)
def test_every_step_has_a_note_for_who_teaches_it(path):
    assert len(read_step(path, PICTURES, NUMBERS).notes) > 40


@pytest.mark.parametrize("path", files(lesson_folder()), ids=lambda path: path.stem)
def test_what_there_is_to_try_shows_no_raw_markdown(path):
    for trial in read_step(path, PICTURES, NUMBERS).trials:
        assert not re.search(r"[*`\\]|\]\(", emphasised(trial.ask) + emphasised(trial.answer))


def test_words_between_asterisks_are_in_italics_and_never_markup():
    assert emphasised("2 * 3 is *not* <b>") == "2 * 3 is <em>not</em> &lt;b&gt;"


def test_steps_are_counted_from_0_where_the_first_file_says_so(tmp_path):
    assert first_number([tmp_path / "00-before.md", tmp_path / "01-first.md"]) == 0
    assert first_number([tmp_path / "01-first.md"]) == first_number([tmp_path / "first.md"]) == 1
    shipped = files(lesson_folder())
    assert [int(path.name[:2]) for path in shipped] == list(range(len(shipped)))


def test_a_folder_without_texts_is_told(tmp_path):
    with pytest.raises(InputFileError, match="holds no text"):
        files(tmp_path)
    assert len(files(lesson_folder())) >= 12


def test_the_six_questions_are_answered_where_the_teachers_guide_says_so():
    guide = (paths.static().parent / "docs" / "teacher.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| .+?\? \| (\d+) \| “(.+?)” \|", guide, flags=re.M)
    assert len(rows) == 6
    for number, sentence in rows:
        step = read_step(files(lesson_folder())[int(number)], PICTURES, NUMBERS)
        assert sentence in " ".join(step.body.split())
        assert step.picture


CHECK = "check: {ask: Turn it., test: laser}"
EFFECT = "effect: {test: contradictions, missing: None here., sample: office_r2_r1}"


def test_a_question_and_what_maps_must_show_are_read(tmp_path):
    path = tmp_path / "01-one.md"
    path.write_text(f"---\ntitle: One\n{CHECK}\n{EFFECT}\n---\nText.", encoding="utf-8")
    step = read_step(path, PICTURES, NUMBERS)
    assert step.check == Question("Turn it.", "laser")
    assert step.effect == Effect("contradictions", "None here.", "office_r2_r1")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("laser", "lasre", "lasre"),
        ("ask: Turn it.", "asked: Turn it.", "asked"),
        ("Turn it.", '"{nothing}"', "{nothing}"),
        ("test: contradictions", "test: nothing", "nothing"),
        ("sample: office_r2_r1", "samples: office_r2_r1", "samples"),
    ],
)
def test_what_is_wrong_with_a_question_is_told_with_its_file(tmp_path, old, new, said):
    path = tmp_path / "01-one.md"
    text = f"---\ntitle: One\n{CHECK}\n{EFFECT}\n---\nText."
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputFileError, match=re.escape(said)) as told:
        read_step(path, PICTURES, NUMBERS)
    assert path.name in str(told.value)
