"""Many tabs at a time, tabs that hang, tabs that are gone, and a server that is told to end."""

from __future__ import annotations

import gc
import io
import os
import signal
import socket
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread
from time import sleep
from types import SimpleNamespace
from typing import Any

import pytest
import viser
from repository import ROOT
from wire import PATIENCE, WireTab, until

import app.page.application
from algorithms.common.errors import TooLargeError
from algorithms.files.case_folder import Case, read_case
from algorithms.methods.registry import merge
from app.jobs.fair_semaphore import FairSemaphore
from app.model.merge_job import MergeJob
from app.page.application import make_server
from app.page.page import Page
from app.page.page_state import PageState
from app.web.cell_quota import CellQuota
from app.web.download import Downloads


@pytest.fixture
def server(small_case: Case) -> Iterator[viser.ViserServer]:
    server = make_server(port=0, initial=small_case)
    yield server
    server.stop()


def merged(tab: WireTab) -> str:
    until(lambda: tab.mood in ("accepted", "refused", "failed"), "the merge")
    return tab.state


def test_ten_tabs_merge_at_once_and_each_comes_out_as_alone(server):
    tabs = [WireTab(server.get_port()) for _ in range(10)]
    tabs[0].choose("Instant")
    tabs[0].press("Merge")
    alone = merged(tabs[0])
    assert tabs[0].mood == "accepted"
    for tab in tabs:
        tab.choose("Instant")
        tab.words["mood"] = ""  # not that of the merge alone
        tab.press("Merge")
    idle = WireTab(server.get_port())  # a further tab is served meanwhile
    idle.write("I_aug intensity", 500.0, "Slider")
    until(lambda: "up to date" in idle.state, "an answer to the slider")
    assert {merged(tab) for tab in tabs} == {alone}
    assert set(server.gate.dropped) == set()
    for tab in (*tabs, idle):
        tab.close()
    until(lambda: not server.get_clients(), "all sessions to end")


def test_merge_pressed_between_two_loads_gives_no_pair_the_answer_of_another(server, monkeypatch):
    came, goes_on = Event(), Event()

    def slowly(folder: Path) -> Case:
        if folder.name == "apartment_r2_r1":
            came.set()
            assert goes_on.wait(PATIENCE)
        return read_case(folder)

    make = PageState.job

    def late(page: PageState, **how: Any) -> MergeJob | None:
        job = make(page, **how)
        sleep(0.5)  # in which others get their turn where they can
        return job

    monkeypatch.setattr("app.page.files.files_controller.read_case", slowly)
    monkeypatch.setattr(PageState, "job", late)
    tab = WireTab(server.get_port())
    tab.choose("Instant")
    tab.write("Sample", "office_r2_r1")
    until(lambda: tab.words["case"] == "office_r2_r1", "the first pair")
    tab.write("Sample", "apartment_r2_r1")
    assert came.wait(PATIENCE)
    tab.press("Merge")
    sleep(0.2)  # until it waits for its turn
    tab.write("Sample", "office_r2_r1")
    sleep(0.2)
    goes_on.set()
    until(lambda: tab.words["case"] == "apartment_r2_r1", "the second pair")
    until(lambda: tab.words["case"] == "office_r2_r1", "the first pair again")
    sleep(1.0)  # in which a run of the second would come to its end
    assert tab.state == "Ready. Press Merge."
    tab.press("Merge")
    office = read_case(ROOT / "sample_maps" / "office_r2_r1")
    assert merged(tab) == merge(office.ref, office.mov, office.observations).verdict.reason
    tab.close()


