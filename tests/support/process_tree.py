"""What the system says of a process and of those that descend from it, on Linux."""

from __future__ import annotations

import re
from pathlib import Path


def tree(pid: int) -> list[int]:
    """A process and all that descend from it."""
    found = [pid]
    for parent in found:
        for children in Path(f"/proc/{parent}/task").glob("*/children"):
            found += [int(child) for child in children.read_text().split()]
    return found


def words(pid: int) -> list[str]:
    """Its command line."""
    return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode().split()


def megabytes(pid: int) -> float:
    """What a process takes, and its share of what it shares with others."""
    text = Path(f"/proc/{pid}/smaps_rollup").read_text()
    return int(re.findall(r"^Pss:\s+(\d+)", text, flags=re.MULTILINE)[0]) / 1024


def sizes(pid: int) -> dict[int, float]:
    """The megabytes of each process of the tree that is there by now."""
    found = {}
    for each in tree(pid):
        try:
            found[each] = megabytes(each)
        except (OSError, IndexError):  # it has ended meanwhile
            continue
    return found


def mergers(pid: int) -> list[int]:
    """Those of a server in which merges run, however they were started."""
    kinds = {each: " ".join(words(each)) for each in tree(pid)[1:]}
    parents = {each for each, kind in kinds.items() if "forkserver" in kind and len(tree(each)) > 1}
    return [each for each, kind in kinds.items() if "resource_tracker" not in kind and each not in parents]
