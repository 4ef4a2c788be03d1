"""What a refused merge suggests, as files: each answer with its picture, in the order of the table."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest

from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import merge
from algorithms.methods.suggestions import suggestions_of
from app.drawing.palette import LIGHT
from app.model.merge_inputs import MergeInputs
from app.page.panels.suggestions_html import SuggestionPictures
from app.report import suggestion_text as words
from app.report.suggestion_files import HEAD, SUGGESTIONS_FILE, suggestion_files, suggestion_rows


@pytest.fixture(scope="module")
def refused(strangers) -> MergeResult:
    return merge(strangers.ref, strangers.mov)


def test_every_suggestion_is_in_the_file_with_a_picture_that_shows_something(refused, strangers):
    files = suggestion_files(refused, strangers.ref, strangers.mov)
    told = json.loads(files.pop(SUGGESTIONS_FILE))
    choices = suggestions_of(refused)
    assert [each["probability"] for each in told] == [each.probability for each in choices]
    assert [each["T_ref_mov"]["x"] for each in told] == [each.T_ref_mov.x for each in choices]
    assert list(files) == [each["picture"] for each in told]
    for png in files.values():
        picture = cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_COLOR)
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 3  # floor, unknown, walls of either map


def test_the_table_has_a_row_of_the_same_numbers_per_suggestion(refused):
    choices = suggestions_of(refused)
    rows = suggestion_rows(choices)
    assert [row[0] for row in rows] == [str(each.number) for each in choices]
    assert all(len(row) == len(HEAD) for row in rows)
    assert words.likely(choices[0]) in rows[0]


def test_the_page_offers_a_button_with_a_picture_for_each_until_the_merge_is_accepted(
    refused, strangers, result
):
    inputs, pictures = MergeInputs.of(strangers), SuggestionPictures()
    html = pictures.html(refused, inputs, LIGHT)
    numbers = [each.number for each in suggestions_of(refused)]
    assert [f'data-mm-suggestion="{number}"' in html for number in numbers] == [True] * len(numbers)
    assert html.count("data:image/png") == len(numbers)
    assert pictures.html(result, inputs, LIGHT) == ""
