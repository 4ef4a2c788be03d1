"""Many simulated views, drawn in processes: what the detector is trained on and measured with."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

from algorithms.simulator.buildings.building_types import BUILDINGS
from algorithms.simulator.views.robot_views import VIEWS, RobotView, draw_view


@dataclass(frozen=True)
class ViewAsked:
    """Arguments of ``draw_view``."""

    seed: int
    kind: str
    robot: bool
    hardship: str | None = None
    distance: tuple[float, float] = (1.0, 6.0)

    def draw(self) -> RobotView:
        return draw_view(
            self.seed, self.kind, robot=self.robot, distance=self.distance, hardship=self.hardship
        )


def asked_views(
    first: int,
    count: int,
    robot: bool,
    hardship: str | None = None,
    distance: tuple[float, float] = (1.0, 6.0),
) -> list[ViewAsked]:
    """So many views, spread over all kinds of buildings, VIEWS of each building.

    first : seed of the first; a multiple of VIEWS begins with a building of its own
    """
    kinds = list(BUILDINGS)
    return [
        ViewAsked(first + n, kinds[(first + n) // VIEWS % len(kinds)], robot, hardship, distance)
        for n in range(count)
    ]


def each_view(
    asked: Sequence[ViewAsked], jobs: int, work: Callable[[ViewAsked, RobotView], Any]
) -> Iterator[Any]:
    """What ``work`` makes of every view, in the order they are asked for.

    work : a function of a module, so that it can go to another process
    """
    with ProcessPoolExecutor(max_workers=jobs) as pool:
        yield from pool.map(partial(_worked, work), asked, chunksize=VIEWS)


def _worked(work: Callable[[ViewAsked, RobotView], Any], asked: ViewAsked) -> Any:
    return work(asked, asked.draw())
