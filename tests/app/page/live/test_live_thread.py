"""Following robots beside a page: told in turn, and nothing after it was stopped."""

from __future__ import annotations

import threading
from itertools import count

import pytest

from algorithms.common.errors import MapMergeError, SettingError
from app.page.live import live_thread
from app.page.live.live_thread import BUSY, MOST_AT_ONCE, LiveThread
from app.page.page_state import TabLocks


class Told:
    """What a page is told, and when there is enough of it."""

    def __init__(self, enough: int = 1) -> None:
        self.shown, self.why, self.locks = [], [], TabLocks()
        self.enough, self.done = enough, threading.Event()

    def show(self, picture) -> None:
        self.shown.append(picture)
        if len(self.shown) >= self.enough:
            self.done.set()

    def ended(self, why: str) -> None:
        self.why.append(why)
        self.done.set()

    def follow(self, pictures) -> LiveThread:
        return LiveThread(self.locks, pictures, self.show, self.ended)


def counting(stop):
    for number in count():
        if stop.wait(0.001):
            return
        yield number


def test_pictures_are_told_in_their_order_until_it_is_stopped():
    told = Told(enough=3)
    thread = told.follow(counting)
    assert told.done.wait(30)
    with told.locks.action:
        thread.stop()
        shown = list(told.shown)
    threading.Event().wait(0.05)
    assert told.shown == shown == list(range(len(shown)))


def test_why_it_cannot_go_on_is_told_and_a_bug_is_none_of_the_pages():
    def refused(stop):
        raise SettingError("there is no such domain")
        yield

    def bug(stop):
        yield 1
        raise KeyError("oh")

    for pictures, said in ((refused, "there is no such domain"), (bug, "KeyError")):
        told = Told(enough=99)
        told.follow(pictures)
        assert told.done.wait(30)
        assert said in told.why[0]


def test_so_many_tabs_follow_robots_at_once_and_one_more_is_told_so(monkeypatch):
    monkeypatch.setattr(live_thread, "PATIENCE", 0.05)
    monkeypatch.setattr(live_thread, "_places", threading.BoundedSemaphore(MOST_AT_ONCE))
    tabs = [Told() for _ in range(MOST_AT_ONCE)]
    threads = [tab.follow(counting) for tab in tabs]
    with pytest.raises(MapMergeError, match=BUSY.split(";")[0]):
        Told().follow(counting)
    for thread in threads:
        thread.stop()
    monkeypatch.setattr(live_thread, "PATIENCE", 30.0)
    Told().follow(counting).stop()
