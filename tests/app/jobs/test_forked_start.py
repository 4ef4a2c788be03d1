"""Processes for merges are copies of one that has loaded everything: of that one, and of nothing else."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from repository import ROOT
from wire import until

from app.jobs.forked_start import FORKS
from app.jobs.runner import RunCallbacks
from app.jobs.warm_up import small_merge
from app.jobs.worker_pool import WorkerPool

copied = pytest.mark.skipif(not FORKS, reason="every process is started anew here")


def python(code: str, *words: object, cwd: Path = ROOT, **env: str) -> list[str]:
    """What a program says on stdout, line by line; it says nothing on stderr."""
    told = subprocess.run(
        [sys.executable, "-c", code, *map(str, words)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(ROOT), **env},
        timeout=250,
    )
    assert told.stderr == ""
    return told.stdout.splitlines()


LOADED = """
import os, sys, threading
from app.jobs import preloaded

print(preloaded.loaded, "numba" in sys.modules, threading.active_count())
if os.fork() == 0:
    os._exit(0)
os.wait()
print(len(os.listdir("/proc/self/task")))
"""


@copied
def test_what_is_copied_has_loaded_everything_and_has_no_thread():
    for _ in small_merge().run({}):  # so that there is compiled code
        pass
    assert python(LOADED) == ["True True 1", "1"]  # BLAS ends its own before a copy is made


@copied
def test_what_is_copied_compiles_nothing(tmp_path):
    code = "from app.jobs import preloaded; print(preloaded.loaded)"
    assert python(code, NUMBA_CACHE_DIR=str(tmp_path)) == ["False"]
    assert not list(tmp_path.rglob("*.nbc"))


PLACES = """
import os
from dataclasses import replace
from app.jobs.runner import RunCallbacks
from app.jobs.warm_up import small_merge, warm_up
from app.jobs.worker_pool import COMMON

print(list(COMMON.runner().steps(replace(small_merge(), steps=warm_up), RunCallbacks())))
print(os.environ["PYTHONPATH"], "PYTHONSAFEPATH" in os.environ)
"""


@copied
def test_what_is_copied_loads_nothing_from_the_current_folder(tmp_path):
    for _ in small_merge().run({}):
        pass
    for name in ("app", "algorithms", "numpy", "yaml"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'taken')!r}, 'w')")
    program = tmp_path / "elsewhere" / "program.py"
    program.parent.mkdir()
    program.write_text(f"if __name__ == '__main__':\n{'    '.join(PLACES.splitlines(keepends=True))}")
    code = "import runpy, sys; sys.path.remove(''); runpy.run_path(sys.argv[1], run_name='__main__')"
    assert python(code, program, cwd=tmp_path) == ["[]", f"{ROOT} False"]
    assert not (tmp_path / "taken").exists()


@copied
def test_where_what_is_copied_was_killed_a_merge_goes_on_and_the_next_process_has_another():
    pool = WorkerPool(most=2)
    bench = pool.runner()
    steps = bench.steps(small_merge(), RunCallbacks())
    next(steps)
    (pid,) = pool.pids
    parent = int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    assert parent != os.getpid()
    os.kill(parent, signal.SIGKILL)
    until(lambda: not Path(f"/proc/{parent}/exe").exists(), "its end")
    assert list(steps)[-1].detail.method
    beside = pool.runner()
    assert list(beside.steps(small_merge(), RunCallbacks()))[-1].detail.method
    assert list(bench.steps(small_merge(), RunCallbacks()))[-1].detail.method
    for place in (bench, beside):
        place.close()
    pool.close()
