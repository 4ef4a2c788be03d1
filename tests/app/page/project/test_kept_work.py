"""Work that is kept outlives the server, whenever that is killed."""

from __future__ import annotations

import os
import signal
import sqlite3
from collections.abc import Iterator
from dataclasses import replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from random import Random
from stat import S_IMODE
from time import sleep

import numpy as np
import pytest

from algorithms.common.errors import OutputError
from algorithms.maps.grid_map import GridMap
from app.model.merge_inputs import Files, MergeInputs
from app.page.page_state import PageState
from app.page.project.kept_work import KEPT_FILE, KeptWork
from app.page.project.project_writer import project_of
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_history import SavedTab, UndoHistory
from app.web.session_store import SessionStore

KILLS = 20
SEED = 20


def room(number: int, side: int = 60) -> GridMap:
    cells = np.random.default_rng(number).integers(-1, 101, (side, side)).astype(np.int8)
    return GridMap(cells, 0.05, name=f"room {number}")


def saved(history: UndoHistory) -> SavedTab:
    return SavedTab(history.steps, history.position)


def actions(history: UndoHistory, seed: int) -> Iterator[None]:
    """Do one thing after another: other maps, another seed, back and forth; ``history`` tells of each."""
    random, page = Random(seed), PageState().snapshot()
    history.record("begin", replace(page, inputs=MergeInputs.pair(room(0), room(1), (), "0")))
    yield
    for number in range(1, 10_000):
        now = history.snapshot
        assert now is not None
        match random.choice(["maps", "seed", "seed", "seed", "back"]):
            case "maps":
                pair = MergeInputs.pair(room(number), now.inputs.mov, (), f"{number}")
                history.record(f"load {number}", replace(now, inputs=pair, files=Files()))
            case "seed":
                history.record(f"seed {number}", replace(now, seed=number))
            case "back":
                if history.go(random.randrange(len(history.steps))) is None:
                    continue
        yield


def work(folder: Path, seed: int, tell: Connection) -> None:
    """Work in a tab of that folder, and tell of each action once it is kept."""
    kept, history = KeptWork(folder), UndoHistory()
    history.changed = lambda: kept.keep(f"tab {seed}", saved(history))
    for _ in actions(history, seed):
        tell.send(None)


def test_nothing_that_was_done_is_lost_whenever_the_server_is_killed(tmp_path):
    random, context = Random(SEED), get_context("forkserver")
    context.set_forkserver_preload(["app.page.project.kept_work", "app.page.page_state", __name__])
    counts = []
    for seed in range(KILLS):
        hear, tell = context.Pipe(duplex=False)
        worker = context.Process(target=work, args=(tmp_path, seed, tell))
        worker.start()
        tell.close()
        hear.recv()
        sleep(random.random() * 0.15)
        os.kill(worker.pid, signal.SIGKILL)
        worker.join()
        done = 1
        try:
            while True:
                hear.recv()
                done += 1
        except EOFError:
            counts.append(done)
        kept = KeptWork(tmp_path)
        found = kept.take(f"tab {seed}", f"fresh {seed}")
        kept.close()
        assert found is not None
        again, may_be = UndoHistory(), []
        for number, _ in enumerate(actions(again, seed), 1):
            if number >= done:
                may_be.append(project_of(saved(again)).document)
            if number > done:  # it may have been kept, and not told
                break
        assert project_of(found).document in may_be
    assert len(set(counts)) > 2  # they were killed at different actions


@pytest.fixture
def kept(tmp_path) -> Iterator[KeptWork]:
    kept = KeptWork(tmp_path / "work")
    yield kept
    kept.close()


@pytest.fixture
def page() -> PageSnapshot:
    return replace(PageState().snapshot(), inputs=MergeInputs.pair(room(0), room(1), (), "rooms"))


def done(*pages: PageSnapshot) -> SavedTab:
    history = UndoHistory()
    for page in pages:
        history.record("load", page)
    return saved(history)


def test_a_tab_finds_its_work_by_its_newest_key_or_the_one_before_and_nobody_else_does(kept, page):
    kept.keep("first", done(page))
    assert kept.take("first", "thief") is None  # the tab is still there
    kept.leave("first")
    assert kept.take("other", "x") is None
    assert kept.take("first", "second") is not None
    kept.leave("second")
    assert kept.take("first", "third") is not None  # the tab never heard of the second
    kept.move("third", "fourth")
    kept.leave("fourth")
    assert kept.take("first", "x") is None
    kept.keep("fourth", done(page, replace(page, seed=1)))
    kept.leave("fourth")
    assert len(kept.take("third", "x").steps) == 2


def test_a_tab_of_a_server_that_was_killed_finds_its_work_and_a_copy_of_it_begins_anew(page, tmp_path):
    kept = KeptWork(tmp_path)
    store: SessionStore[SavedTab] = SessionStore(shelf=kept)
    key, _ = store.enter("", False, lambda: done(page))
    store.keep(key, done(page))
    kept.close()

    kept = KeptWork(tmp_path)
    store = SessionStore(shelf=kept)
    newer = done(page, replace(page, seed=1))
    key, found = store.enter(key, True, lambda: newer)
    assert [step.label for step in found.steps] == ["load"]
    assert store.enter(key, False, lambda: None)[1] is None  # of a tab that is still there
    store.keep(key, newer)
    store.leave(key)
    other, found = store.enter(key, False, lambda: None)
    assert found is newer  # from memory
    store.leave(other)
    assert len(store.enter(other, False, lambda: None)[1].steps) == 2  # from the folder
    kept.close()


def test_the_folder_is_its_owners_holds_each_file_once_and_no_key_and_one_server_uses_it(
    kept, page, tmp_path
):
    kept.keep("secret key", done(page, replace(page, seed=1)))
    kept.keep("another", done(page))
    folder = tmp_path / "work"
    with pytest.raises(OutputError, match="is used by another server; end that, or give another --keep"):
        KeptWork(folder)
    if os.name == "posix":
        assert S_IMODE(folder.stat().st_mode) == 0o700
    kept.keep("secret key", done(replace(page, inputs=MergeInputs.pair(room(1), room(2)))))
    kept.keep("another", done(replace(page, inputs=MergeInputs.pair(room(1), room(2)))))
    kept.close()
    with sqlite3.connect(folder / KEPT_FILE) as db:
        assert db.execute("select count(*) from files").fetchone() == (2,)
    assert b"secret" not in (folder / KEPT_FILE).read_bytes()


def test_a_folder_that_cannot_be_used_and_a_disk_that_is_full_are_told(kept, page, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError, match="file: cannot be used"):
        KeptWork(tmp_path / "file")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / KEPT_FILE).write_text("no database" * 100)
    with pytest.raises(OutputError, match="not a database"):
        KeptWork(tmp_path / "other")
    kept.keep("tab", done(page))
    pages = kept._db.execute("pragma page_count").fetchone()[0]
    kept._db.execute(f"pragma max_page_count = {pages}")
    large = MergeInputs.pair(room(5, 400), room(1), (), "large")
    with pytest.raises(OutputError, match=r"does not keep your work .*full"):
        kept.keep("tab", done(page, replace(page, inputs=large)))
    kept.leave("tab")
    assert len(kept.take("tab", "x").steps) == 1
