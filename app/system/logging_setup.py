"""The log of a server: a line of JSON for each thing, on stderr; nothing of what a file holds, no token."""

from __future__ import annotations

import json
import logging
import re
from collections.abc import Callable
from datetime import datetime, timezone
from time import monotonic
from typing import Any

QUIET, VERBOSE = logging.WARNING, logging.INFO
OFTEN, WHILE = 20, 60.0  # lines of the same words that are written within so many seconds
MOST_WORDS = 1000  # different words that are counted at a time

log = logging.getLogger(__name__)

_hidden: set[str] = set()  # words that no line may hold
_TOKEN = re.compile(r"(token=|mapmeld_[0-9a-f]{8}=)[^&;\s\"\\]+")


def hide(word: str) -> None:
    """Let no line hold this word, wherever it comes from; "": nothing."""
    if word:
        _hidden.add(word)


class JsonFormatter(logging.Formatter):
    """A record as one line: when, level, where, what, and the facts that ``extra={"facts": ...}`` gave."""

    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, Any] = {
            "when": datetime.fromtimestamp(record.created, timezone.utc).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "where": record.name,
            "what": record.getMessage(),
            **getattr(record, "facts", {}),
        }
        if record.exc_info:
            line["trace"] = self.formatException(record.exc_info)
        text = json.dumps(line, ensure_ascii=False, default=str)
        for word in _hidden:
            text = text.replace(word, "…")
        return _TOKEN.sub(r"\1…", text)


class RepeatFilter(logging.Filter):
    """Lets through the same words some times a minute: what a stranger can cause must not fill a disk.

    Warnings and worse; what ``--verbose`` adds is logged in full.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        super().__init__()
        self._clock = clock
        self._since: dict[tuple[str, str], tuple[float, int]] = {}  # of words: from when, and how often

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether it may be written; the first one after a silence tells how many were not."""
        if record.levelno < QUIET:
            return True
        now, words = self._clock(), (record.name, str(record.msg).partition("\n")[0][:200])
        since, count = self._since.get(words, (now, 0))
        if now - since >= WHILE:
            if count > OFTEN:
                record.facts = {**getattr(record, "facts", {}), "left out before": count - OFTEN}
            since, count = now, 0
        if len(self._since) >= MOST_WORDS:
            self._since.clear()
        self._since[words] = since, count + 1
        return count < OFTEN


class Handshakes(logging.Filter):
    """Of what websockets stumbles over only the kind is told, and only to who looks for it.

    Else every malformed request, of anyone, would write a trace that holds its first line: the token too.
    """

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether it may be told as it is: that a handler of ours failed."""
        if record.levelno < logging.ERROR or record.msg == "connection handler failed":
            return True
        kind = record.exc_info and record.exc_info[0]
        log.debug("%s: %s", record.msg, kind.__name__ if kind else "for no reason that is given")
        return False


_handshakes = Handshakes()


def quiet_handshakes() -> None:
    """From now on a request that is none leaves nothing of itself in any log."""
    logging.getLogger("websockets.server").addFilter(_handshakes)  # a second time it does nothing


def start(verbose: bool) -> None:
    """Log to stderr from now on: what went wrong, and with ``verbose`` who came and what was done."""
    handler = logging.StreamHandler()
    handler.setFormatter(JsonFormatter())
    handler.addFilter(RepeatFilter())
    logging.basicConfig(level=QUIET, handlers=[handler], force=True)
    logging.getLogger("app").setLevel(VERBOSE if verbose else QUIET)


def facts(**values: Any) -> dict[str, Any]:
    """What a line is to hold beside its words: ``log.info("merged", extra=facts(seconds=1.2))``."""
    return {"facts": values}
