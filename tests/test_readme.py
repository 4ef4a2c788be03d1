import doctest
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_the_examples_of_the_readme_do_what_they_say(monkeypatch):
    monkeypatch.chdir(ROOT)
    failed, tried = doctest.testfile(str(ROOT / "README.md"), module_relative=False)
    assert failed == 0
    assert tried >= 6


def test_every_picture_of_the_readme_is_there():
    pictures = [part.split(")")[0] for part in (ROOT / "README.md").read_text("utf-8").split("](")[1:]]
    local = [name for name in pictures if not name.startswith("http")]
    assert local
    assert all((ROOT / name).is_file() for name in local)
