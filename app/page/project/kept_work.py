"""Work of the tabs of a server in a folder that outlives it, whenever it is killed: ``mapmeld serve --keep``.

SQLite sees to it that nothing is half-written, and that one server alone uses the folder.
"""

from __future__ import annotations

import logging
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from threading import Lock

from algorithms.common.errors import MapMergeError, OutputError
from app.page.project.project_reader import saved_tab
from app.page.project.project_writer import bounded_project
from app.page.undo.undo_history import SavedTab

log = logging.getLogger(__name__)

KEPT_FILE = "kept.sqlite"
MOST_TABS = 100  # whose work is kept; that of those that did nothing for longest goes first
MINE = 0o600  # what a folder of all may be, the file is its owner's
TABLES = """
create table if not exists tabs (
    id integer primary key, key text unique, before text, document blob, turn integer);
create table if not exists files (digest text primary key, content blob);
create table if not exists uses (tab integer, digest text, primary key (tab, digest));
"""
FORGET = (
    "delete from tabs where id not in (select id from tabs order by turn desc limit ?)",
    "delete from uses where tab not in (select id from tabs)",
    "delete from files where digest not in (select digest from uses)",
)


class KeptWork:
    """By the secret keys of the tabs, of which the folder holds the hashes alone.

    A tab gets a new key whenever it comes. Until it has come with that, the one before holds as well: it may
    never have heard of the new one.
    """

    def __init__(self, folder: Path) -> None:
        """raises : OutputError where the folder cannot be used, or another server uses it"""
        self._path = folder / KEPT_FILE
        self._lock = Lock()
        self._open: set[int] = set()  # tabs that are there
        self._written: dict[int, bytes] = {}  # the document of each
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            os.close(os.open(self._path, os.O_CREAT | os.O_RDWR, MINE))
            self._db = sqlite3.connect(self._path, timeout=0.0, check_same_thread=False)
            self._db.execute("pragma locking_mode = exclusive")
            self._db.execute("pragma journal_mode = wal")
            self._db.execute("pragma synchronous = full")
            self._db.executescript(f"begin exclusive; {TABLES} commit;")
        except (OSError, sqlite3.Error) as error:
            taken = "locked" in str(error)
            cause = "is used by another server" if taken else f"cannot be used ({error})"
            raise OutputError(folder, cause, "end that, or give another --keep") from error

    def close(self) -> None:
        """Another server may use the folder."""
        with self._lock:
            self._db.close()

    def keep(self, key: str, saved: SavedTab) -> None:
        """Have it on the disk before this returns; raises OutputError: what was kept before still is."""
        project = bounded_project(saved)
        with self._transaction() as db:
            tab = self._tab(key)
            if tab is not None and self._written.get(tab) == project.document:
                return
            for digest, content in project.contents.items():
                if not db.execute("select 1 from files where digest = ?", (digest,)).fetchone():
                    db.execute("insert into files values (?, ?)", (digest, content()))
            if tab is None:
                tab = db.execute("insert into tabs (key) values (?)", (_hashed(key),)).lastrowid
                assert tab is not None
            turn = "(select coalesce(max(turn), 0) + 1 from tabs)"
            db.execute(f"update tabs set document = ?, turn = {turn} where id = ?", (project.document, tab))
            db.execute("delete from uses where tab = ?", (tab,))
            db.executemany("insert into uses values (?, ?)", [(tab, digest) for digest in project.contents])
            self._forget(db)
        self._open.add(tab)
        self._written[tab] = project.document

    def take(self, key: str, fresh: str) -> SavedTab | None:
        """What a tab left that comes with its key, and is known by a fresh one from now on; None: nothing, or
        the tab is still there.
        """
        try:
            with self._transaction() as db:
                tab = self._tab(key)
                if tab is None or tab in self._open:
                    return None
                (document,) = db.execute("select document from tabs where id = ?", (tab,)).fetchone()
                saved = saved_tab("what was kept", document, self._content)
                self._rename(db, tab, key, fresh)
                return saved
        except MapMergeError as error:  # it may be of another version
            log.warning("the work of a tab is not at hand: %s", error)
            return None

    def move(self, key: str, fresh: str) -> None:
        """The tab of this key is known by a fresh one from now on."""
        try:
            with self._transaction() as db:
                tab = self._tab(key)
                if tab is not None:
                    self._rename(db, tab, key, fresh)
        except OutputError as error:
            log.warning("%s", error)

    def leave(self, key: str) -> None:
        """The tab of this key has gone."""
        with self._lock, suppress(sqlite3.Error):  # it may be closed
            tab = self._tab(key)
            if tab is not None:
                self._open.discard(tab)
                self._written.pop(tab, None)

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        """All of it is done, or nothing."""
        with self._lock:
            try:
                with self._db:
                    yield self._db
            except sqlite3.Error as error:
                remedy = "see that the disk has room; what is on the page is safe as long as it is open"
                raise OutputError(self._path, f"does not keep your work ({error})", remedy) from error

    def _rename(self, db: sqlite3.Connection, tab: int, key: str, fresh: str) -> None:
        names = _hashed(fresh), _hashed(key), tab
        db.execute("update tabs set key = ?, before = ? where id = ?", names)
        self._open.add(tab)

    def _tab(self, key: str) -> int | None:
        name = _hashed(key)
        found = self._db.execute("select id from tabs where key = ? or before = ?", (name, name)).fetchone()
        return None if found is None else int(found[0])

    def _content(self, digest: str) -> bytes | None:
        found = self._db.execute("select content from files where digest = ?", (digest,)).fetchone()
        return None if found is None else bytes(found[0])

    def _forget(self, db: sqlite3.Connection) -> None:
        """Let go of the oldest work, and of files that no work names."""
        first, *rest = FORGET
        db.execute(first, (MOST_TABS,))
        for statement in rest:
            db.execute(statement)


def _hashed(key: str) -> str:
    return sha256(key.encode()).hexdigest()
