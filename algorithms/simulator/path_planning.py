"""Driving: shortest clear ways through a floor, smoothed, and the track that a robot takes along them."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.common.parallel_kernels import kernel
from algorithms.common.pose import FloatArray
from algorithms.simulator.buildings.floor_plan import Building
from algorithms.simulator.portable_random import TURN, Ticks, snap

CELLS_PER_NODE = 4  # cells of the floor per node of the planner's grid, each way
STEP = 0.25  # metres between two scans
BODY = 8  # thirds of a node: a robot keeps about 0.27 m from any wall
FARTHEST = 3 * 255  # thirds of a node: what is farther from a wall is as near
COMFORT = 22  # thirds of a node: from 0.73 m on, more room is no better

Costs = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Track:
    """Where a robot was, scan by scan; in the world frame if true, in its own frame if believed.

    xy      : (N, 2) metres, multiples of 2^-20
    heading : (N,) ticks, counter-clockwise from x
    """

    xy: FloatArray
    heading: Ticks

    def __len__(self) -> int:
        return len(self.xy)


@kernel
def _clearance(wall: NDArray[np.bool_]) -> Costs:
    """Chamfer distance to the nearest wall in thirds of a node, in two passes."""
    height, width = wall.shape
    out = np.full((height + 2, width + 2), FARTHEST, dtype=np.int32)  # with a border
    for r in range(1, height + 1):
        for c in range(1, width + 1):
            above = min(out[r - 1, c - 1] + 4, out[r - 1, c] + 3, out[r - 1, c + 1] + 4)
            out[r, c] = 0 if wall[r - 1, c - 1] else min(FARTHEST, above, out[r, c - 1] + 3)
    for r in range(height, 0, -1):
        for c in range(width, 0, -1):
            below = min(out[r + 1, c - 1] + 4, out[r + 1, c] + 3, out[r + 1, c + 1] + 4)
            out[r, c] = min(out[r, c], below, out[r, c + 1] + 3)
    return np.asarray(out[1:-1, 1:-1].copy())


@kernel
def _spread(
    clearance: Costs,
    start_row: int,
    start_col: int,
    body: int,
    comfort: int,
    cost: Costs,
    back: NDArray[np.int8],
) -> None:
    """Cheapest way from one node to all, Dijkstra with a ring of buckets; integers, so no ties by luck.

    cost : (H, W), filled; 10 per straight node with room to spare, −1 out of reach
    back : (H, W), filled; which of the eight neighbours the way comes from, −1 at the start
    """
    height, width = clearance.shape
    rows = (0, 1, 0, -1, 1, 1, -1, -1)
    cols = (1, 0, -1, 0, 1, -1, 1, -1)
    buckets = 14 * (comfort - body + 1) // 2 + 20
    head = np.full(buckets, -1, dtype=np.int32)
    pool = 8 * height * width
    link = np.empty(pool, dtype=np.int32)
    node = np.empty(pool, dtype=np.int32)
    cost[:] = -1
    back[:] = -1
    cost[start_row, start_col] = 0
    node[0] = start_row * width + start_col
    link[0] = -1
    head[0] = 0
    used, waiting, now = 1, 1, 0
    while waiting > 0:
        entry = head[now % buckets]
        if entry < 0:
            now += 1
            continue
        head[now % buckets] = link[entry]
        waiting -= 1
        r, c = node[entry] // width, node[entry] % width
        if cost[r, c] != now:
            continue
        for k in range(8):
            rr, cc = r + rows[k], c + cols[k]
            if rr < 0 or rr >= height or cc < 0 or cc >= width or clearance[rr, cc] < body:
                continue
            tight = max(0, comfort - clearance[rr, cc]) // 2
            reached = now + (10 if k < 4 else 14) * (2 + tight) // 2
            if cost[rr, cc] < 0 or reached < cost[rr, cc]:
                cost[rr, cc] = reached
                back[rr, cc] = k
                node[used] = rr * width + cc
                link[used] = head[reached % buckets]
                head[reached % buckets] = used
                used += 1
                waiting += 1


@kernel
def _walk_back(back: NDArray[np.int8], row: int, col: int) -> NDArray[np.int32]:
    """The nodes from where a way ends to where it began, (N, 2) row and column."""
    rows = (0, 1, 0, -1, 1, 1, -1, -1)
    cols = (1, 0, -1, 0, 1, -1, 1, -1)
    way = np.empty((back.size, 2), dtype=np.int32)
    length, r, c = 0, row, col
    while True:
        way[length, 0], way[length, 1] = r, c
        length += 1
        k = back[r, c]
        if k < 0:
            return np.asarray(way[:length])
        r, c = r - rows[k], c - cols[k]


@kernel
def _smooth(xy: FloatArray, clearance: Costs, node: float, body: int, rounds: int) -> FloatArray:
    """Pull every point towards its neighbours again and again, unless that leads it to a wall."""
    here: FloatArray = xy.copy()
    there: FloatArray = xy.copy()
    for _ in range(rounds):
        for n in range(1, len(here) - 1):
            x = (here[n - 1, 0] + 2.0 * here[n, 0] + here[n + 1, 0]) / 4.0
            y = (here[n - 1, 1] + 2.0 * here[n, 1] + here[n + 1, 1]) / 4.0
            if clearance[int(y / node), int(x / node)] >= body:
                there[n, 0], there[n, 1] = x, y
        here[:] = there
    return here


@kernel
def _resample(xy: FloatArray, step: float) -> FloatArray:
    """Points every ``step`` metres along a polyline, its first point included."""
    dx, dy = xy[1:, 0] - xy[:-1, 0], xy[1:, 1] - xy[:-1, 1]
    pieces = np.sqrt(dx * dx + dy * dy)
    out = np.empty((int(pieces.sum() / step) + 3, 2))
    out[0] = xy[0]
    count, due, passed = 1, step, 0.0
    for n in range(1, len(xy)):
        piece = pieces[n - 1]
        while piece > 0.0 and passed + piece >= due:
            share = (due - passed) / piece
            out[count, 0] = xy[n - 1, 0] + share * dx[n - 1]
            out[count, 1] = xy[n - 1, 1] + share * dy[n - 1]
            count += 1
            due += step
        passed += piece
    return np.asarray(out[:count])


class PathPlanner:
    """Ways between the stops of a building; every way is found once and kept.

    node      : metres per node of the planning grid
    wall      : (h, w) bool, nodes that hold any wall
    clearance : (h, w) int32, thirds of a node to the nearest wall
    stops     : (n, 2) the stops a robot can reach, on nodes; metres, world frame
    metres    : (n, n) how long the way between two stops is, tight passages counted longer
    """

    def __init__(self, building: Building) -> None:
        solid = building.solid
        k = CELLS_PER_NODE
        h, w = -(-solid.shape[0] // k), -(-solid.shape[1] // k)
        padded = np.ones((h * k, w * k), dtype=bool)
        padded[: solid.shape[0], : solid.shape[1]] = solid
        self.node = building.resolution * k
        self.wall: NDArray[np.bool_] = np.asarray(padded.reshape(h, k, w, k).any(axis=(1, 3)))
        self.clearance = _clearance(self.wall)
        self._find_stops(building)

    def _find_stops(self, building: Building) -> None:
        """Keep the stops that can be reached from one another: the largest such group."""
        near = [cell for stop in building.stops.tolist() if (cell := self._roomiest(stop)) is not None]
        cells = sorted(set(near), key=near.index)
        fields = [self._field(cell) for cell in cells]
        reached = [[m for m, (r, c) in enumerate(cells) if cost[r, c] >= 0] for cost, _ in fields]
        group = max(reached, key=len, default=[])
        self._cells = [cells[n] for n in group]
        self._back = [fields[n][1] for n in group]
        self.stops: FloatArray = (np.array(self._cells, dtype=float)[:, ::-1] + 0.5) * self.node
        costs = [[int(fields[n][0][r, c]) for r, c in self._cells] for n in group]
        self.metres: FloatArray = np.array(costs, dtype=float) * (self.node / 10)

    def _roomiest(self, stop: list[float]) -> tuple[int, int] | None:
        """The node with most room within a metre of a point, or None where there is no room."""
        col, row = int(stop[0] / self.node), int(stop[1] / self.node)
        reach = max(1, round(0.6 / self.node))
        r0, c0 = max(0, row - reach), max(0, col - reach)
        part = self.clearance[r0 : row + reach + 1, c0 : col + reach + 1]
        if part.size == 0 or int(part.max()) < BODY + 1:
            return None
        r, c = divmod(int(part.argmax()), part.shape[1])
        return r0 + r, c0 + c

    def _field(self, cell: tuple[int, int]) -> tuple[Costs, NDArray[np.int8]]:
        cost = np.empty(self.clearance.shape, dtype=np.int32)
        back = np.empty(self.clearance.shape, dtype=np.int8)
        _spread(self.clearance, cell[0], cell[1], BODY, COMFORT, cost, back)
        return cost, back

    def way(self, start: int, end: int) -> FloatArray:
        """(N, 2) nodes from one stop to another; metres, world frame."""
        nodes = _walk_back(self._back[end], *self._cells[start])
        return (nodes[:, ::-1].astype(float) + 0.5) * self.node

    def drive(self, tour: list[int], step: float = STEP) -> Track:
        """Drive through stops in the given order; a smooth way, one pose every ``step`` metres."""
        ways = [self.way(a, b) for a, b in itertools.pairwise(tour)]
        nodes = np.concatenate([self.stops[tour[:1]], *(way[1:] for way in ways)])
        rounds = round(0.3 / self.node) * 10  # a corner is rounded over about half a metre
        smooth = _smooth(nodes, self.clearance, self.node, BODY, rounds)
        xy = snap(_resample(smooth, step))
        ahead = np.concatenate([xy[1:], xy[-1:]]) - np.concatenate([xy[:1], xy[:-1]])
        heading = np.rint(np.arctan2(ahead[:, 1], ahead[:, 0]) * (TURN / (2 * np.pi)))
        return Track(xy, heading.astype(np.int64) % TURN)
