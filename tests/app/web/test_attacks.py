"""What someone who is in may send: each attack works on viser as it comes, and not on a server of ours."""

from __future__ import annotations

import contextlib
import logging
import math
import struct
import time
from collections.abc import Callable
from copy import copy
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strangers import PATIENCE, Stand, Visitor
from websockets.frames import Frame, Opcode
from wire import CAMERA, WireFile, until

from app.web.security.frame_limit import EARNS, MOST, FrameLimit
from app.web.security.message_schema import MAX_PARTS, MAX_WORDS, fault
from app.web.upload import MAX_UPLOAD, MAX_UPLOADS_OF_ALL, Recipient
from app.web.upload import MOST as MAX_FRAME


def told(stand: Stand, do: Callable[[Visitor], None]) -> tuple[list[tuple[str, Any]], Visitor]:
    """What has come of something that a visitor did."""
    visitor = Visitor(stand)
    had = len(stand.done)
    do(visitor)
    assert visitor.has_been_heard()
    return [what for what in stand.done[had:] if what[0] != "text"], visitor


ABUSES: dict[str, Callable[[Visitor], None]] = {
    "a value beyond its range": lambda v: v.write(v.room.slider, value=1e9),
    "a choice that is none": lambda v: v.write(v.room.dropdown, value="<script>alert(1)</script>"),
    "a press of a disabled button": lambda v: v.write(v.room.disabled, value=True),
    "a press of a hidden button": lambda v: v.write(v.room.hidden, value=True),
    "a text of a megabyte": lambda v: v.write(v.room.note, value="x" * 1_000_000),
    "a value of another type": lambda v: v.write(v.room.slider, value="7"),
    "what is no number": lambda v: v.write(v.room.angle, value=math.nan),
    "what is no number, as a word": lambda v: v.write(v.room.angle, value="nan"),
    "a number without end": lambda v: v.write(v.room.number, value=-math.inf),
    "a number larger than any": lambda v: v.write(v.room.number, value=1e300),
}


@pytest.mark.parametrize("abuse", ABUSES.values(), ids=ABUSES)
def test_a_control_takes_only_what_a_person_could_have_entered(stock, ours, abuse):
    happened, visitor = told(stock, abuse)
    assert happened
    visitor.socket.close()
    dropped = sum(ours.server.gate.dropped.values())
    happened, visitor = told(ours, abuse)
    assert happened == []
    assert sum(ours.server.gate.dropped.values()) == dropped + 1
    visitor.socket.close()


@pytest.mark.parametrize("value", ["abc", math.nan, math.inf])
def test_what_viser_would_stumble_over_does_not_reach_it(stock, ours, value, caplog):
    """A whole number cannot be made of these: viser keeps the one it had, and its task ends in a trace."""
    for stand in (stock, ours):
        caplog.clear()
        before = ours.server.gate.dropped["value"]
        _, visitor = told(stand, lambda visitor: visitor.write(visitor.room.slider, value=value))
        assert visitor.room.slider.value == 5
        visitor.socket.close()
        if stand is stock:
            until(lambda: "Task exception was never retrieved" in caplog.text, "the trace", PATIENCE)
            assert "_handle_gui_updates" in caplog.text
        else:
            assert caplog.text == ""
            assert ours.server.gate.dropped["value"] == before + 1


WRITES: dict[str, tuple[str, dict[str, Any]]] = {
    "what a control of everyone does": ("shared", {"update_cb": []}),
    "what it does, beside a value": ("slider", {"value": 7, "update_cb": []}),
    "that it is gone": ("slider", {"removed": True}),
    "that it is gone, beside a value": ("slider", {"value": 7, "removed": True}),
}


