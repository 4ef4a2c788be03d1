"""The command ``mapmeld``, and ``python -m mapmeld``.

It begins here because a foreign package may be called ``app`` or ``algorithms``, but hardly ``mapmeld``: one
that stands in their place is told in a line, not with a trace of imports that fail.
"""

from __future__ import annotations

import sys
from typing import NoReturn

from mapmeld.own_packages import CURE, intruder

EXIT_BAD_INPUT = 2  # as in app.cli.main, which may be somebody else's here


def entry() -> None:
    """Run the command line; exit status 2 where another package stands in the place of one of ours."""
    complaint = intruder("app", "algorithms")
    if complaint:
        _complain(complaint)
    try:
        # The one line of this package that imports app, and only here: before it was not known to be ours.
        from app.cli.main import entry as command
    except ImportError as error:  # installed over each other, in one folder
        _complain(f"a part of it is missing, or another package's ({error}); {CURE}")
    command()


def _complain(what: str) -> NoReturn:
    if sys.stderr is not None:  # closed by whoever started us
        sys.stderr.write(f"mapmeld: {what}\n")
    sys.exit(EXIT_BAD_INPUT)


if __name__ == "__main__":
    entry()
