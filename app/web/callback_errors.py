"""A bug in what a control does: it is told in the tab where it happened, logged, and nothing else ends."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

import viser

from algorithms.common.errors import MapMergeError

log = logging.getLogger(__name__)

OUT_OF_MEMORY = "There is too little memory for this. Close other tabs, or take smaller maps."


def watched(submit: Callable[..., Any]) -> Callable[..., Any]:
    """The ``submit`` of viser's threads, in which a callback that fails says so."""

    def watch(callback: Callable[..., Any], *args: Any) -> Any:
        def run() -> Any:
            try:
                return callback(*args)
            except Exception as error:
                if isinstance(error, MapMergeError):  # nobody's mistake here: a process that died, say
                    log.warning("what a control does could not be done: %s", type(error).__name__)
                else:
                    log.exception("what a control does ended in a bug")
                tell(args[0] if args else None, error)

        return submit(run)

    return watch


def tell(where: Any, error: Exception) -> None:
    """Say in a tab, given as its client or an event of it, that something of ours went wrong."""
    client = getattr(where, "client", where)
    if isinstance(client, viser.ClientHandle):
        client.add_notification("This did not work", words(error), auto_close_seconds=12.0, color="red")


def words(error: Exception) -> str:
    """What went wrong, for a person."""
    if isinstance(error, MapMergeError):
        return str(error)
    if isinstance(error, MemoryError):
        return OUT_OF_MEMORY
    if isinstance(error, OSError) and error.strerror:
        return f"The system says: {error.strerror}. The page goes on; the server's log tells more."
    return f"A bug of mapmeld's ({type(error).__name__}). The page goes on; the server's log tells more."
