"""Load a server for some minutes and print what it took: ``make soak``, on a machine with nothing else to do.

It ends with 1 where a merge came out otherwise, a page was slow to answer, something leaked, there was too
little time to tell, or the log holds a trace.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from time import monotonic, sleep

from play import play
from process_tree import mergers, sizes
from repository import ROOT
from wire import WireTab, until

MOST_LEAKED = 60.0  # MB between the fifth wave and the last: what an allocator keeps back
MOST_THREADS = 10  # more than after the first wave: viser's threads, which are started as they are needed
PLAY = 45.0  # seconds of play at random
SAMPLE = "office_r2_r1"
LIVELY = 1.0  # seconds in which a page answers whatever else goes on


class Served:
    """``mapmeld serve`` in a process of its own, and what the system says of it."""

    def __init__(self, log: Path) -> None:
        self._log = log.open("w+")
        command = [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0", "--verbose"]
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=self._log, text=True, cwd=ROOT
        )
        assert self.process.stdout is not None
        said = next(line for line in self.process.stdout if line.startswith("mapmeld is at "))
        self.port = int(re.findall(r":(\d+)/", said)[0])

    def status(self, name: str) -> float:
        """A number of /proc/PID/status."""
        text = Path(f"/proc/{self.process.pid}/status").read_text()
        return float(re.findall(rf"^{name}:\s+(\d+)", text, flags=re.MULTILINE)[0])

    @property
    def workers(self) -> list[int]:
        """The processes in which merges run."""
        return mergers(self.process.pid)

    @property
    def megabytes(self) -> float:
        """Of all of them together."""
        return sum(sizes(self.process.pid).values())

    @property
    def open_files(self) -> int:
        return len(list(Path(f"/proc/{self.process.pid}/fd").iterdir()))

    def end(self) -> tuple[int, str]:
        """End it as a system does; exit status and log."""
        self.process.terminate()
        status = self.process.wait(60)
        self._log.seek(0)
        return status, self._log.read()


@contextmanager
def tabs(port: int, count: int) -> Iterator[list[WireTab]]:
    opened: list[WireTab] = []
    try:
        for _ in range(count):
            opened.append(WireTab(port))
        yield opened
    finally:
        for tab in opened:
            tab.close()


def merge(tab: WireTab) -> tuple[str, float]:
    """What came of it, and the seconds it took."""
    tab.words["mood"] = ""
    began = monotonic()
    tab.press("Merge")
    until(lambda: tab.mood in ("accepted", "refused", "failed"), "a merge")
    return tab.state, monotonic() - began


def answer(tab: WireTab, value: float) -> float:
    """Seconds until a slider is answered: the server has set it, and says what it is at."""
    tab.words["state"] = ""
    began = monotonic()
    tab.write("I_aug intensity", value, "Slider")
    until(lambda: tab.state, "an answer")
    return monotonic() - began


def turn(tab: WireTab, button: str) -> float:
    """Seconds until a button of the panel is seen to be pressed."""
    began = monotonic()
    tab.choose(button)
    until(lambda: button in tab.words["pressed"], "a pressed button")
    return monotonic() - began


def lively(what: str, answers: list[float], wrong: list[str]) -> str:
    """How soon it answered, in words; what was too slow is wrong."""
    if max(answers) > LIVELY:
        wrong.append(f"{what} took {max(answers):.2f} s to answer")
    return f"{what} answers in {median(answers):.2f} s, at worst {max(answers):.2f} s ({len(answers)} times)"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0, help="about how long (default: 10)")
    parser.add_argument("--tabs", type=int, default=50, help="tabs of a wave (default: 50)")
    parser.add_argument("--waves", type=int, default=20, help="how many there must be (default: 20)")
    parser.add_argument("--seed", type=int, default=0, help="of what is done at random (default: 0)")
    parser.add_argument("--log", type=Path, default=Path("out/soak.log"), help="the server's log")
    args = parser.parse_args()
    args.log.parent.mkdir(parents=True, exist_ok=True)
    server, wrong = Served(args.log), []
    end = monotonic() + 60 * args.minutes
    print(f"server at rest: {server.megabytes:.0f} MB, {server.open_files} files", flush=True)

    with tabs(server.port, 1) as (tab,):
        tab.choose("Instant")
        sleep(5)  # kernels are compiled at the start
        right, alone = merge(tab)
        print(f"a merge alone: {alone:.2f} s; one tab: {server.megabytes:.0f} MB", flush=True)

    with tabs(server.port, 11) as (idle, *busy):
        for tab in busy:
            tab.choose("Instant")
        took: list[float] = []

        def work(tab: WireTab) -> None:
            said, seconds = merge(tab)
            took.append(seconds)
            if said != right:
                wrong.append(f"a merge said: {said}")

        threads = [threading.Thread(target=work, args=(tab,)) for tab in busy]
        for thread in threads:
            thread.start()
        slider, button, value = [], [], 200.0
        while any(thread.is_alive() for thread in threads):
            value = 1000.0 - value
            slider.append(answer(idle, value))
            button.append(turn(busy[len(button) % 10], "Fast" if len(button) // 10 % 2 == 0 else "Instant"))
        for thread in threads:
            thread.join()
        print(
            f"10 tabs merging at once: {min(took):.1f} to {max(took):.1f} s each; "
            f"{lively('a slider of an 11th', slider, wrong)}; "
            f"{lively('a button of each of the ten', button, wrong)}; {server.megabytes:.0f} MB",
            flush=True,
        )

    with tabs(server.port, 1) as (tab,):
        tab.choose("Slow")
        tab.press("Merge")
        until(lambda: tab.mood == "running" and tab.words.get("progress"), "the merge to go on")
        for pid in server.workers:
            os.kill(pid, signal.SIGKILL)
        until(lambda: tab.mood == "failed", "a word of it")
        tab.choose("Instant")
        said, seconds = merge(tab)
        print(f"merges' processes killed: told; the next merge took {seconds:.2f} s", flush=True)
        if said != right:
            wrong.append(f"after a process was killed a merge said: {said}")

    with tabs(server.port, 1) as (tab,):
        print(f"at random, seed {args.seed}: ", end="", flush=True)
        deeds = play(tab, PLAY, args.seed)
        for words in ("This did not work", "The run ended"):
            if tab.notices(words):
                wrong.append(f"at random, with seed {args.seed}: {words!r}")
        tab.write("Sample", "apartment_r2_r1")
        until(lambda: tab.words["case"] == "apartment_r2_r1", "another pair")
        tab.write("Sample", SAMPLE)
        until(lambda: tab.words["case"] == SAMPLE, "the first pair")
        tab.choose("Instant")
        merge(tab)
        print(f"{len(deeds)} deeds of one tab; then it merges: {tab.mood}", flush=True)

    sizes: list[float] = []
    counts: list[int] = []
    waves = 0
    while monotonic() < end:
        with tabs(server.port, args.tabs) as opened:
            merge(opened[waves % len(opened)])
            at = server.megabytes
        until(lambda: server.open_files < 40, "the connections to end")
        sleep(4)  # what they held is given back
        waves += 1
        sizes.append(server.megabytes)
        counts.append(int(server.status("Threads")))
        if waves % 5 == 0 or waves == 1:
            print(
                f"wave {waves}: {args.tabs} tabs open {at:.0f} MB, closed {sizes[-1]:.0f} MB, "
                f"{counts[-1]} threads, {server.open_files} files",
                flush=True,
            )
    if waves < args.waves:
        wrong.append(f"{waves} waves in this time, too few to tell; there should be {args.waves}")
    if waves > 5 and sizes[-1] - sizes[4] > MOST_LEAKED:
        wrong.append(f"{sizes[-1] - sizes[4]:.0f} MB more than after the fifth wave")
    if counts and counts[-1] - counts[0] > MOST_THREADS:
        wrong.append(f"{counts[-1] - counts[0]} threads more than after the first wave")
    status, log = server.end()
    traces = log.count("Traceback")
    if status:
        wrong.append(f"the server ended with {status}")
    if traces:
        wrong.append(f"{traces} traces in {args.log}")
    print("\n".join(wrong) or f"{waves} waves, nothing leaked, no trace in the log")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
