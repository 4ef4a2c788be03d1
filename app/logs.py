"""The log of a server: a line of JSON for each thing, on stderr; nothing of what a file holds, no token."""

from __future__ import annotations

import json
import logging
from datetime import datetime, timezone
from typing import Any

QUIET, VERBOSE = logging.WARNING, logging.INFO


class Lines(logging.Formatter):
    """A record as one line: when, level, where, what, and the facts that ``extra={"facts": ...}`` gave."""

    def format(self, record: logging.LogRecord) -> str:
        """The line."""
        line: dict[str, Any] = {
            "when": datetime.fromtimestamp(record.created, timezone.utc).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "where": record.name,
            "what": record.getMessage(),
            **getattr(record, "facts", {}),
        }
        if record.exc_info:
            line["trace"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=False, default=str)


def start(verbose: bool) -> None:
    """Log to stderr from now on: what went wrong, and with ``verbose`` who came and what was done."""
    handler = logging.StreamHandler()
    handler.setFormatter(Lines())
    logging.basicConfig(level=QUIET, handlers=[handler], force=True)
    logging.getLogger("app").setLevel(VERBOSE if verbose else QUIET)


def facts(**told: Any) -> dict[str, Any]:
    """What a line is to hold beside its words: ``log.info("merged", extra=facts(seconds=1.2))``."""
    return {"facts": told}
