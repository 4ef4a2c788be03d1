"""A browser that is opened at the page, without its token on a command line, which every account can read."""

from __future__ import annotations

import contextlib
import logging
import os
import tempfile
import webbrowser
from collections.abc import Iterator
from html import escape
from pathlib import Path

log = logging.getLogger(__name__)


@contextlib.contextmanager
def browser(url: str, secret: bool) -> Iterator[None]:
    """Open a browser; for the length of the block a file that leads there may lie in a folder of ours: the
    browser is given one, which nobody else may read, where the address holds a secret.
    """
    with contextlib.ExitStack() as held:
        if secret:
            try:
                url = _hidden(url, Path(held.enter_context(tempfile.TemporaryDirectory(prefix="mapmeld-"))))
            except OSError as error:  # the address is printed, too
                log.warning("no browser is opened: %s", error.strerror or error)
                yield
                return
        webbrowser.open(url)
        yield


def _hidden(url: str, folder: Path) -> str:
    """The address of a file that leads to ``url``."""
    page = folder / "open.html"
    with open(os.open(page, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as stream:
        stream.write(
            '<!doctype html><html lang="en"><meta charset="utf-8"><title>mapmeld</title>'
            f'<meta http-equiv="refresh" content="0;url={escape(url)}">'
            f'<p><a href="{escape(url)}">Open mapmeld</a></html>\n'
        )
    return page.as_uri()
