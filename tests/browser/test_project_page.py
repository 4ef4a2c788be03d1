"""A project in a real Chromium: saved in one tab, opened in another."""

from __future__ import annotations

import pytest
from driver import settle

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