def test_a_tab_that_stops_reading_is_given_up_and_hinders_no_other(server, monkeypatch):
    monkeypatch.setattr("app.web.security.message_filter.PATIENCE", 1.0)
    stuck, tab = WireTab(server.get_port()), WireTab(server.get_port())
    (client,) = [client for number, client in server.get_clients().items() if number == 0]
    stuck.stop_reading()

    def flood() -> None:  # as a download would be that nobody takes
        while not server.gate.dropped["does not read"]:
            client.send_file_download("x", os.urandom(2_000_000), save_immediately=True)
            sleep(0.05)  # one frame for each

    Thread(target=flood, daemon=True).start()
    tab.choose("Instant")
    tab.press("Merge")
    assert merged(tab)
    assert tab.mood == "accepted"
    until(lambda: server.gate.dropped["does not read"], "the hanging tab to be given up")
    until(lambda: len(server.get_clients()) == 1, "its session to end")
    tab.close()


def test_a_browser_that_is_killed_frees_its_session(server):
    tab = WireTab(server.get_port())
    tab.press("Merge")
    assert len(server.get_clients()) == 1
    tab.socket.socket.shutdown(socket.SHUT_RDWR)  # no goodbye
    until(lambda: not server.get_clients(), "the session to end")


def test_who_says_hello_again_and_again_gets_nothing_more_and_leaves_nothing_behind(server):
    def pages() -> int:
        gc.collect()
        return sum(type(thing) is Page for thing in gc.get_objects())

    before = pages()
    tab = WireTab(server.get_port())
    key = tab.words["key"]
    for key_then, again in [("", False), (key, True), (key, False), ("", True)]:
        tab.tell("hello", key=key_then, again=again, mode="")
    tab.choose("Instant")
    tab.press("Merge")
    assert merged(tab)
    assert tab.mood == "accepted"
    assert tab.words["key"] == key
    tab.close()
    until(lambda: not server.get_clients(), "the session to end")
    came_back = WireTab(server.get_port(), key=key)  # what it left is kept for it alone, once
    until(lambda: came_back.mood == "accepted", "what it left")
    came_back.close()
    until(lambda: pages() <= before, "its page to be let go of")


def test_what_was_stopped_is_not_begun_again_by_a_reload(server):
    tab = WireTab(server.get_port())
    tab.choose("Slow")
    tab.press("Merge")
    until(lambda: tab.mood == "running", "the run")
    tab.press("Stop")
    until(lambda: tab.mood == "stopped", "its end")
    tab.close()
    until(lambda: not server.get_clients(), "the session to end")
    came_back = WireTab(server.get_port(), key=tab.words["key"])
    until(lambda: came_back.state == "Ready. Press Merge.", "the maps")
    came_back.choose("Instant")
    came_back.press("Merge")
    assert merged(came_back)
    came_back.close()


def test_a_tab_too_many_is_told_so_and_has_no_session(small_case, monkeypatch):
    monkeypatch.setattr(app.page.application, "MOST_TABS", 1)
    server = make_server(port=0, initial=small_case)
    try:
        first = WireTab(server.get_port())
        with pytest.raises(AssertionError, match="the channel"):
            WireTab(server.get_port(), patience=3.0)
        said = [handle.content for client in server.get_clients().values() for handle in words_of(client)]
        assert any("1 tabs are open already" in words for words in said)
        first.close()
    finally:
        server.stop()


def words_of(client: viser.ClientHandle) -> list[viser.GuiMarkdownHandle]:
    children = client.gui._container_handle_from_uuid["root"]._children.values()
    return [child for child in children if isinstance(child, viser.GuiMarkdownHandle)]