@pytest.mark.parametrize(("which", "updates"), WRITES.values(), ids=WRITES)
def test_only_the_value_of_a_control_can_be_written(stock, ours, which, updates):
    for stand in (stock, ours):
        before = ours.server.gate.dropped["property"]
        visitor = Visitor(stand)
        control = stand.shared if which == "shared" else visitor.room.slider
        was = {name: copy(getattr(control._impl, name)) for name in updates}
        assert all(was[name] != updates[name] for name in updates)
        visitor.write(control, **updates)
        assert visitor.has_been_heard()
        now = {name: getattr(control._impl, name) for name in updates}
        assert now == (updates if stand is stock else was)
        assert ours.server.gate.dropped["property"] == before + (stand is ours)
        visitor.socket.close()


NOISE: dict[str, bytes | str] = {
    "random bytes": bytes(range(256)),
    "a text": "hello",
    "no mapping": msgspec.msgpack.encode([1, 2]),
    "no type": msgspec.msgpack.encode({"a": 1}),
    "a very deep one": b"\x91" * 100_000,
}


@pytest.mark.parametrize("noise", NOISE.values(), ids=NOISE)
def test_garbage_ends_the_connection_it_came_by_and_nothing_else(stock, ours, noise, caplog):
    """viser stumbles: that, too, ends one connection alone, and a trace of it fills the log."""
    caplog.set_level(logging.INFO)
    for stand, code in ((stock, 1011), (ours, 1007)):
        caplog.clear()
        other, visitor = Visitor(stand), Visitor(stand)
        visitor.socket.send(noise)
        visitor.hears_out()
        assert visitor.socket.close_code == code
        assert other.has_been_heard()
        other.socket.close()
        assert ("Traceback" in caplog.text) is (stand is stock)


def stumbles(visitor: Visitor) -> bool:
    visitor.hears_out()
    return visitor.socket.close_code == 1011


def passes_over_it(visitor: Visitor) -> bool:
    return visitor.has_been_heard()


def looks_from_nowhere(visitor: Visitor) -> bool:
    return visitor.has_been_heard() and math.isnan(visitor.room.client.camera.position[0])


# A message, and what viser does with it
ODD: dict[str, tuple[str, dict[str, Any], Callable[[Visitor], bool]]] = {
    "of no kind that there is": ("Nothing", {}, stumbles),
    "of a kind that only a server sends": ("RunJavascriptMessage", {"source": "alert(1)"}, passes_over_it),
    "without its fields": ("GuiUpdateMessage", {}, stumbles),
    "with a field too many": ("GuiUpdateMessage", {"uuid": "x", "updates": {}, "more": 1}, stumbles),
    "about a number as a name": ("GuiUpdateMessage", {"uuid": 5, "updates": {}}, passes_over_it),
    "with a camera nowhere": (
        "ViewerCameraMessage",
        {**CAMERA, "position": [math.nan] * 3},
        looks_from_nowhere,
    ),
}


@pytest.mark.parametrize(("kind", "fields", "as_it_comes"), ODD.values(), ids=ODD)
def test_a_message_that_the_page_never_sends_is_dropped_and_counted(stock, ours, kind, fields, as_it_comes):
    visitor = Visitor(stock)
    visitor.send(kind, **fields)
    assert as_it_comes(visitor)
    visitor.socket.close()
    before = ours.server.gate.dropped.copy()
    visitor = Visitor(ours)
    visitor.send(kind, **fields)
    assert visitor.has_been_heard()
    assert visitor.room.client.camera.position[2] == CAMERA["position"][2]
    visitor.socket.close()
    assert sum((ours.server.gate.dropped - before).values()) == 1


def colliding(count: int) -> bytes:
    """A mapping of integers, which are their own hashes: each looks for its place where all others lie."""
    size = 2**15
    last, found, perturbed, place = (1 << 59) + 12345, {}, (1 << 59) + 12345, ((1 << 59) + 12345) % size
    while len(found) < size * 5 // 8:  # in the order in which a dictionary would look for the last one
        found[place] = None
        perturbed >>= 5
        place = (place * 5 + perturbed + 1) % size
    pairs = [msgspec.msgpack.encode(key) + b"\xc0" for key in [*found, *[last] * count]]
    return b"\xdf" + struct.pack(">I", len(pairs)) + b"".join(pairs)


