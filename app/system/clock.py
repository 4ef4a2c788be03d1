"""When something was made: the one place that files and messages take a date from."""

from __future__ import annotations

import os
import time
from datetime import datetime, timezone

from algorithms.common.errors import SettingError

VARIABLE = "SOURCE_DATE_EPOCH"


def stamp() -> int:
    """The time of now as messages of ROS carry it: nanoseconds since 1970. It decides nothing."""
    return time.time_ns()


def made_at() -> str:
    """The date and time of now in UTC, as ISO 8601 writes it: ``2026-07-01T12:00:00Z``.

    Where the environment holds SOURCE_DATE_EPOCH, seconds since 1970, it is that time, so that one input
    gives one file whenever it is made; raises SettingError where it holds something else.
    """
    told = os.environ.get(VARIABLE, "")
    try:
        now = datetime.fromtimestamp(int(told), timezone.utc) if told else datetime.now(timezone.utc)
    except (ValueError, OverflowError, OSError) as error:
        raise SettingError(f"{VARIABLE} is {told!r}; give whole seconds since 1970, or unset it") from error
    return now.strftime("%Y-%m-%dT%H:%M:%SZ")
