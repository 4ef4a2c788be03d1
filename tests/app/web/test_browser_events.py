"""What a browser may tell the page: events that were asked for, in their order, and nothing else."""

from __future__ import annotations

import json
from queue import Queue
from threading import Event
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.web.browser_events import LONGEST, MOST_WAITING, BrowserEvents, Numbers, checked
from app.web.security.message_filter import acceptable, usable

PATIENCE = 20


@pytest.fixture
def channel(server):
    channel = BrowserEvents(
        server.gui, SimpleNamespace(listen=lambda uuid: None, hud=lambda **said: None, flush=lambda: None)
    )
    yield channel
    channel.close()


def message(number: int, name: str = "drag", **fields: object) -> str:
    return json.dumps([number, name, fields])


def test_the_guard_lets_the_browser_write_to_the_channel(channel):
    field = channel._text
    assert usable(channel._text._impl.gui_api, field)
    assert acceptable("x" * LONGEST, "", field._impl.props)


def test_events_are_told_in_their_order_with_their_fields(channel):
    told: Queue[tuple[float, str]] = Queue()
    channel.on("drag", lambda x, phase: told.put((x, phase)), x=float, phase=("start", "end"))
    for number in range(1, 200):
        assert channel.take(message(number, x=number, phase="start"))
    assert [told.get(timeout=PATIENCE) for _ in range(199)] == [(float(k), "start") for k in range(1, 200)]


def test_of_places_on_a_path_the_newest_is_told_and_no_deed_is_lost(channel):
    told: Queue[object] = Queue()
    busy, go_on = Event(), Event()

    def hold() -> None:
        busy.set()
        assert go_on.wait(PATIENCE)

    channel.on("hold", hold)
    channel.on("move", lambda x: told.put(x), latest=True, x=float)
    channel.on("drop", lambda: told.put("drop"))
    channel.take(message(1, "hold"))
    assert busy.wait(PATIENCE)
    for number, (name, fields) in enumerate(
        [("move", {"x": 1}), ("move", {"x": 2}), ("drop", {}), ("move", {"x": 3}), ("move", {"x": 4})], 2
    ):
        assert channel.take(message(number, name, **fields))
    go_on.set()
    assert [told.get(timeout=PATIENCE) for _ in range(3)] == [2.0, "drop", 4.0]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{}",
        "[1]",
        "[" * LONGEST,
        message(1, "unknown", x=1),
        message(1, x=1, y=2),  # a field too many
        message(1),  # and one too few
        message(1, x="1"),
        message(1, x=True),
        message(1, x=None),
        message(1, x=[1]),
        message(1, x=1e12),
        '[1, "drag", {"x": NaN}]',
        '[1, "drag", {"x": 1e999}]',
        '["1", "drag", {"x": 1}]',
        message(1, x=1) + " " * LONGEST,
    ],
)
def test_anything_else_is_dropped_and_the_next_event_still_arrives(channel, text):
    told: Queue[float] = Queue()
    channel.on("drag", lambda x: told.put(x), x=float)
    assert not channel.take(text)
    assert channel.take(message(2, x=7))
    assert told.get(timeout=PATIENCE) == 7.0
    assert told.empty()


def test_a_message_counts_once(channel):
    channel.on("drag", lambda: None)
    assert channel.take(message(3))
    assert not channel.take(message(3))
    assert not channel.take(message(2))


def test_a_flood_is_cut_off(channel):
    busy, go_on = Event(), Event()

    def hold() -> None:
        busy.set()
        assert go_on.wait(PATIENCE)

    channel.on("hold", hold)
    channel.on("drag", lambda: None)
    channel.take(message(1, "hold"))
    assert busy.wait(PATIENCE)
    taken = sum(channel.take(message(number)) for number in range(2, 2 * MOST_WAITING))
    go_on.set()
    assert taken == MOST_WAITING


def test_a_bug_in_a_callback_is_logged_and_the_next_event_arrives(channel, caplog):
    told: Queue[str] = Queue()

    def bug() -> None:
        raise ZeroDivisionError

    channel.on("bug", bug)
    channel.on("fine", lambda: told.put("fine"))
    channel.take(message(1, "bug"))
    channel.take(message(2, "fine"))
    assert told.get(timeout=PATIENCE) == "fine"
    assert "ended in a bug" in caplog.text


@given(st.lists(st.floats(-1e9, 1e9), min_size=2, max_size=5))
def test_numbers_stay_what_they_are(numbers):
    assert checked(json.loads(json.dumps(numbers)), Numbers(2, 5)) == numbers


@given(st.recursive(st.none() | st.text() | st.booleans(), lambda inner: st.lists(inner), max_leaves=4))
def test_what_is_no_number_is_never_taken_for_one(value):
    for kind in (int, float):
        with pytest.raises(ValueError, match="not"):
            checked(value, kind)
