"""What cannot be written: folders that let nobody in, and disks that are full half-way.

Who runs the tests may be root, whom no mode of a folder keeps out: so a folder of the system is asked
(/sys, where not even root may make a file), or a path below a file, and a disk is full where a process
may write no larger files.
"""

from __future__ import annotations

import errno
import importlib.util
import os
import resource
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import pytest
import trustme
from commandline import ROOT, in_a_process, inputs

from algorithms.common import parallel_kernels as kernels
from algorithms.common.errors import OutputError
from algorithms.files import atomic_write as atomic
from app.cli.main import main
from app.evaluation.sweep.checkpoint import Checkpoint
from app.jobs.executor import Shared, Task
from app.jobs.process_executor import ProcessExecutor

QUICK = ["--swarm.iterations", "5", "--refine.candidates", "1", "--seeds", "1"]


COMMANDS = {
    "merge": lambda case, place: ["merge", *inputs(case), "--out", place],
    "compare": lambda case, place: [
        "compare",
        case,
        "--methods",
        "paper-argmax",
        "--jobs",
        "1",
        "--out",
        place,
    ],
    "sweep": lambda case, place: [
        "sweep",
        case,
        "--x=augment.spread=1,2",
        *QUICK,
        "--jobs=1",
        "--out",
        place,
    ],
    "evaluate": lambda case, place: ["evaluate", case, "--json", place / "a.json"],
    "replay": lambda case, place: ["replay", case, "--out", place / "a.html"],
    "samples": lambda _, place: ["samples", place, "--building", "apartment"],
    "samples that ship": lambda _, place: ["samples", place],
}
WORK = (
    "algorithms.methods.registry.run",
    "app.cli.commands.compare.compare_methods",
    "app.cli.commands.sweep.sweep",
    "app.cli.commands.evaluate.evaluate",
    "algorithms.simulator.samples.generate_cases",
    "algorithms.simulator.samples.regenerate",
)


def ended(words, capsys):
    """Exit status and the one line that is said."""
    status = main(list(map(str, words)))
    said = capsys.readouterr()
    assert said.err.count("\n") == 1, said.err
    assert said.err.startswith("mapmeld: ")
    return status, said.err


