"""What two processes say to each other again and again, in as few bytes as there is news in it.

A map, and what a stage has made, travels once: from then on both ends know it by a number, and what
was the same thing before it travelled is the same thing afterwards.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

from algorithms.methods.steps import RefineDetail, Step
from algorithms.optimisation.optimiser import SearchState

Number = tuple[str, int]  # of a thing: which end had it first, and its how many-th it was

FLEETING = (Step, RefineDetail, SearchState)  # there are thousands, and nobody asks for one of them again


class IncrementalPickle:
    """One end of a line between two processes.

    What one end packs the other has to unpack, in that order; both turn over at the same places. Where
    either fails they no longer agree, and two new ones are to be taken.
    """

    def __init__(self, end: str) -> None:
        """end : a name that the other end does not have"""
        self._end, self._count = end, 0
        self._things: dict[Number, Any] = {}
        self._before: dict[Number, Any] = {}  # those of before the last turn-over that were not met since
        self._numbers: dict[int, Number] = {}  # by id(); whatever has one is held by one of the two

    def turn_over(self) -> None:
        """Forget what was not met since the last time."""
        for thing in self._before.values():
            del self._numbers[id(thing)]
        self._before, self._things = self._things, {}

    def pack(self, value: Any) -> bytes:
        buffer = io.BytesIO()
        _Packer(buffer, self).dump(value)
        return buffer.getvalue()

    def unpack(self, data: bytes) -> Any:
        return _Unpacker(io.BytesIO(data), self).load()

    def number(self, thing: Any) -> Number | None:
        """The number of a thing that the other end has, too."""
        number = self._numbers.get(id(thing))
        if number is not None:
            self.thing(number)
        return number

    def give(self, thing: Any) -> Number:
        """A number for what is new to the other end."""
        number = self._end, self._count
        self._count += 1
        self._keep(number, thing)
        return number

    def _keep(self, number: Number, thing: Any) -> None:
        self._things[number] = thing
        self._numbers[id(thing)] = number

    def made(self, number: Number, kind: Callable[..., Any], *values: Any) -> Any:
        """What has come with its number."""
        thing = kind(*values)
        self._keep(number, thing)
        return thing

    def thing(self, number: Number) -> Any:
        """The thing of this number, which stays for another while."""
        if number in self._before:
            self._things[number] = self._before.pop(number)
        return self._things[number]


@cache
def _lasting(kind: type) -> tuple[str, ...]:
    """The fields of what is known by its identity; none where it is known by its value."""
    if is_dataclass(kind) and kind.__eq__ is object.__eq__ and kind not in FLEETING:
        return tuple(field.name for field in fields(kind))
    return ()


class _Packer(pickle.Pickler):
    def __init__(self, file: io.BytesIO, line: IncrementalPickle) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._line = line

    def reducer_override(self, thing: Any) -> Any:
        names = _lasting(type(thing))
        if not names:
            return NotImplemented
        number = self._line.number(thing)
        if number is not None:
            return known, (number,)
        number = self._line.give(thing)  # made of its fields alone: what was worked out of them stays here
        return new, (number, type(thing), *(getattr(thing, name) for name in names))


class _Unpacker(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, line: IncrementalPickle) -> None:
        super().__init__(file)
        self._line = line

    def find_class(self, module: str, name: str) -> Any:
        if module == __name__ and name == known.__name__:
            return self._line.thing
        if module == __name__ and name == new.__name__:
            return self._line.made  # none of its own: 3.10 never frees the ring
        return super().find_class(module, name)


def known(number: Number) -> Any:
    """Stands in a pickle for a thing that the other end has."""
    raise pickle.UnpicklingError(f"{number} means something to its line alone")


def new(number: Number, kind: type, *values: Any) -> Any:
    """Stands in a pickle for a thing that comes with its number."""
    raise pickle.UnpicklingError(f"{number} means something to its line alone")
