"""What a browser may say once it is in: laws of values and of the rate, and what becomes of the rest."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.web.security import message_filter
from app.web.security.message_filter import (
    BURST,
    RATE,
    WEIGHT,
    MessageFilter,
    RateLimit,
    acceptable,
    listen_unseen,
    usable,
)
from app.web.security.message_schema import MAX_NUMBER, MAX_TEXT

FREE = SimpleNamespace()  # properties of a control without a range or choices
numbers = st.floats(-1e6, 1e6)


class Clock:
    """Time that passes when it is told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def frame(size: int = 0) -> bytes:
    """A message of the page, at least so long."""
    fields = {"type": "GuiUpdateMessage", "uuid": "a", "updates": {"value": "x" * size}}
    return msgspec.msgpack.encode(fields)


# ---- values


@given(numbers, numbers, numbers)
def test_a_number_is_taken_if_it_lies_in_its_range_the_ends_included(value, one, other):
    low, high = sorted((one, other))
    props = SimpleNamespace(min=low, max=high)
    assert acceptable(value, low, props) is (low <= value <= high)
    assert acceptable(low, low, props)
    assert acceptable(high, low, props)


@given(numbers, st.tuples(numbers, numbers))
def test_each_part_of_a_vector_has_the_range_of_its_place(value, ends):
    low, high = min(ends), max(ends)
    props = SimpleNamespace(min=(low, low - 1), max=(high, high + 1))
    assert acceptable([value, low], (0.0, 0.0), props) is (low <= value <= high)
    assert acceptable([low, value], (0.0, 0.0), props) is (low - 1 <= value <= high + 1)


@given(st.text(max_size=3), st.lists(st.text(max_size=3), max_size=4))
def test_of_choices_one_of_them_is_taken_and_nothing_else(value, options):
    assert acceptable(value, "", SimpleNamespace(options=tuple(options))) is (value in options)


