"""Work of which only the newest request counts."""

from __future__ import annotations

from queue import Queue
from threading import Event

from app.jobs.latest_request import LatestRequest

PATIENCE = 20


def test_what_was_asked_before_the_newest_is_passed_over_and_a_bug_ends_nothing():
    done: Queue[int] = Queue()
    busy, go_on = Event(), Event()

    def work(number: int) -> None:
        if number == 0:
            busy.set()
            assert go_on.wait(PATIENCE)
        if number == 3:
            done.put(number)
            raise ZeroDivisionError
        done.put(number)

    newest = LatestRequest(work, "test")
    newest.ask(0)
    assert busy.wait(PATIENCE)
    for number in (1, 2, 3):
        newest.ask(number)
    assert newest.newer_within(0)
    go_on.set()
    assert [done.get(timeout=PATIENCE) for _ in range(2)] == [0, 3]
    newest.ask(4)
    assert done.get(timeout=PATIENCE) == 4
    assert not newest.newer_within(0.01)
    newest.close()


def test_what_was_dropped_is_not_worked_on():
    done: Queue[int] = Queue()
    busy, go_on = Event(), Event()

    def work(number: int) -> None:
        if number == 0:
            busy.set()
            assert go_on.wait(PATIENCE)
        done.put(number)

    newest = LatestRequest(work, "test")
    newest.ask(0)
    assert busy.wait(PATIENCE)
    newest.ask(1)
    newest.drop()
    go_on.set()
    assert done.get(timeout=PATIENCE) == 0
    newest.ask(2)
    assert done.get(timeout=PATIENCE) == 2
    newest.close()
