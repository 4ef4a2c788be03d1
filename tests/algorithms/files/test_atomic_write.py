"""Files are written whole or not at all."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.common.errors import OutputError
from algorithms.files import atomic_write as atomic
from algorithms.files.map_file import write_map
from algorithms.maps.grid_map import GridMap


@pytest.fixture
def grid() -> GridMap:
    return GridMap(np.array([[0, 100, -1]], dtype=np.int8), 0.05)


@pytest.mark.parametrize("broken", ["fsync", "replace"])
def test_a_failing_write_leaves_the_old_files_whole(tmp_path, monkeypatch, grid, broken):
    write_map(tmp_path / "m.yaml", grid)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic.os, broken, fail)
    with pytest.raises(OutputError, match=r"m\.pgm.*No space left on device.*; .*disk"):
        write_map(tmp_path / "m.yaml", GridMap(np.zeros((9, 9), dtype=np.int8), 0.1))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_full_disk_at_the_second_file_leaves_the_first_as_it_was(tmp_path, monkeypatch):
    first, second = tmp_path / "first", tmp_path / "second"
    first.write_bytes(b"old")
    calls = []

    def fail_at_second(_: int) -> None:
        calls.append(1)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic.os, "fsync", fail_at_second)
    with pytest.raises(OutputError, match="second"):
        atomic.write_files({first: b"new", second: b"new"})
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("first", b"old")]


@pytest.mark.parametrize("before", [True, False], ids=["before", "behind"])
@pytest.mark.parametrize("call", [1, 2, 3])
@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_an_interrupt_leaves_all_the_old_files_or_all_the_new(tmp_path, monkeypatch, step, call, before):
    old, new = ({tmp_path / name: word for name in "abc"} for word in (b"old", b"new"))
    atomic.write_files(old)
    real, calls = getattr(atomic.os, step), []

    def interrupted(*what: object) -> None:
        calls.append(what)
        if len(calls) == call and before:
            raise KeyboardInterrupt
        real(*what)
        if len(calls) == call:
            raise KeyboardInterrupt

    monkeypatch.setattr(atomic.os, step, interrupted)
    with pytest.raises(KeyboardInterrupt):
        atomic.write_files(new)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == (old if step == "fsync" else new)


def test_a_place_that_cannot_be_written_is_named(tmp_path, grid):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match="file"):
        write_map(tmp_path / "file" / "m.yaml", grid)
    (tmp_path / "m.yaml").mkdir()
    with pytest.raises(OutputError, match=r"m\.yaml.*folder"):
        write_map(tmp_path / "m.yaml", grid)
    with pytest.raises(OutputError, match=r"end in \.yaml"):
        write_map(tmp_path / "m.pgm", grid)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "m.yaml"]


def test_a_link_is_written_through(tmp_path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    atomic.write_file(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_a_written_file_may_be_read_by_whom_the_system_lets(tmp_path):
    (tmp_path / "plain").write_bytes(b"")
    atomic.write_file(tmp_path / "ours", b"")
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "plain").stat().st_mode
