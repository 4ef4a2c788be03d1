"""Files on their way: they arrive whole or not at all, can be left, and keep to the limits."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator

import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from wire import WireFile, WireTab, until

from algorithms.files.case_folder import Case
from algorithms.files.map_file import map_to_bytes
from app.model.files.file_reader import upload_at
from app.model.merge_inputs import Upload
from app.page.application import make_server
from app.web.security.access_control import Access
from app.web.upload import LEAST, MAX_UPLOAD, MAX_UPLOADS, MOST, Recipient
from app.web.viser_server import guarded_server

BUTTON = "Open files…"
LONG = b"P5\n# \n" + bytes(3 * MOST)


@pytest.fixture(scope="module")
def server(small_case: Case) -> Iterator[viser.ViserServer]:
    server = make_server(port=0, initial=small_case)
    yield server
    server.stop()


@pytest.fixture
def tab(server) -> Iterator[WireTab]:
    tab = WireTab(server.get_port())
    yield tab
    tab.close()
    until(lambda: not server.get_clients(), "the session to end")


@pytest.fixture
def at_once(monkeypatch) -> None:
    """Every file takes long."""
    monkeypatch.setattr("app.web.upload.SHORT", 0.0)


def kept(server: viser.ViserServer) -> list[int]:
    """How much there is of each file that is on its way."""
    states = [client.gui._current_file_upload_states for client in server.get_clients().values()]
    return [state["transferred_bytes"] for of_tab in states for state in of_tab.values()]


@pytest.fixture
def came(monkeypatch) -> dict[str, bytes]:
    """Every file that has arrived, by its name."""
    files: dict[str, bytes] = {}

    def note(path: str, content: bytes) -> Upload:
        files[path] = content
        return upload_at(path, content)

    monkeypatch.setattr("app.page.files.files_controller.upload_at", note)
    return files


def opened(tab: WireTab, count: int) -> None:
    """So many files were all of a choice."""
    tab.tell("sent", button=tab.find(BUTTON), count=count, whole=True, days=[])


def can_stop(tab: WireTab) -> bool:
    return not tab.props[tab.find("Stop", "GuiButtonMessage")]["disabled"]


def stopped(tab: WireTab) -> None:
    until(lambda: can_stop(tab), "Stop")
    tab.press("Stop")


def test_two_files_that_come_at_a_time_are_a_map_to_the_last_byte(server, tab, small_case, came):
    files = map_to_bytes(small_case.ref, "mine")
    yaml = WireFile(tab, BUTTON, "mine.yaml", files["mine.yaml"])
    image = WireFile(tab, BUTTON, "mine.pgm", files["mine.pgm"])
    for file in (yaml, image):
        assert file.hear() == {"least": LEAST, "most": MOST, "ahead": 4 * MOST}
    for file in (image, yaml):
        while file.sent < len(file.content):
            file.part(LEAST)
        assert file.over() == "arrived"
    opened(tab, 2)
    until(lambda: tab.words["case"] == "your files", "the map")
    assert tab.mood == "idle"
    assert came == files
    assert kept(server) == []


@pytest.mark.parametrize("size", [0, 1, LEAST, LEAST + 1, MOST + 1])
def test_a_file_of_any_length_arrives_as_it_was_and_refused_it_is_kept_nowhere(server, tab, size, came):
    content = bytes(k % 251 for k in range(size))
    file = WireFile(tab, BUTTON, "seen.yaml", content)
    step = LEAST + 7  # of any length between the two bounds
    while file.sent < size:
        file.part(step)
        step = min(2 * step, MOST)
    assert file.over() == "arrived"
    opened(tab, 1)
    until(lambda: tab.mood == "failed", "the words on what is wrong with it")
    assert came == {"seen.yaml": content}
    (client,) = server.get_clients().values()
    button = client.gui._gui_input_handle_from_uuid[tab.find(BUTTON)]
    assert button.value.content == b""


def test_stop_leaves_a_file_with_nothing_kept_and_the_next_one_arrives(server, tab, small_case, at_once):
    before = dict(tab.words)
    files = [WireFile(tab, BUTTON, "long.pgm", LONG) for _ in range(2)]
    for file in files:
        file.part(MOST)
    assert kept(server) == [MOST, MOST]
    stopped(tab)
    assert [file.over() for file in files] == ["left", "left"]
    assert kept(server) == []
    until(lambda: not can_stop(tab), "nothing to stop")
    assert tab.words == before
    content = map_to_bytes(small_case.ref, "mine")["mine.pgm"]
    again = WireFile(tab, BUTTON, "mine.pgm", content)
    again.part(len(content))
    assert again.over() == "arrived"
    opened(tab, 1)
    until(lambda: tab.words["case"] == "your files", "the next file")


def test_stop_leaves_the_run_that_is_told_of_before_the_file_that_comes_meanwhile(server, tab, at_once):
    file = WireFile(tab, BUTTON, "long.pgm", LONG)
    file.part(MOST)
    tab.choose("Slow")
    tab.press("Merge")
    until(lambda: tab.mood == "running", "the run")
    stopped(tab)
    until(lambda: tab.mood == "stopped", "the run to be left")
    assert kept(server) == [MOST]
    file.part(MOST)
    stopped(tab)
    assert file.over() == "left"
    assert kept(server) == []
    assert tab.mood == "stopped"


def test_a_file_that_takes_but_a_moment_cannot_be_stopped_and_moves_no_button(server, tab):
    told: list[bool] = []
    (number,) = server.get_clients()
    server.uploads.connect(number, Recipient(told.append, lambda error: None))
    file = WireFile(tab, BUTTON, "short.pgm", b"P5")
    file.part(2)
    assert file.over() == "arrived"
    until(lambda: told, "its end")
    assert not any(told)


def gone(tab: WireTab, file: WireFile) -> str:
    tab.socket.close()
    return file.over()


def broken_off(tab: WireTab, file: WireFile) -> str:
    file.socket.close()
    return file.over()


def unsent(tab: WireTab, file: WireFile) -> str:
    tab.tell("unsend")
    return file.over()


ENDS: dict[str, tuple[Callable[[WireTab, WireFile], str], str]] = {
    "its tab goes": (gone, "lost"),
    "its own connection ends": (broken_off, ""),
    "it is left in the line that tells of it": (unsent, "left"),
}


@pytest.mark.parametrize(("end", "word"), ENDS.values(), ids=ENDS)
def test_nothing_of_a_file_stays_when(server, tab, end, word):
    file = WireFile(tab, BUTTON, "long.pgm", LONG)
    file.part(MOST)
    assert end(tab, file) == word
    until(lambda: kept(server) == [] and not server.uploads._coming, "its bytes to be free")


def test_a_file_that_is_too_large_is_refused_with_a_reason_before_any_of_it_is_sent(server, tab):
    file = WireFile(tab, BUTTON, "huge.pgm", b"", size=MAX_UPLOAD + 1)
    assert file.over() == "refused"
    until(lambda: "huge.pgm: has 210 MB, and 209 MB is the most" in tab.state, "the reason")
    assert tab.mood == "failed"
    assert tab.notices("This cannot be used") == 1


def test_a_file_too_many_is_refused_with_a_reason_while_the_others_are_on_their_way(server, tab):
    many = [WireFile(tab, BUTTON, "map.pgm", b"", size=MAX_UPLOAD) for _ in range(2)]
    assert all("most" in file.hear() for file in many)
    assert 2 * MAX_UPLOAD == MAX_UPLOADS
    assert WireFile(tab, BUTTON, "one more.pgm", b"", size=1).over() == "refused"
    until(lambda: "one more.pgm: too much is on its way already" in tab.state, "the reason")


FIRST = {
    "no JSON": "hello",
    "no mapping": "[]",
    "a field too many": json.dumps({"button": "a", "name": "b", "kind": "c", "size": 1, "more": 1}),
    "a name of a thousand letters": json.dumps({"button": "a", "name": "b" * 1000, "kind": "", "size": 1}),
    "less than nothing": json.dumps({"button": "a", "name": "b", "kind": "c", "size": -1}),
    "bytes": b"\xff\x00",
}


@pytest.mark.parametrize("word", FIRST.values(), ids=FIRST)
def test_what_does_not_begin_as_a_file_ends_its_own_connection(server, tab, word):
    garbage = server.gate.dropped["upload garbage"]
    at = f"ws://127.0.0.1:{tab.port}/upload"
    with connect(at, origin=f"http://127.0.0.1:{tab.port}", compression=None) as socket:
        socket.send(word)
        until(lambda: socket.state.name == "CLOSED", "the end")
        assert socket.close_code == 1007
    assert server.gate.dropped["upload garbage"] == garbage + 1
    tab.press("Merge")  # and no other
    until(lambda: tab.mood == "running", "the run")


PARTS: dict[str, str | bytes] = {
    "too short": bytes(LEAST - 1),
    "too long": bytes(MOST + 1),
    "empty": b"",
    "a text": "x" * LEAST,
}


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS)
def test_a_part_that_the_page_would_not_send_ends_the_file(server, tab, part):
    file = WireFile(tab, BUTTON, "long.pgm", LONG)
    file.part(MOST)
    file.socket.send(part)
    assert file.over() == ""
    until(lambda: kept(server) == [], "its bytes to be free")


def test_a_button_that_there_is_not_takes_no_file(server, tab):
    assert WireFile(tab, BUTTON, "map.pgm", b"P5", button="nobody's").over() == "refused"
    assert WireFile(tab, "Merge", "map.pgm", b"P5").over() == "refused"
    assert kept(server) == []


def test_who_announces_a_file_and_sends_nothing_is_given_up(server, tab, monkeypatch):
    monkeypatch.setattr("app.web.upload.IDLE_LIMIT", 0.2)
    file = WireFile(tab, BUTTON, "long.pgm", LONG)
    assert file.over() == ""
    assert server.gate.dropped["upload silent"]
    until(lambda: kept(server) == [], "its place to be free")


def test_nobody_sends_a_file_but_the_page_itself():
    token = "a-token-that-nobody-guesses"
    server = guarded_server("127.0.0.1", 0, Access(token=token), 4)
    try:
        at, own = f"ws://127.0.0.1:{server.get_port()}/upload", f"http://127.0.0.1:{server.get_port()}"
        for origin, status in (("http://evil.example", 403), (None, 403), (own, 401)):
            with pytest.raises(InvalidStatus) as refused:
                connect(at, origin=origin)
            assert refused.value.response.status_code == status
        cookie = {"Cookie": f"{Access(token=token).cookie}={token}"}
        let_in = [connect(at, origin=own, additional_headers=cookie) for _ in range(4)]
        with pytest.raises(InvalidStatus) as refused:  # and so many at a time
            connect(at, origin=own, additional_headers=cookie)
        assert refused.value.response.status_code == 503
        for socket in let_in:
            socket.close()
    finally:
        server.stop()
