"""How much memory a server takes that nobody uses, and how soon it is there: ``make idle``, on Linux.

Memory is the proportional set size: a page that several processes share counts once among them all. Others
that run from the same environment take their share of it, too: stop them first.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import subprocess
import sys
from time import monotonic, sleep

from process_tree import sizes, words
from repository import ROOT
from wire import WireTab, until

SETTLED = 8.0  # seconds without a change
CHANGE = 1.0  # MB that are none
PATIENCE = 300.0  # seconds; a fresh clone compiles its kernels first


def settled(pid: int) -> dict[int, float]:
    """What they take once that has not changed for a while."""
    end, since, last = monotonic() + PATIENCE, monotonic(), sizes(pid)
    while monotonic() < end and monotonic() - since < SETTLED:
        sleep(0.5)
        now = sizes(pid)
        if now.keys() != last.keys() or abs(sum(now.values()) - sum(last.values())) > CHANGE:
            since, last = monotonic(), now
    return sizes(pid)


def first_merge(port: int, pause: float) -> None:
    """Say how long it takes from the press of a button to the answer, in a tab that came a while before."""
    tab = WireTab(port)
    tab.choose("Instant")
    sleep(pause)
    tab.words["mood"] = ""
    began = monotonic()
    tab.press("Merge")
    until(lambda: tab.mood in ("accepted", "refused", "failed"), "a merge")
    print(f"the first merge, {pause:g} s after its tab came: {monotonic() - began:.2f} s", flush=True)
    tab.close()


def report(pid: int) -> None:
    """Say what each process takes, and all of them."""
    found = settled(pid)
    for each, size in found.items():
        print(f"{size:7.1f} MB  {' '.join(words(each)[1:])[:70]}")
    print(f"{sum(found.values()):7.1f} MB in {len(found)} processes", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--merge", action="store_true", help="a tab comes then and merges, which is timed")
    parser.add_argument("--early", action="store_true", help="a tab comes and merges as soon as it can")
    parser.add_argument("--pause", type=float, default=2.0, help="seconds before it does so (default: 2)")
    args = parser.parse_args()
    began = monotonic()
    server = subprocess.Popen(
        [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0"],
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        start_new_session=True,
    )
    try:
        assert server.stdout is not None
        said = next(line for line in server.stdout if line.startswith("mapmeld is at "))
        port = int(re.findall(r":(\d+)/", said)[0])
        print(f"page up after {monotonic() - began:.1f} s", flush=True)
        if args.early:
            first_merge(port, args.pause)
        report(server.pid)
        if args.merge:
            first_merge(port, args.pause)
            report(server.pid)
    finally:
        os.killpg(server.pid, signal.SIGINT)
        try:
            server.wait(30)
        except subprocess.TimeoutExpired:
            os.killpg(server.pid, signal.SIGKILL)
    return 0


if __name__ == "__main__":
    sys.exit(main())
