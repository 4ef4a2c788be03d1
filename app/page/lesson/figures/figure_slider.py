"""What can be moved in a picture of the lesson: by a slider below it, or by a handle in it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FigureSlider:
    """One thing that can be moved in a picture.

    label       : what it is
    count       : how many places it has
    start       : where it stands at first
    first, step : the number that is shown for the first place, and between two
    """

    label: str
    count: int
    start: int = 0
    first: float = 1
    step: float = 1


def shown(dial: FigureSlider, place: int) -> float:
    """The number beside a dial that stands at a place."""
    return dial.first + dial.step * place


def place_of(dial: FigureSlider, number: float) -> int:
    """The place of the number beside a dial."""
    return min(dial.count - 1, max(0, round((number - dial.first) / dial.step)))
