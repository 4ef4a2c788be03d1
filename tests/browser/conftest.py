"""A Chromium, a server with a sample, and tabs."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
import viser
from chromium import NoChromium, find_chromium
from driver import ARGUMENTS, ROUGHER, Tab
from playwright.sync_api import Browser, sync_playwright

from algorithms.files.case_folder import Case, read_case
from app.page.application import make_server
from app.system.data_paths import samples

SAMPLE = "office_r2_r1"
SIZE = (1000, 700)


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Fails where there is no Chromium: the page is half of the project, and skipped is untested."""
    try:
        path = find_chromium()
    except NoChromium as error:
        pytest.fail(str(error), pytrace=False)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=ARGUMENTS + ROUGHER)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def sample() -> Case:
    """The case every tab opens with."""
    return read_case(samples()[SAMPLE])


@pytest.fixture(scope="session")
def server(sample: Case) -> Iterator[viser.ViserServer]:
    """One server for all tests: tabs are told not to disturb each other.

    What an honest browser says is never dropped; but a control may be gone before a press arrives.
    """
    server = make_server(port=0, initial=sample)
    yield server
    server.stop()
    assert not set(server.gate.dropped) & {"garbage", "unasked", "malformed", "property", "slowed"}
    assert not [why for why in server.gate.dropped if why.startswith("upload")]


@pytest.fixture
def open_tab(browser: Browser, server: viser.ViserServer) -> Iterator[Callable[..., Tab]]:
    """Open a tab; a script error in it fails the test."""
    tabs: list[Tab] = []

    def open_one(
        size: tuple[int, int] = SIZE,
        at: viser.ViserServer = server,
        touch: bool = False,
        mode: str = "Research",
        smooth: bool = False,
    ) -> Tab:
        tabs.append(Tab(browser, f"http://127.0.0.1:{at.get_port()}/", size, touch, mode, smooth))
        return tabs[-1]

    yield open_one
    errors = [error for tab in tabs for error in tab.errors]
    for tab in tabs:
        tab.close()
    assert errors == []


@pytest.fixture
def tab(open_tab: Callable[..., Tab]) -> Tab:
    """A tab with the sample."""
    return open_tab()