def lies_in(folder):
    return {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


@contextmanager
def files_of_at_most(size):
    """As on a full disk: what goes beyond ``size`` bytes of a file is not written."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture
def fills_up(monkeypatch):
    """``fills_up(after)``: no file reaches the disk after so many more."""
    real = os.fsync

    def from_now(after):
        left = [None] * after

        def fsync(stream):
            if not left:
                raise OSError(errno.ENOSPC, "No space left on device")
            left.pop()
            real(stream)

        monkeypatch.setattr(os, "fsync", fsync)

    return from_now


@pytest.fixture(params=["a file", "below a file", "read-only"])
def no_folder(request, tmp_path):
    """A place in which no folder can be made, not even by root; and its part that stands in the way."""
    if request.param == "read-only":
        if sys.platform == "linux":
            return Path("/sys/kernel/mapmeld"), "/sys/kernel/mapmeld"
        (tmp_path / "locked").mkdir(mode=0o500)
        return tmp_path / "locked" / "out", "locked"
    (tmp_path / "file").write_bytes(b"mine")
    return tmp_path / "file" / ("out" * (request.param == "below a file")), "file"


# ---- before the work


@pytest.mark.parametrize("command", COMMANDS)
def test_a_place_that_cannot_be_written_is_told_before_any_work(
    command, no_folder, case_folder, tmp_path, capsys, monkeypatch
):
    def never(*_, **__):
        raise AssertionError("work of which nothing can be left")

    for name in WORK:
        monkeypatch.setattr(name, never)
    place, named = no_folder
    before = lies_in(tmp_path)
    status, said = ended(COMMANDS[command](case_folder, place), capsys)
    assert status == 2
    assert named in said
    assert "choose another place" in said
    assert lies_in(tmp_path) == before


@pytest.mark.parametrize("command", ["evaluate", "replay"])
def test_a_file_that_has_the_name_of_a_folder_is_told_before_any_work(command, case_folder, tmp_path, capsys):
    for name in ("a.json", "a.html"):
        (tmp_path / name).mkdir()
    status, said = ended(COMMANDS[command](case_folder, tmp_path), capsys)
    assert status == 2
    assert "there is a folder of that name" in said


def test_looking_whether_a_folder_can_be_made_does_not_make_it(tmp_path):
    atomic.check_folder(tmp_path / "a" / "b")
    atomic.check_file(tmp_path / "a" / "b" / "c")
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["pipe", "to_the_pipe"])
def test_a_device_or_pipe_is_never_replaced_by_a_file(name, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "to_the_pipe").symlink_to(tmp_path / "pipe")
    for write in (atomic.check_file, lambda path: atomic.write_file(path, b"new")):
        with pytest.raises(OutputError, match="a device or a pipe"):
            write(tmp_path / name)
    assert (tmp_path / "pipe").is_fifo()


# ---- half-way


@pytest.mark.parametrize("command", ["merge", "compare", "sweep", "evaluate", "replay"])
def test_a_disk_that_fills_up_costs_no_old_file_and_leaves_no_half_one(
    command, case_folder, tmp_path, capsys, fills_up
):
    words = COMMANDS[command](case_folder, tmp_path / "out")
    fills_up(after=0 if command in ("evaluate", "replay") else 1)
    status, said = ended(words, capsys)
    assert status == 2
    assert "No space left on device" in said
    assert "has room" in said
    assert {path.name for path in lies_in(tmp_path)} <= {"out", "journal.jsonl"}
    if command != "sweep":
        assert not (tmp_path / "out").exists()


def test_a_merge_that_finds_no_room_leaves_the_earlier_one_whole(case_folder, tmp_path, capsys, fills_up):
    words = COMMANDS["merge"](case_folder, tmp_path)
    assert main(list(map(str, words))) == 0
    capsys.readouterr()
    before = lies_in(tmp_path)
    fills_up(after=3)
    status, said = ended([*words, "--seed", "5"], capsys)
    assert status == 2
    assert "No space left on device" in said
    assert lies_in(tmp_path) == before


def test_a_sweep_goes_on_where_the_disk_was_full(case_folder, tmp_path, capsys, fills_up):
    words = list(map(str, COMMANDS["sweep"](case_folder, tmp_path)))
    fills_up(after=1)
    assert ended(words, capsys)[0] == 2
    fills_up(after=99)
    assert main(words) == 0
    assert "of 2 points are known from before" in capsys.readouterr().out


def test_files_and_folders_of_a_write_that_ended_half_way_are_gone(tmp_path):
    (tmp_path / "old").write_bytes(b"old")
    files = {tmp_path / "old": b"new", tmp_path / "a" / "b": b"1", tmp_path / "c" / "d" / "e": b"2" * 9000}
    with files_of_at_most(4000), pytest.raises(OutputError, match="e: cannot be written"):
        atomic.write_files(files)
    assert lies_in(tmp_path) == {tmp_path / "old": b"old"}


def test_a_half_written_line_of_a_journal_costs_neither_the_lines_before_nor_those_after(tmp_path):
    path = tmp_path / "journal.jsonl"
    journal = Checkpoint(path)
    journal.add("one", {"a": 1})
    with files_of_at_most(path.stat().st_size + 10), pytest.raises(OutputError, match="another --out"):
        journal.add("two", {"a": "2" * 50})
    journal.add("three", {"a": 3})
    again = Checkpoint(path)
    assert [again.get(key) for key in ("one", "two", "three")] == [{"a": 1}, None, {"a": 3}]


# ---- beside what was asked for


def test_a_folder_for_temporary_files_that_cannot_be_used_is_told_with_its_remedy(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "file"))
    with pytest.raises(OutputError, match=r"temporary files: .*\$TMPDIR"):
        list(ProcessExecutor(1).run(pow, [Task(1)]))


def test_what_processes_share_is_told_when_there_is_no_room_for_it(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    shared = Shared.of(os.urandom(9000))
    with files_of_at_most(4000), pytest.raises(OutputError, match=r"temporary files: .*\$TMPDIR"):
        list(ProcessExecutor(1).run(pow, [Task(1, shared)]))
    assert not any(tmp_path.iterdir())


def test_output_that_goes_nowhere_ends_with_2_and_one_line(tmp_path):
    with (tmp_path / "said").open("wb") as full:
        told = subprocess.run(
            [sys.executable, "-m", "app", "--version"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            cwd=ROOT,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)),
        )
    assert told.returncode == 2
    assert told.stderr.count("\n") == 1
    assert "see that there is room where the output goes" in told.stderr


@pytest.mark.parametrize("closed", [1, 2])
def test_a_command_works_where_nobody_listens(closed):
    told = in_a_process("--version", preexec_fn=lambda: os.close(closed))
    assert told.returncode == 0
    assert told.stderr == ""


def test_what_the_system_refuses_is_told_by_name_and_is_no_bug_of_ours(capsys):
    status, said = ended(["compare", "x" * 5000], capsys)
    assert status == 2
    assert "x: File name too long; check the path" in said


def loop_of(path):
    """The loop in a module, which is read anew."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return kernels.kernel(module.twice)


def test_compiled_code_that_cannot_be_kept_or_read_costs_no_merge(tmp_path, monkeypatch, caplog):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    path = tmp_path / "loop.py"
    path.write_text("def twice(x):\n    return x + x\n")
    kernels._say_once.cache_clear()
    with files_of_at_most(100):
        assert loop_of(path)(21) == 42
    assert "compiled code cannot be kept for the next start" in caplog.text
    assert loop_of(path)(21) == 42  # and now it is kept
    (index,) = path.parent.glob("__pycache__/*.nbi")
    whole = index.read_bytes()
    index.write_bytes(b"")  # a power cut
    assert loop_of(path)(21) == 42
    assert "compiled code of an earlier run cannot be used" in caplog.text
    assert index.read_bytes() == whole


# ---- what the page is started with


@pytest.mark.parametrize("flag", ["--token-file", "--certfile", "--keyfile"])
@pytest.mark.parametrize("kind", ["missing", "folder", "empty", "below/a/file"])
def test_a_page_is_not_started_with_a_file_that_cannot_be_read(flag, kind, tmp_path, capsys):
    (tmp_path / "folder").mkdir()
    (tmp_path / "empty").touch()
    (tmp_path / "below").touch()
    words = ["serve", "--no-browser", "--port", "0", flag, tmp_path / kind]
    if flag == "--keyfile":
        cert = trustme.CA().issue_cert("localhost").cert_chain_pems[0]
        cert.write_to_path(str(tmp_path / "cert.pem"))
        words += ["--certfile", tmp_path / "cert.pem"]
    status, said = ended(words, capsys)
    assert status == 2
    assert kind in said or (flag, kind) == ("--keyfile", "empty")  # whose message names the pair's other
    assert ";" in said
