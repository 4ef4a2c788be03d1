"""Follows robots that run beside the page, in a thread of its own."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from threading import BoundedSemaphore, Event, Thread
from typing import TYPE_CHECKING

from algorithms.common.errors import MapMergeError
from app.page.page_state import TabLocks

if TYPE_CHECKING:  # it loads what merges: a page that follows no robots does without
    from app.live.watch.live_watch import LivePicture

log = logging.getLogger(__name__)

MOST_AT_ONCE = 4  # tabs of a server that follow robots
BUSY = f"{MOST_AT_ONCE} tabs of this server follow robots already; end it in one of them"

PATIENCE = 1.0  # seconds in which one that was stopped leaves its place

_places = BoundedSemaphore(MOST_AT_ONCE)


class LiveThread:
    """Of one run. Whoever calls ``stop`` holds the action lock: nothing is told from then on.

    follow : gives picture after picture until its event is set
    show   : is told each, while nobody else acts or draws
    ended  : is told why it could not go on, as a sentence
    """

    def __init__(
        self,
        locks: TabLocks,
        follow: Callable[[Event], Iterator[LivePicture]],
        show: Callable[[LivePicture], None],
        ended: Callable[[str], None],
    ) -> None:
        if not _places.acquire(timeout=PATIENCE):
            raise MapMergeError(BUSY)
        self._locks, self._follow, self._show, self._ended = locks, follow, show, ended
        self._place = _places
        self._stop = Event()
        Thread(target=self._run, name="mapmeld-live", daemon=True).start()

    def stop(self) -> None:
        self._stop.set()

    def _run(self) -> None:
        try:
            for picture in self._follow(self._stop):
                self._tell(lambda picture=picture: self._show(picture))
        except MapMergeError as error:
            why = str(error)
            self._tell(lambda: self._ended(why))
        except Exception as error:
            log.exception("following robots ended in a bug")
            said = f"A bug of mapmeld's ended it ({type(error).__name__}); the server's log has the details."
            self._tell(lambda: self._ended(said))
        finally:
            self._place.release()

    def _tell(self, tell: Callable[[], None]) -> None:
        while not self._stop.is_set():
            if self._locks.action.acquire(timeout=0.1):  # who holds it may be about to stop this
                try:
                    with self._locks.drawing:
                        if not self._stop.is_set():
                            tell()
                    return
                finally:
                    self._locks.action.release()
