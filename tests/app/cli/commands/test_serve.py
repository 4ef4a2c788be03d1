"""``mapmeld serve``: how the page is started, and how it ends."""

import os
import signal
import subprocess
import sys
import time
import urllib.request
from urllib.error import HTTPError

import pytest
from commandline import ROOT, as_in_a_terminal, usage_error
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from algorithms.common.errors import SettingError
from app.cli.main import main
from app.cli.open_browser import browser
from app.live.watch.robot_network import RobotNetwork


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_serve_answers_on_this_machine_alone_until_it_is_told_to_end(end):
    command = [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, cwd=ROOT, preexec_fn=as_in_a_terminal
    ) as page:
        try:
            said = next(line for line in page.stdout if line.startswith("mapmeld is at "))
            url = said.split()[3]
            assert url.startswith("http://127.0.0.1:")
            assert "(for this machine alone;" in said
            with urllib.request.urlopen(url, timeout=20) as answer:
                assert answer.status == 200
            time.sleep(0.2)
            page.send_signal(end)
            assert page.wait(timeout=60) == 0
        finally:
            if page.poll() is None:
                page.kill()


def test_a_tab_of_another_version_is_told_to_reload_and_stops_nobody_where_no_one_reads_what_is_printed():
    command = [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT
    ) as page:
        try:
            url = page.stdout.readline().split()[3]
            page.stdout.close()  # as of ``mapmeld serve | head -1``
            origin = url.rstrip("/")
            at = origin.replace("http", "ws")
            for older in ("viser-v1.1.0", f"viser-v{'x' * 7000}"):
                with connect(at, subprotocols=[older], origin=origin, compression=None) as socket:
                    with pytest.raises(ConnectionClosed):
                        socket.recv(timeout=20)
                    assert (socket.close_code, socket.close_reason) == (
                        1002,
                        "another version is served here: reload the page",
                    )
            with urllib.request.urlopen(url, timeout=20) as answer:
                assert answer.status == 200
            page.send_signal(signal.SIGTERM)
            assert page.wait(timeout=60) in (0, 130)
            assert page.stderr.read() == ""
        finally:
            if page.poll() is None:
                page.kill()


@pytest.mark.parametrize("flag", ["--proxy-host", "--behind"])
def test_a_page_answers_to_the_name_of_its_proxy_and_an_old_flag_tells_its_new_name_once(flag):
    words = [flag, "robots.example", f"{flag}=maps.example"]
    command = [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0", *words]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT
    ) as page:
        try:
            said = page.stdout.readline()
            assert "whom the proxy at robots.example or maps.example lets through, with the token" in said
            url = said.split()[3]
            for name in ("robots.example", "maps.example"):
                asked = urllib.request.Request(url, headers={"Host": name})
                with urllib.request.urlopen(asked, timeout=20) as answer:
                    assert answer.status == 200
            with pytest.raises(HTTPError, match="421"):
                urllib.request.urlopen(
                    urllib.request.Request(url, headers={"Host": "evil.example"}), timeout=20
                )
            page.send_signal(signal.SIGTERM)
            assert page.wait(timeout=60) in (0, 130)
            told = [line for line in page.stderr.read().splitlines() if "--" in line]
            old = ["mapmeld serve: --behind is now --proxy-host"]
            assert told == (old if flag == "--behind" else [])
        finally:
            if page.poll() is None:
                page.kill()


def test_the_old_name_of_a_flag_is_in_no_help_and_recommended_to_nobody(capsys):
    assert usage_error("serve", "--help") == 0
    said = capsys.readouterr().out
    assert "--proxy-host NAME" in said
    assert "--behind" not in said
    assert usage_error("serve", "--behnd", "robots.example") == 2
    assert "--behind" not in capsys.readouterr().err
    assert usage_error("serve", "--proxy-hots", "robots.example") == 2
    assert "did you mean --proxy-host?" in capsys.readouterr().err


def test_a_browser_is_opened_only_where_there_is_a_screen(monkeypatch):
    from app.cli.commands.serve import _has_display

    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not _has_display()
    monkeypatch.setitem(os.environ, "DISPLAY", ":0")
    assert _has_display()


def test_a_lesson_with_a_broken_text_is_refused_before_anyone_sees_it(tmp_path, capsys):
    assert main(["serve", "--no-browser", "--lesson", str(tmp_path)]) == 2
    assert "holds no text" in capsys.readouterr().err
    assert main(["serve", "--no-browser", "--lesson", str(tmp_path / "gone")]) == 2
    assert "gone: no such file; give a folder of Markdown files" in capsys.readouterr().err
    (tmp_path / "01-mine.md").write_text("---\ntitle: Mine\npicture: hoof\n---\nText.\n")
    assert main(["serve", "--no-browser", "--lesson", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "01-mine.md: picture is 'hoof'; known are " in said
    assert said.count("\n") == 1


def test_a_browser_that_is_opened_has_no_token_on_its_command_line(monkeypatch, tmp_path):
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    url = "http://127.0.0.1:8080/?token=a-token-that-nobody-guesses"
    with browser(url, secret=True):
        (told,) = opened
        (page,) = tmp_path.glob("*/open.html")
        assert told == page.as_uri()
        assert f'content="0;url={url}"' in page.read_text()
        if os.name == "posix":
            assert page.stat().st_mode & 0o077 == 0
            assert page.parent.stat().st_mode & 0o077 == 0
    assert list(tmp_path.iterdir()) == []
    with browser("http://127.0.0.1:8080/", secret=False):
        assert opened[1:] == ["http://127.0.0.1:8080/"]
        assert list(tmp_path.iterdir()) == []


def test_where_nothing_can_be_written_no_browser_is_opened_and_the_page_is_there(monkeypatch, tmp_path):
    monkeypatch.setattr("webbrowser.open", lambda _: pytest.fail("with the token"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "gone"))
    with browser("http://127.0.0.1:8080/?token=a-token-that-nobody-guesses", secret=True):
        assert list(tmp_path.iterdir()) == []


def test_without_live_no_network_is_told_of_and_none_is_opened(capsys):
    for words in (["--domain", "3"], ["--interface", "lo"], ["--rosbridge", "ws://there:9090"]):
        assert usage_error("serve", "--no-browser", *words) == 2
        assert "give --live, too" in capsys.readouterr().err


def test_with_live_the_page_is_told_where_robots_are_looked_for(monkeypatch):
    asked = []

    def make_server(*given):
        asked.append(given[-1])
        raise SettingError("that will do")

    monkeypatch.setattr("app.page.application.make_server", make_server)
    assert main(["serve", "--no-browser"]) == 2
    assert main(["serve", "--no-browser", "--live", "--domain", "3", "--interface", "lo"]) == 2
    assert asked == [None, RobotNetwork(3, "lo")]
