"""Find a Chromium for the tests that drive the page; as a script, install one where none is there.

``python tests/support/chromium.py`` prints the path. CHROMIUM=/path/to/it in the environment comes first.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
MAC_APPS = ("Chromium.app/Contents/MacOS/Chromium", "Google Chrome.app/Contents/MacOS/Google Chrome")
MANAGED = (  # where Playwright keeps the browsers it has downloaded
    "chromium-*/chrome-linux*/chrome",
    "chromium-*/chrome-mac*/*.app/Contents/MacOS/*",
    "chromium_headless_shell-*/chrome-*/headless_shell",
    "chromium_headless_shell-*/chrome-*/chrome-headless-shell",
)
INSTALLERS: dict[str, tuple[tuple[str, ...], ...]] = {
    "apt-get": (
        ("apt-get", "update", "-q"),
        ("apt-get", "install", "-q", "-y", "--no-install-recommends", "chromium"),
    ),
    "dnf": (("dnf", "install", "-y", "chromium"),),
    "pacman": (("pacman", "-Sy", "--noconfirm", "chromium"),),
    "zypper": (("zypper", "--non-interactive", "install", "chromium"),),
    "apk": (("apk", "add", "chromium"),),
}
REMEDY = """\
The tests need a Chromium or a Chrome, and there is none that starts. Install one, then run them again:
  Debian        apt install chromium
  Fedora        dnf install chromium
  Arch          pacman -S chromium
  macOS         brew install --cask google-chrome
  anywhere      .venv/bin/playwright install --with-deps chromium
or say where it is: CHROMIUM=/path/to/chromium make test"""


class NoChromium(Exception):  # noqa: N818 - what it says is that there is none
    """There is no Chromium here that starts; the message says what to install."""


def find_chromium() -> str:
    """Path of a Chromium or Chrome that starts; raises NoChromium."""
    named = os.environ.get("CHROMIUM")
    if named:
        path = shutil.which(named)
        if path is None or not starts(path):
            raise NoChromium(f"CHROMIUM is {named}, and nothing there starts; correct it or leave it out")
        return path
    for path in candidates():
        if starts(path):
            return path
    raise NoChromium(REMEDY)


def candidates() -> Iterator[str]:
    """Paths where a Chromium may be, likeliest first."""
    for name in NAMES:
        path = shutil.which(name)
        if path:
            yield path
    if sys.platform == "darwin":
        for folder in (Path("/Applications"), Path.home() / "Applications"):
            yield from (str(folder / app) for app in MAC_APPS)
    caches = Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")
    root = Path(os.environ.get("PLAYWRIGHT_BROWSERS_PATH") or caches / "ms-playwright")
    for pattern in MANAGED:
        yield from (str(path) for path in sorted(root.glob(pattern), reverse=True))


def starts(path: str) -> bool:
    """Whether it tells its version: Ubuntu's package holds none, and only asks for another one."""
    try:
        told = subprocess.run([path, "--version"], capture_output=True, text=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return told.returncode == 0 and any(letter.isdigit() for letter in told.stdout)


def install() -> None:
    """Install a Chromium, if this user may; its words go to stderr."""
    may = _root()
    manager = next((name for name in INSTALLERS if shutil.which(name)), None)
    if may is None or manager is None:
        return
    print(f"no Chromium is here: installing one with {manager}", file=sys.stderr)
    for command in INSTALLERS[manager]:
        _call([*may, "env", "DEBIAN_FRONTEND=noninteractive", *command])
    if any(starts(path) for path in candidates()):
        return
    print(f"{manager} has none that starts: trying Playwright's", file=sys.stderr)
    _call([sys.executable, "-m", "playwright", "install", "--with-deps", "chromium"])


def _root() -> list[str] | None:
    """What to put before a command that only root may run; None where this user may not."""
    if os.geteuid() == 0:
        return []
    may = shutil.which("sudo") and _call(["sudo", "-n", "true"], quiet=True)
    return ["sudo", "-n"] if may else None


def _call(command: list[str], quiet: bool = False) -> bool:
    try:
        output = subprocess.DEVNULL if quiet else sys.stderr
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, timeout=420, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def main() -> int:
    """Print the path of a Chromium, installed now if need be; 1 with a remedy where there is none."""
    try:
        try:
            path = find_chromium()
        except NoChromium:
            if os.environ.get("CHROMIUM"):
                raise
            install()
            path = find_chromium()
    except NoChromium as error:
        print(error, file=sys.stderr)
        return 1
    print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
