"""Trees of robots that grow by one link at a time, and the way from one robot to another along them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Generic, TypeVar

Link = TypeVar("Link")


class SpanningForest(Generic[Link]):
    """No graph library answers the way between two nodes of a growing tree as often as it is asked here."""

    def __init__(self, names: Iterable[str]) -> None:
        self._up: dict[str, tuple[str, Link] | None] = dict.fromkeys(names)

    def root(self, name: str) -> str:
        """The same for all of one tree, as long as nothing is linked to it."""
        while (step := self._up[name]) is not None:
            name = step[0]
        return name

    def link(self, a: str, b: str, link: Link) -> None:
        """Join the trees of two robots; they must be two."""
        at, step = b, self._up[b]
        self._up[b] = None
        while step is not None:  # b becomes the root of its tree
            above, named = step
            step, self._up[above] = self._up[above], (at, named)
            at = above
        self._up[b] = a, link

    def way(self, start: str, end: str) -> list[tuple[str, Link]]:
        """The links from start to end, each with the robot that it begins at; they must be of one tree."""
        ahead, back = self._climb(start), self._climb(end)
        while ahead and back and ahead[-1] == back[-1]:  # above where the two ways meet
            ahead.pop()
            back.pop()
        forward = [(name, link) for name, _, link in ahead]
        return forward + [(above, link) for _, above, link in reversed(back)]

    def _climb(self, name: str) -> list[tuple[str, str, Link]]:
        """Every step from a robot to its root: from, to, and the link between."""
        steps = []
        while (step := self._up[name]) is not None:
            steps.append((name, *step))
            name = step[0]
        return steps
