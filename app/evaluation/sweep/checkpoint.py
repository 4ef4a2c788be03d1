"""What of a long piece of work is done, in a file that outlives the process that does it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from algorithms.common.errors import OutputError, unreadable

Record = dict[str, Any]


class Checkpoint:
    """Records by their key, a line of JSON each; a record is on the disk before ``add`` returns.

    A line that a killed process left half-written is passed over: its work is done again.
    """

    def __init__(self, path: Path | None = None) -> None:
        """Read what is there; without a path it is kept in memory only."""
        self._path, self._known = path, dict[str, Record]()
        self._torn = False
        if path is None or not path.exists():
            return
        try:
            data = path.read_bytes()
        except OSError as error:
            raise unreadable(path, error, "choose another --out") from error
        self._torn = bool(data) and not data.endswith(b"\n")
        for line in data.splitlines():
            try:
                entry = json.loads(line)
                self._known[entry["key"]] = dict(entry["record"])
            except (ValueError, KeyError, TypeError):  # torn by a stop: that point is worked out again
                continue

    def get(self, key: str) -> Record | None:
        return self._known.get(key)

    def records(self) -> list[Record]:
        return list(self._known.values())

    def add(self, key: str, record: Mapping[str, Any]) -> None:
        """Keep a record; raises OutputError."""
        self._known[key] = dict(record)
        if self._path is None:
            return
        line = json.dumps({"key": key, "record": record}, ensure_ascii=False, allow_nan=False) + "\n"
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with self._path.open("ab") as stream:
                stream.write(("\n" * self._torn + line).encode())
                stream.flush()
                os.fsync(stream.fileno())
        except OSError as error:
            self._torn = True  # half of it may be there
            raise OutputError(
                self._path,
                f"cannot be written ({error.strerror})",
                "see that the folder may be written to and the disk has room, or choose another --out",
            ) from error
        self._torn = False