def update(value: bytes) -> bytes:
    fields = {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": msgspec.Raw(value)}}
    return msgspec.msgpack.encode(fields)


def seconds(do: Callable[[], object]) -> float:
    began = time.thread_time()
    do()
    return time.thread_time() - began


def test_no_mapping_is_built_of_what_a_stranger_chose(ours):
    """viser reads it as it comes: a megabyte of it stops everything for a minute."""
    slow = update(colliding(2000))
    assert len(slow) < MAX_FRAME
    theirs = seconds(lambda: msgspec.msgpack.decode(slow))
    assert theirs > 20 * seconds(lambda: fault(slow))
    assert fault(slow) == "too long"
    assert fault(update(msgspec.msgpack.encode({1: 2}))) == "malformed"
    visitor = Visitor(ours)
    visitor.socket.send(slow)
    assert visitor.has_been_heard()
    visitor.socket.close()


PLAIN = st.none() | st.booleans() | st.integers(-9, 9) | st.floats() | st.text(max_size=9)
ANYTHING = st.recursive(
    PLAIN | st.binary(max_size=9),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.text(max_size=3) | st.integers(-9, 2**63), inner, max_size=3)
    ),
)


@given(ANYTHING)
def test_the_value_of_a_control_is_a_word_a_number_or_a_short_list_of_them(value):
    plain = None | bool | int | float | str
    flat = isinstance(value, plain) or (isinstance(value, list) and all(isinstance(v, plain) for v in value))
    assert fault(update(msgspec.msgpack.encode(value))) == ("" if flat else "malformed")


def test_a_message_is_short():
    for value, wrong in (
        ([1.5] * MAX_PARTS, ""),
        ([1.5] * (MAX_PARTS + 1), "malformed"),
        ("x" * MAX_WORDS, "too long"),
    ):
        assert fault(update(msgspec.msgpack.encode(value))) == wrong


@pytest.fixture
def still(ours, monkeypatch):
    """Until one is slowed no time passes for the rates: all that a visitor sends comes at once, however slow
    the machine."""
    gate, began = ours.server.gate, time.monotonic()
    before = gate.dropped["slowed"]

    def clock() -> float:
        return time.monotonic() if gate.dropped["slowed"] > before else began

    monkeypatch.setattr(gate, "_clock", clock)


def test_long_messages_count_as_several(ours, still):
    nested = msgspec.msgpack.encode([[]] * (MAX_FRAME - 1000))
    before = ours.server.gate.dropped.copy()
    visitor = Visitor(ours)
    for _ in range(14):  # a megabyte each
        visitor.socket.send(update(nested))
    assert visitor.has_been_heard()
    visitor.socket.close()
    assert (ours.server.gate.dropped - before)["slowed"] >= 1
    assert (ours.server.gate.dropped - before)["too long"] == 14


def test_a_frame_larger_than_any_of_the_page_ends_its_connection(stock, ours):
    frame = b"x" * (MAX_FRAME + 1)
    stock_visitor, visitor = Visitor(stock), Visitor(ours)
    for one, code in ((stock_visitor, 1011), (visitor, 1009)):  # 1011: stock has read it, and stumbled
        one.socket.send(frame)
        one.hears_out()
        assert one.socket.close_code == code


def test_who_sends_too_fast_is_slowed_and_loses_nothing(ours, still):
    visitor = Visitor(ours)
    before = ours.server.gate.dropped["slowed"]
    for k in range(600):
        visitor.write(visitor.room.slider, value=k % 11)
    assert visitor.has_been_heard()
    assert ours.server.gate.dropped["slowed"] > before
    assert visitor.room.slider.value == 599 % 11
    visitor.socket.close()


# --- frames that are no messages --------------------------------------------------------------------