def test_a_server_that_is_told_to_end_finishes_the_files_that_it_is_making():
    command = [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as page:
        try:
            said = next(line for line in page.stdout if line.startswith("mapmeld is at "))
            tab = WireTab(int(said.split()[3].rstrip("/").rpartition(":")[2]))
            tab.choose("Instant")
            tab.press("Merge")
            merged(tab)
            tab.press("Download everything")
            until(lambda: tab.state.startswith("Making the files"), "the work to begin")
            page.send_signal(signal.SIGTERM)
            assert page.wait(timeout=PATIENCE) == 0
            (archive,) = tab.files.values()
            with zipfile.ZipFile(io.BytesIO(archive)) as files:
                assert files.testzip() is None
                assert "merged.yaml" in files.namelist()
        finally:
            if page.poll() is None:
                page.kill()


# --- the parts --------------------------------------------------------------------------------------


def test_turns_are_taken_in_their_order_and_so_many_at_a_time():
    turns, order, go = FairSemaphore(2), [], Event()

    def work(number: int) -> None:
        with turns.take(lambda: True, lambda before: None) as mine:
            order.append(number)
            assert mine
            assert go.wait(PATIENCE)

    threads = []
    for number in range(5):
        threads.append(Thread(target=work, args=(number,)))
        threads[-1].start()
        until(lambda number=number: len(order) + len(turns._queue) == number + 1, "it to stand in the queue")
    assert order == [0, 1]
    go.set()
    for thread in threads:
        thread.join(PATIENCE)
    assert sorted(order[2:]) == order[2:]
    assert turns._free == 2


def test_who_wants_no_turn_any_more_leaves_the_queue_and_is_told_how_long_it_was(monkeypatch):
    monkeypatch.setattr("app.jobs.fair_semaphore.PATIENCE", 0.0)
    turns, before, wanted = FairSemaphore(1), [], [True]

    def give_up(number: int) -> None:
        before.append(number)
        wanted[0] = False

    with turns.take(lambda: True, before.append):
        with turns.take(lambda: wanted[0], give_up) as mine:
            assert not mine
        assert not turns._queue
    assert before == [0]
    with turns.take(lambda: True, before.append) as mine:
        assert mine
    assert turns._free == 1


def test_what_fails_in_its_turn_gives_the_turn_back():
    turns = FairSemaphore(1)
    with pytest.raises(MemoryError), turns.take(lambda: True, lambda before: None):
        raise MemoryError
    with turns.take(lambda: True, lambda before: None) as mine:
        assert mine


def test_one_tab_may_hold_all_there_is_and_a_second_one_what_is_left():
    room = []
    quota = CellQuota(100, make_room=lambda: room.append(1))
    with pytest.raises(TooLargeError, match="a page holds"):
        quota.claim("a", 101)  # two maps never have more, but a fleet of many may
    quota.claim("a", 100)
    with pytest.raises(TooLargeError, match="close one of them, or make the maps coarser"):
        quota.claim("b", 1)
    quota.claim("a", 60)
    quota.claim("b", 40)
    assert room
    with pytest.raises(TooLargeError):
        quota.claim("b", 41)
    quota.claim("a", 60)  # what is held already does not count against itself
    quota.release("a")
    quota.claim("b", 100)


def test_a_server_waits_for_what_is_being_made_and_begins_nothing_more():
    takeaway, begun, go = Downloads(), Event(), Event()
    buffer = SimpleNamespace(message_from_id={1: "part"}, done=False)
    client = SimpleNamespace(
        _websock_connection=SimpleNamespace(get_message_buffer=lambda: buffer),
        send_file_download=lambda *_, **__: None,
    )

    def make() -> None:
        with takeaway.making() as mine:
            assert mine
            begun.set()
            assert go.wait(PATIENCE)
            takeaway.send(client, "a", b"b")

    Thread(target=make).start()
    assert begun.wait(PATIENCE)
    ended = Event()
    Thread(target=lambda: (takeaway.finish(PATIENCE), ended.set())).start()
    until(lambda: takeaway._ending, "the end to be asked for")
    with takeaway.making() as mine:
        assert not mine
    assert not ended.is_set()
    go.set()
    assert not ended.wait(0.2)  # made, and still on its way
    buffer.message_from_id.clear()
    assert ended.wait(PATIENCE)


def test_who_never_ends_is_not_waited_for_for_ever():
    takeaway = Downloads()
    with takeaway.making() as begun:
        takeaway.finish(0.05)
        assert begun
