"""``mapmeld lesson`` writes one page, or says in a line why it does not."""

from __future__ import annotations

import pytest
from commandline import usage_error
from rooms import write_case

from app.cli.main import main

TEXT = "---\ntitle: Mine\npicture: dual\nequations: [dual]\n---\nOf {walls1} cells.\n"


@pytest.fixture
def texts(tmp_path):
    folder = tmp_path / "texts"
    folder.mkdir()
    (folder / "01-mine.md").write_text(TEXT, encoding="utf-8")
    return folder


def test_it_writes_a_teachers_own_steps_on_maps_of_their_own(texts, tmp_path, small_case, capsys):
    write_case(tmp_path, small_case.ref, small_case.mov, small_case.observations[0])
    maps, out = [str(tmp_path / f"map{k}.yaml") for k in (1, 2)], tmp_path / "handout.html"
    seen = str(tmp_path / "observation.yaml")
    assert main(["lesson", *maps, "--observation", seen, "--texts", str(texts), "--out", str(out)]) == 0
    page = out.read_text(encoding="utf-8")
    assert "1 steps" in capsys.readouterr().out
    assert f"{int(small_case.ref.occupied.sum()):,} cells" in page
    assert main(["lesson", *maps, "--texts", str(texts), "--out", str(tmp_path / "other.html")]) == 2
    assert "give --observation" in capsys.readouterr().err
    assert not (tmp_path / "other.html").exists()


def test_a_text_that_cannot_be_read_is_named_before_anything_is_merged(texts, tmp_path, capsys):
    (texts / "01-mine.md").write_text(TEXT.replace("walls1", "walls9"), encoding="utf-8")
    assert main(["lesson", "--texts", str(texts), "--out", str(tmp_path / "handout.html")]) == 2
    assert "01-mine.md" in capsys.readouterr().err


def test_a_name_that_no_browser_opens_is_refused(capsys):
    assert usage_error("lesson", "--out", "handout.pdf") == 2
    assert ".html" in capsys.readouterr().err