def raw(opcode: Opcode, data: bytes = b"", fin: bool = True) -> bytes:
    return Frame(opcode, data, fin).serialize(mask=True)


def in_frames(message: bytes, between: int) -> bytes:
    """A message in two frames, with empty ones between them."""
    first, last = raw(Opcode.BINARY, message[:1], fin=False), raw(Opcode.CONT, message[1:])
    return first + raw(Opcode.CONT, fin=False) * between + last


EMPTY: dict[str, bytes] = {
    "a message of empty frames": in_frames(b"\x80", 5000),
    "pings": raw(Opcode.PING, b"x" * 10) * 5000,
    "answers to no ping": raw(Opcode.PONG) * 5000,
}


@pytest.mark.parametrize("flood", EMPTY.values(), ids=EMPTY)
def test_frames_that_say_nothing_end_their_connection_and_no_other(ours, flood, caplog):
    other, visitor = Visitor(ours), Visitor(ours)
    before = ours.server.gate.dropped["frames"]
    with contextlib.suppress(OSError):  # it may end before all is sent
        visitor.socket.socket.sendall(flood)
    visitor.hears_out()
    assert visitor.socket.close_code == 1006
    assert other.has_been_heard()
    other.socket.close()
    assert ours.server.gate.dropped["frames"] == before + 1
    assert caplog.text == ""


def test_viser_as_it_comes_takes_any_number_of_them(stock):
    visitor = Visitor(stock)
    fields = {"type": "GuiUpdateMessage", "uuid": visitor.room.slider._impl.uuid, "updates": {"value": 7}}
    visitor.socket.socket.sendall(in_frames(msgspec.msgpack.encode(fields), 5000))
    visitor.socket.socket.sendall(EMPTY["answers to no ping"])
    assert visitor.has_been_heard()
    assert visitor.room.slider.value == 7
    visitor.socket.close()


def test_a_message_may_come_in_pieces(ours):
    visitor = Visitor(ours)
    fields = {"type": "GuiUpdateMessage", "uuid": visitor.room.slider._impl.uuid, "updates": {"value": 7}}
    visitor.socket.socket.sendall(in_frames(msgspec.msgpack.encode(fields), 500))
    assert visitor.has_been_heard()
    assert visitor.room.slider.value == 7
    visitor.socket.close()


def test_pieces_as_browsers_send_them_may_be_any_number_at_any_speed():
    allowance = FrameLimit(clock=lambda: 0.0)  # no time goes by
    for _ in range(200):
        pieces = [Frame(Opcode.BINARY, bytes(4 * EARNS), fin=False)]
        pieces += [Frame(Opcode.CONT, bytes(size), fin=False) for size in (1, 2 * EARNS) * 400]
        assert all(map(allowance.allows, pieces))


def test_who_sends_few_empty_ones_may_go_on_and_no_message_has_more_than_enough():
    now = [0.0]
    allowance = FrameLimit(clock=lambda: now[0])
    borne = 0
    while allowance.allows(Frame(Opcode.CONT, b"", fin=False)):
        now[0] += 1.0
        borne += 1
    assert borne == MOST
    for _ in range(3 * MOST):
        now[0] += 1.0
        assert not allowance.allows(Frame(Opcode.CONT, b"", fin=False))


# --- what an upload may do --------------------------------------------------------------------------


@pytest.mark.parametrize("size", [10, MAX_UPLOAD + 1, -5])
def test_no_file_comes_by_the_connection_of_the_page(stock, ours, size):
    for stand, begun in ((stock, 1), (ours, 0)):
        visitor = Visitor(stand)
        transfer = visitor.start_upload("map.pgm", size)
        visitor.send(
            "FileTransferPart",
            source_component_uuid=None,
            transfer_uuid=transfer,
            part_index=7,
            content=b"x" * 10,
        )
        assert visitor.has_been_heard()
        assert len(visitor.coming) == begun
        visitor.socket.close()


