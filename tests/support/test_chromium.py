"""How the tests come by a browser: the environment, the PATH, Playwright's own, the package manager."""

import os
import stat
import sys

import chromium
import pytest

VERSION = "#!/bin/sh\necho Chromium 123.0\n"
STUB = "#!/bin/sh\necho 'this command needs the chromium snap' >&2\nexit 1\n"


def program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


@pytest.fixture
def bare(tmp_path, monkeypatch):
    """A machine without any browser; its PATH is the folder that is returned."""
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    for name in ("CHROMIUM", "PLAYWRIGHT_BROWSERS_PATH"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path / "bin"


def test_the_one_named_in_the_environment_comes_first(bare, tmp_path, monkeypatch):
    program(bare / "chromium", VERSION)
    mine = program(tmp_path / "mine", VERSION)
    monkeypatch.setenv("CHROMIUM", mine)
    assert chromium.find_chromium() == mine


def test_a_wrong_name_in_the_environment_is_said_not_passed_over(bare, monkeypatch):
    program(bare / "chromium", VERSION)
    monkeypatch.setenv("CHROMIUM", "/no/such/browser")
    with pytest.raises(chromium.NoChromium, match="/no/such/browser"):
        chromium.find_chromium()


def test_a_stub_that_does_not_start_is_passed_over(bare):
    program(bare / "chromium", STUB)
    chrome = program(bare / "google-chrome", VERSION)
    assert chromium.find_chromium() == chrome


def test_the_browser_that_playwright_has_downloaded_is_found(bare, tmp_path):
    cache = tmp_path / "home" / ".cache" / "ms-playwright"
    managed = program(cache / "chromium-1200" / "chrome-linux" / "chrome", VERSION)
    assert chromium.find_chromium() == managed


def test_where_there_is_none_the_message_says_what_to_install(bare):
    with pytest.raises(chromium.NoChromium, match="apt install chromium"):
        chromium.find_chromium()


def test_who_may_install_gets_one_from_the_package_manager(bare, monkeypatch, capfd):
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    made = program(bare.parent / "made", VERSION)
    program(bare / "env", '#!/bin/sh\nshift\nexec "$@"\n')
    program(bare / "apt-get", f'#!/bin/sh\n[ "$1" = update ] || /bin/cp {made} {bare}/chromium\n')
    assert chromium.main() == 0
    assert capfd.readouterr().out == f"{bare}/chromium\n"


def test_who_may_not_install_is_told_what_is_missing(bare, monkeypatch, capfd):
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    program(bare / "apt-get", f"#!/bin/sh\n: > {bare}/called\n")
    assert chromium.main() == 1
    assert "apt install chromium" in capfd.readouterr().err
    assert not (bare / "called").exists()
