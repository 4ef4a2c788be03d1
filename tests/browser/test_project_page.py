"""A project in a real Chromium: saved in one tab, opened in another."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from driver import PATIENCE, READY, Tab, settle
from repository import ROOT

pytestmark = pytest.mark.browser


def entries(tab) -> list[str]:
    """The lines of the history, newest first."""
    return tab.page.locator(".mm-entry").all_inner_texts()


def test_a_project_is_saved_and_another_tab_goes_on_with_it(open_tab, tmp_path):
    tab = open_tab()
    tab.choose("Sample", "apartment_r2_r1")
    settle(lambda: "apartment" in tab.page.locator(".mm-title").inner_text(), "the sample")
    tab.press("Instant")
    tab.press("Merge")
    tab.wait_for("accepted")
    said = tab.state
    with tab.page.expect_download() as download:
        tab.press("Save project")
    assert download.value.suggested_filename == "apartment_r2_r1.mapmeld"
    path = tmp_path / "apartment.mapmeld"
    download.value.save_as(path)

    other = open_tab()
    other.press("Instant")
    other.open_files(path)
    other.wait_for("accepted")
    assert other.state == said
    other.unfold("History")
    assert entries(other) == ["merge", "load apartment_r2_r1", "load office_r2_r1"]
    other.page.get_by_role("button", name="Undo").click()
    settle(lambda: other.state.startswith("Ready"), "the pair before it was merged")


@contextmanager
def served(folder: Path, port: int) -> Iterator[str]:
    """The address of a server that keeps work in that folder, and is killed in the end."""
    words = ["serve", "--no-browser", "--port", str(port), "--keep", str(folder)]
    command = [sys.executable, "-m", "app", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as server:
        try:
            assert server.stdout is not None
            yield next(line for line in server.stdout if line.startswith("mapmeld is at ")).split()[3]
        finally:
            server.kill()


def test_a_reload_finds_everything_after_the_server_was_killed_and_started_again(browser, tmp_path):
    with served(tmp_path, 0) as address:
        tab = Tab(browser, address, (1000, 700))
        tab.press("Instant")
        tab.press("Merge")
        tab.wait_for("accepted")
        said = tab.state
        tab.unfold("History")
        done = entries(tab)
    port = int(address.rstrip("/").rsplit(":", 1)[1])
    with served(tmp_path, port):
        tab.page.reload()
        tab.page.wait_for_function(READY, timeout=1000 * PATIENCE)
        tab.wait_for("accepted")
        assert tab.state == said
        tab.unfold("History")
        assert entries(tab) == done == ["merge", "load office_r2_r1"]
        tab.close()
