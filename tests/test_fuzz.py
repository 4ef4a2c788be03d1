"""Whatever stands in a file: it is read, or refused in one line that names it. `make fuzz` tries longer."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from readers import READERS, SHAPES, reads

from algorithms.errors import MapMergeError
from algorithms.visible import visible


@st.composite
def damaged(draw: st.DrawFn, good: list[bytes]) -> bytes:
    """A good file with some of it changed, left out, put in twice, or mixed with another."""
    data = draw(st.sampled_from(good))
    for _ in range(draw(st.integers(1, 4))):
        at, to = sorted((draw(st.integers(0, len(data))), draw(st.integers(0, len(data)))))
        match draw(st.sampled_from(["write", "cut", "double", "mix", "number", "text"])):
            case "write":
                put = draw(st.binary(max_size=12))
                data = data[:at] + put + data[at + len(put) :]
            case "cut":
                data = data[:at] + data[to:]
            case "double":
                data = data[:to] + data[at:]
            case "mix":
                data = data[:at] + draw(st.sampled_from(good))[at:]
            case "number":
                put = draw(
                    st.sampled_from(
                        [
                            b"nan",
                            b"1e9",
                            b"-1",
                            b"1e400",
                            b"1e300",
                            b"1e-310",
                            b"0x7",
                            b"99999999999",
                            b"\xff" * 4,
                        ]
                    )
                )
                data = data[:at] + put + data[at:]
            case "text":
                put = draw(
                    st.sampled_from([b'"\\ud800"', b'"\\u202e"', b'"\\e[2J"', b"\xe2\x80\xae", b"\n \n"])
                )
                line = put + b": 1\n"
                data = data[:at] + draw(st.sampled_from([put, line, line * 2])) + data[at:]
    return data


@pytest.mark.parametrize("name", READERS)
@given(st.data())
@settings(max_examples=60)
def test_any_file_is_read_or_refused_in_words(name, data):
    reader, good = READERS[name]
    bad = data.draw(damaged(good))
    said = ""
    try:
        reader(bad)
    except MapMergeError as error:
        said = str(error)
    assert visible(said) == said
    assert len(said) < 1000


@pytest.mark.parametrize("name", READERS)
def test_the_files_that_are_tried_are_read_before_they_are_damaged(name):
    reader, good = READERS[name]
    read = 0
    for data in good:
        try:
            reader(data)
            read += 1
        except MapMergeError:
            pass  # formats that are refused are among them
    assert read >= len(good) / 2


@pytest.mark.parametrize("shape", SHAPES)
def test_no_shape_of_a_file_keeps_a_reader_busy(shape):
    """Each of these took a parser from a second to minutes before there was an end to it."""
    for reader, _ in READERS.values():
        reads(reader, SHAPES[shape])
