"""Whatever stands in a file: it is read, or refused in one line that names it. `make fuzz` tries longer."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from unittest.mock import Mock

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mapfiles import pgm
from readers import READERS, SHAPES, SLOWER, reads
from repository import ROOT

from algorithms.common.display_text import show_hidden
from algorithms.common.errors import MapMergeError
from algorithms.files.images import image_decoder as image

HEAVY = ROOT / "tests" / "tools" / "heavy.py"


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
    assert show_hidden(said) == said
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


def test_no_file_of_1_mb_keeps_a_reader_busy_or_fills_the_memory():
    """Among them shapes that took a parser from a second to minutes before there was an end to it.

    Memory is counted by process, so they have one of their own. Its bound on time is not one on the clock:
    it counts its own processor time, and allows for a slower processor than the one that the promise is for.
    """
    told = subprocess.run(
        [sys.executable, HEAVY, "--slower", f"{SLOWER}"],
        capture_output=True,
        timeout=300,
        text=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tests" / "support")},
    )
    assert told.returncode == 0, told.stdout + told.stderr
    assert all(f"  {shape}\n" in told.stdout for shape in SHAPES)
    for name in (
        *("P2, comments", "PNG, interlaced", "BMP, short rows", "large PNG, interlaced", "scan"),
        *("JPEG, the largest", "JPEG, many scans", "JPEG, EXIF of many tags", "WebP, the largest"),
    ):
        assert f"read     {name}\n" in told.stdout  # it was not refused for a fault of ours


def slow(_: bytes) -> None:
    deadline = time.thread_time() + 0.02
    while time.thread_time() < deadline:
        pass


def test_a_reader_that_takes_too_long_or_too_much_is_told(monkeypatch):
    with pytest.raises(AssertionError, match=r"^took 0.0 s of processor time; 0.01 s are the most"):
        reads(slow, b"", 0.01)
    reads(slow, b"", 10)
    with pytest.raises(AssertionError, match=r"^made the process .* MB large; 1 MB are the most"):
        reads(lambda data: data, b"", peak=1)
    monkeypatch.setattr(image, "read_netpbm", Mock(side_effect=MemoryError))
    with pytest.raises(AssertionError, match="more memory than there is"):
        reads(READERS["image"][0], pgm([[0]]))