KINDS = {
    "a switch": (True, [False, True], [0, 1, "true", None, [True]]),
    "a number": (
        1.5,
        [2, -3.5, MAX_NUMBER, -MAX_NUMBER],
        [True, "2", None, [2], 2 * MAX_NUMBER, -2 * MAX_NUMBER],
    ),
    "a text": ("a", ["", "x" * MAX_TEXT], [1, None, ["a"], "x" * (MAX_TEXT + 1)]),
    "two numbers": ((1.0, 2.0), [[3, 4.5], (0.0, 0.0)], [[1], [1, 2, 3], [1, "2"], [1, True], 1, "12", None]),
    "nothing that a person enters": (None, [], [None, 1, "a"]),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_control_takes_values_of_its_own_kind_alone(kind):
    now, right, wrong = KINDS[kind]
    for value in right:
        assert acceptable(value, now, FREE), value
    for value in wrong:
        assert not acceptable(value, now, FREE), value


@given(
    st.one_of(st.none(), st.booleans(), st.floats(), st.text(max_size=5), st.lists(st.floats(), max_size=3))
)
def test_what_is_no_number_is_taken_for_none_of_a_slider(value):
    taken = acceptable(value, 0.5, SimpleNamespace(min=0.0, max=1.0))
    assert taken is (isinstance(value, float) and 0 <= value <= 1)


# ---- controls


@pytest.fixture(scope="module")
def gui(server):
    return server.gui


def test_what_a_person_cannot_see_or_press_is_not_usable_wherever_that_is_said(gui):
    tabs = gui.add_tab_group()
    with tabs.add_tab("one"), gui.add_folder("outer") as outer, gui.add_folder("inner") as inner:
        button = gui.add_button("press")
    assert usable(gui, button)
    for hidden in (button, inner, outer, tabs):
        hidden.visible = False
        assert not usable(gui, button)
        hidden.visible = True
        assert usable(gui, button)
    button.disabled = True
    assert not usable(gui, button)


def test_a_field_that_no_panel_shows_is_usable_as_long_as_it_is_listened_to(gui):
    field = gui.add_text("hidden", "", visible=False)
    uuid = field._impl.uuid  # viser's own name, as on the wire
    assert not usable(gui, field)
    listen_unseen(uuid)
    assert usable(gui, field)
    listen_unseen(uuid, False)
    assert not usable(gui, field)


def test_only_the_value_of_a_control_that_is_there_is_taken_and_the_rest_is_counted(gui):
    slider = gui.add_slider("slider", min=0, max=10, step=1, initial_value=5)
    gate = MessageFilter()

    def takes(uuid=slider._impl.uuid, **updates):
        return gate.takes(gui, SimpleNamespace(uuid=uuid, updates=updates))

    assert takes(value=7)
    assert not gate.dropped
    assert not takes("of another tab", value=7)
    assert not gate.dropped  # it may have gone while the word was on its way
    assert not takes(value=11)
    assert not takes(value=7, visible=False)
    assert not takes(visible=False)
    slider.disabled = True
    assert not takes(value=7)
    assert gate.dropped == {"value": 1, "property": 2, "not enabled": 1}


# ---- the rate


@given(st.lists(st.tuples(st.floats(0, 5), st.integers(1, 50)), max_size=60))
def test_whatever_is_sent_the_rate_holds_in_the_long_run(sent):
    """Whoever waits as long as is said gets no more through than a burst and the rate."""
    clock, passed = Clock(), 0
    limit, began = RateLimit(RATE, BURST, clock), clock.now
    for pause, weight in sent:
        clock.now += pause
        clock.now += limit.take(weight)
        passed += weight
        assert passed <= BURST + (clock.now - began) * RATE + 1e-6


def test_a_burst_waits_for_nothing_and_what_comes_after_it_for_its_share_of_a_second():
    clock = Clock()
    limit = RateLimit(RATE, BURST, clock)
    assert limit.take(int(BURST)) == 0
    assert limit.take(10) == pytest.approx(10 / RATE)
    clock.now += 20 / RATE
    assert limit.take(10) == pytest.approx(0, abs=1e-9)
    clock.now += 1e6  # a pause earns a burst and no more
    assert limit.take(int(BURST)) == 0
    assert limit.take(1) > 0


# ---- a connection


class Line:
    """A connection on which these frames have come."""

    def __init__(self, *frames: bytes) -> None:
        self.frames, self.closed, self.aborted, self.sent = list(frames), [], 0, []
        self.transport = SimpleNamespace(abort=self.abort)

    def abort(self) -> None:
        self.aborted += 1

    async def recv(self) -> bytes:
        return self.frames.pop(0)

    async def send(self, what: bytes) -> None:
        if what == b"stuck":
            await asyncio.sleep(60)
        self.sent.append(what)

    async def close(self, code: int, why: str) -> None:
        self.closed.append(code)


@pytest.fixture
def waits(monkeypatch):
    """How long was waited, without waiting."""
    told, sleep = [], asyncio.sleep

    async def note(seconds):
        told.append(seconds)
        await sleep(0)

    monkeypatch.setattr(message_filter.asyncio, "sleep", note)
    return told


def test_messages_of_the_page_come_through_and_all_else_is_dropped_and_counted():
    gate, line = MessageFilter(), Line(b"\xc1", msgspec.msgpack.encode({"type": "Other"}), frame())
    gate.guard(line)
    assert asyncio.run(line.recv()) == frame()
    assert gate.dropped == {"garbage": 1, "unasked": 1}
    assert line.closed == [1007]  # by what is no message at all


def test_whoever_sends_too_fast_is_waited_for_and_loses_nothing(waits):
    many = int(BURST) + 5
    gate, line = MessageFilter(Clock()), Line(*[frame()] * many)
    gate.guard(line)

    async def all_of_them():
        return [await line.recv() for _ in range(many)]

    assert asyncio.run(all_of_them()) == [frame()] * many
    assert gate.dropped == {"slowed": 5}
    assert waits == pytest.approx([k / RATE for k in range(1, 6)])


def test_a_long_message_counts_as_many(waits):
    gate = MessageFilter(Clock())
    line = Line(b"\x91" * (100 * WEIGHT), b"\x91" * (300 * WEIGHT), frame())
    gate.guard(line)
    assert asyncio.run(line.recv()) == frame()
    assert waits == pytest.approx([(101 + 301 - BURST) / RATE, (101 + 301 + 1 - BURST) / RATE])


def test_a_browser_that_takes_nothing_any_more_is_given_up(monkeypatch):
    monkeypatch.setattr(message_filter, "PATIENCE", 0.05)
    gate, line = MessageFilter(), Line()
    gate.guard(line)

    async def send():
        await line.send(b"read")
        assert line.aborted == 0
        await line.send(b"stuck")

    asyncio.run(send())
    assert line.sent == [b"read"]
    assert (line.aborted, gate.dropped["does not read"]) == (1, 1)


def test_who_tries_again_and_again_is_in_the_log_a_few_times_not_each_time(caplog):
    gate = MessageFilter()
    for _ in range(20_000):
        gate.drop("request, 401")
    said = [record.getMessage() for record in caplog.records if record.levelname == "WARNING"]
    assert said == ["dropped 1000 times by now: request, 401", "dropped 10000 times by now: request, 401"]
