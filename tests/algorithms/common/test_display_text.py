"""What a stranger wrote is shown on one line, in the direction it is read in, and can always be sent."""

from __future__ import annotations

import pickle
import string
import unicodedata

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mapfiles import header, pgm

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import InputFileError, NoAnswerError, OutputError, SettingError, TooLargeError
from algorithms.files.map_file import map_from_bytes, map_to_bytes
from algorithms.maps.grid_map import GridMap
from app.model.files.map_slots import inputs_of
from app.model.merge_inputs import Upload

ODD = "\ud800\udfff\u202e\u2067\u200f\x00\x1b\x85\u2028\n\r"
strange = st.text(st.one_of(st.characters(exclude_categories=()), st.sampled_from(ODD)), max_size=30)


def shows_well(text: str) -> bool:
    turns = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}
    kinds = {unicodedata.category(char) for char in text}
    return not kinds & {"Cc", "Cs", "Zl", "Zp"} and not turns & set(map(unicodedata.bidirectional, text))


@given(strange)
def test_any_text_becomes_one_that_shows_all_it_holds(text):
    assert shows_well(show_hidden(text))
    assert show_hidden(show_hidden(text)) == show_hidden(text)
    assert all(f"[U+{ord(char):04X}]" in show_hidden(text) for char in set(text) & set(ODD))


@given(st.text(string.ascii_letters + string.punctuation + " äß山й🗺", max_size=40))
def test_a_text_without_anything_hidden_stays_as_it_is(text):
    assert show_hidden(text) == text


@given(strange)
def test_no_error_says_anything_hidden_here_or_in_another_process(text):
    errors = [
        InputFileError(text, text, text),
        OutputError(text, text, text),
        SettingError(text),
        TooLargeError(text),
        NoAnswerError(text),
    ]
    for error in errors:
        assert shows_well(str(error))
        assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize("name", ["floor\u202egnp", "flo\x1b[2Jor", "caf\udce9"])
def test_a_map_s_name_is_shown_with_what_is_hidden_in_it(name):
    shown = map_from_bytes(f"{name}.yaml", header(), "m.pgm", pgm([[0]])).name
    assert shows_well(shown)
    assert shown == show_hidden(name)


def test_the_image_that_is_asked_for_is_named_the_way_it_reads():
    files = map_to_bytes(GridMap(np.zeros((2, 2), dtype=np.int8), 0.05), "m")
    text = files["m.yaml"].replace(b"m.pgm", b'"m\\u202emgp.exe"')
    missing = inputs_of({"yaml1": Upload("m.yaml", text)}).missing()
    assert "Load its image, too: m[U+202E]mgp.exe." in missing
