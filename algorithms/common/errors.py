"""What can be wrong with a user's input, or keep a method from answering. Anything else is a bug of ours."""

from __future__ import annotations

from algorithms.common.display_text import show_hidden


class MapMergeError(Exception):
    """A mistake the user can mend. The message names the place, the finding and the remedy.

    It may hold what a stranger wrote: hidden characters stand there as their numbers.

    made_of : what it is made of again in another process
    """

    def __init__(self, message: str, *made_of: str) -> None:
        super().__init__(show_hidden(message))
        self._made_of = made_of or self.args

    def __reduce__(self) -> tuple[type[MapMergeError], tuple[str, ...]]:
        return type(self), self._made_of


class InputFileError(MapMergeError):
    """A file that cannot be used as it is.

    source : name of the file as the user knows it (a path, or the name of an upload)
    found  : what is wrong with it
    remedy : what to do about it
    """

    def __init__(self, source: object, found: str, remedy: str) -> None:
        self.source, self.found, self.remedy = map(show_hidden, (str(source), found, remedy))
        super().__init__(f"{source}: {found}; {remedy}", self.source, self.found, self.remedy)


def unreadable(source: object, error: Exception, remedy: str) -> InputFileError:
    """What is said of a file or folder that the system does not let us read."""
    if isinstance(error, FileNotFoundError):
        return InputFileError(source, "no such file", remedy)
    if isinstance(error, IsADirectoryError):
        return InputFileError(source, "is a folder", remedy)
    if isinstance(error, UnicodeDecodeError):  # whose own words show a part of it
        return InputFileError(source, "cannot be read (not a text)", remedy)
    cause = getattr(error, "strerror", None) or str(error)
    return InputFileError(source, f"cannot be read ({cause})", remedy)


class SettingError(MapMergeError):
    """A setting outside what it may be."""


class NoAnswerError(MapMergeError):
    """A method that found no transform at all: a refused merge without a place to show.

    why : what it lacked, and what would help; the end of a sentence
    """

    def __init__(self, why: str) -> None:
        self.why = why
        super().__init__(f"Refused: {why}.", why)


class TooLargeError(MapMergeError):
    """A map that would take more memory than the stated bound."""


class OutputError(MapMergeError):
    """A result that could not be written.

    target : the file or folder as the user knows it
    cause  : what went wrong
    remedy : what to do about it
    """

    def __init__(self, target: object, cause: str, remedy: str) -> None:
        self.target, self.cause, self.remedy = str(target), cause, remedy
        super().__init__(f"{target}: {cause}; {remedy}", self.target, cause, remedy)