def test_a_file_is_no_larger_than_any_map(stock, ours):
    visitor = Visitor(stock)
    visitor.start_upload("map.pgm", 1000 * MAX_UPLOAD)
    assert visitor.has_been_heard()
    assert len(visitor.coming) == 1
    visitor.socket.close()
    visitor = Visitor(ours)
    assert WireFile(visitor, "upload", "map.pgm", b"", size=MAX_UPLOAD + 1).over() == "refused"
    assert not visitor.coming
    assert "most" in WireFile(visitor, "upload", "map.pgm", b"", size=MAX_UPLOAD).hear()
    visitor.socket.close()


def test_no_tab_makes_the_server_hold_more_than_two_large_files(stock, ours):
    visitor = Visitor(stock)
    for _ in range(6):
        visitor.start_upload("map.pgm", MAX_UPLOAD)
    assert visitor.has_been_heard()
    assert len(visitor.coming) == 6
    visitor.socket.close()
    visitor = Visitor(ours)
    files = [WireFile(visitor, "upload", "map.pgm", b"", size=MAX_UPLOAD) for _ in range(2)]
    assert all("most" in file.hear() for file in files)
    assert WireFile(visitor, "upload", "map.pgm", b"", size=1).over() == "refused"
    assert len(visitor.coming) == 2
    visitor.socket.close()


def test_all_tabs_together_make_the_server_hold_no_more_than_it_bears(stock, ours):
    visitors = [Visitor(stock) for _ in range(3)]
    for visitor in visitors * 2:
        visitor.start_upload("map.pgm", MAX_UPLOAD)
    for visitor in visitors:
        assert visitor.has_been_heard()
        assert len(visitor.coming) == 2
        visitor.socket.close()
    until(lambda: not ours.server.get_clients(), "those of other tests to have gone", PATIENCE)
    most = MAX_UPLOADS_OF_ALL // MAX_UPLOAD
    visitors = [Visitor(ours) for _ in range(most // 2 + 1)]
    files = [
        WireFile(visitor, "upload", "map.pgm", b"", size=MAX_UPLOAD) for visitor in (visitors * 2)[:most]
    ]
    assert all("most" in file.hear() for file in files)
    last, refused = visitors[-1], []
    ours.server.uploads.connect(last.room.client.client_id, Recipient(lambda can: None, refused.append))
    before = ours.server.gate.dropped.copy()
    assert WireFile(last, "upload", "one more.pgm", b"", size=MAX_UPLOAD).over() == "refused"
    assert ours.server.gate.dropped - before == {"uploads of all": 1}
    until(lambda: refused, "the reason", PATIENCE)
    assert "one more.pgm: too much is on its way already" in str(refused[0])
    files[0].socket.close()  # and once one of them has gone, another may come
    until(lambda: len(visitors[0].coming) == 1, "room", PATIENCE)
    assert "most" in WireFile(last, "upload", "one more.pgm", b"", size=MAX_UPLOAD).hear()
    for visitor in visitors:
        visitor.socket.close()


def test_no_file_is_taken_by_a_control_that_takes_none(stock, ours):
    visitor = Visitor(stock)
    visitor.start_upload("map.pgm", 10, control="slider")
    assert visitor.has_been_heard()
    assert len(visitor.coming) == 1
    visitor.socket.close()
    visitor = Visitor(ours)
    for control in ("slider", "text", "hidden"):
        assert WireFile(visitor, control, "map.pgm", b"P5").over() == "refused"
    visitor.socket.close()


def test_a_file_that_keeps_to_the_rules_arrives(ours):
    visitor = Visitor(ours)
    file = WireFile(visitor, "upload", "map.pgm", bytes(MAX_FRAME + 10))
    for size in (MAX_FRAME, 10):
        file.part(size)
    assert file.over() == "arrived"
    until(lambda: ("upload", "map.pgm") in ours.done, "the button to have it", PATIENCE)
    visitor.socket.close()
