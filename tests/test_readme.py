"""What the README and the guides say is there, is there."""

import doctest
import re
from pathlib import Path

import pytest
from repository import ROOT
from screenshots import SHOWN

PAGES = [ROOT / "README.md", ROOT / "SECURITY.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", ["README.md", "docs/researcher.md"])
def test_the_examples_do_what_they_say(page, tmp_path, monkeypatch):
    (tmp_path / "sample_maps").symlink_to(ROOT / "sample_maps")  # what they write is not left here
    monkeypatch.chdir(tmp_path)
    failed, tried = doctest.testfile(str(ROOT / page), module_relative=False)
    assert failed == 0
    assert tried >= 6


def linked(page: Path) -> set[Path]:
    """Every file of the project that a page links to or shows."""
    targets = re.findall(r"\]\(([^)#]+)\)", page.read_text("utf-8"))
    return {(page.parent / name).resolve() for name in targets if not name.startswith("http")}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_everything_that_a_page_links_to_is_there(page):
    assert linked(page)
    assert [target for target in linked(page) if not target.is_file()] == []


def test_the_pictures_that_are_kept_are_those_that_are_shown():
    shown = {target for page in PAGES for target in linked(page) if target.suffix == ".png"}
    assert shown == set((ROOT / "static" / "screenshots").resolve().glob("*.png"))
    assert {picture.stem for picture in shown} == set(SHOWN)
