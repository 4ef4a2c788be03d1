"""Widgets are told only what is new: every assignment is a message to the browser, and draws it again."""

from __future__ import annotations

from typing import Any


def put(handle: Any, **values: Any) -> None:
    """Give a widget these values, but for those that it has already."""
    for name, value in values.items():
        if getattr(handle, name) != value:
            setattr(handle, name, value)
