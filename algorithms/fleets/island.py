"""Robots that are tied to each other: their poses, solved together, and the one map of all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, log

import cv2
import networkx as nx
import numpy as np
import numpy.typing as npt

from algorithms.common.pose import FloatArray, Pose2
from algorithms.fleets.consistent_set import AnswerGraph
from algorithms.fleets.pose_graph import PoseSolution, solve
from algorithms.maps.grid_map import FREE, FREE_UP_TO, OCCUPIED_FROM, CellArray, GridMap
from algorithms.maps.map_fusion import Fusion, fuse

BESIDE = 0.2  # metres; walls so near to each other are one, in maps that bend and whose cells end anywhere
LEAST_WALL = 2.0  # metres; of less that contradicts nothing is concluded

CountArray = npt.NDArray[np.uint8]
"""(H, W) of how many robots; a fleet has fewer than it can count."""


@dataclass(frozen=True, eq=False)
class Island:
    """One map of one robot or several.

    root        : whose frame it is in
    poses, covariances : T_root_robot of each robot, and (3, 3) of its x, y, theta; metres, radians
    probability : of each robot, that it is placed right beside the root
    fusion      : of the maps, in the order of ``poses``
    """

    root: str
    poses: Mapping[str, Pose2]
    covariances: Mapping[str, FloatArray]
    probability: Mapping[str, float]
    fusion: Fusion

    def denied(self) -> dict[str, tuple[float, float]]:
        """Robots of whose walls the others' maps deny more than they confirm: metres of either.

        A wall is denied where others saw floor and none of them a wall beside it. It counts against a robot,
        too, where it is the one that saw floor, unless as many of the others saw floor there as the wall.
        """
        layers = self.fusion.layers
        if len(layers) < 3:
            return {}
        cell = self.fusion.merged.resolution
        reach = max(1, round(BESIDE / cell))
        around = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))

        def seen(layer: CellArray) -> tuple[CountArray, CountArray, CountArray]:
            """Its walls, what lies beside them, and floor that does not."""
            wall = (layer >= OCCUPIED_FROM).astype(np.uint8)
            near = np.asarray(cv2.dilate(wall, around), dtype=np.uint8)
            return wall, near, ((layer >= FREE) & (layer <= FREE_UP_TO) & (near == 0)).astype(np.uint8)

        some_wall, some_near, some_floor = (np.zeros(layers[0].shape, dtype=np.uint8) for _ in range(3))
        for layer in layers:
            for count, part in zip((some_wall, some_near, some_floor), seen(layer), strict=True):
                count += part
        out = {}
        for name, layer in zip(self.poses, layers, strict=True):
            wall, near, floor = seen(layer)
            others_near, others_floor = some_near - near, some_floor - floor
            confirmed = (wall > 0) & (others_near > 0)
            lone = (wall > 0) & (others_near == 0) & (others_floor > 0)
            missing = (floor > 0) & (some_wall > 0) & (others_near > others_floor)
            agree, deny = cell * int(confirmed.sum()), cell * int(lone.sum() + missing.sum())
            if deny > max(agree, LEAST_WALL):
                out[name] = agree, deny
        return out


def island_of(
    maps: Mapping[str, GridMap],
    graph: AnswerGraph,
    chosen: Mapping[int, int],
    likely: Mapping[int, float],
    names: Sequence[str],
) -> Island:
    """The island of these robots, the root first.

    chosen : the answers that tie them: number of a finding -> number of its answer
    likely : number of a finding -> that this answer is right
    raises : TooLargeError where the map would be over the bound
    """
    root = names[0]
    solution = PoseSolution({root: Pose2()}, {root: np.zeros((3, 3))})
    probability = {root: 1.0}
    if len(names) > 1:
        ties = graph.ties(chosen)
        edges = [graph.edge(number, k) for number, k in sorted(chosen.items())]
        solution = solve(root, graph.along(chosen, root, names), edges)
        probability = {name: _tied(ties, likely, root, name) for name in names}
    poses = {name: solution.poses[name] for name in names}
    fusion = fuse([maps[name] for name in names], list(poses.values()))
    return Island(root, poses, solution.covariances, probability, fusion)


def _tied(ties: nx.MultiGraph, likely: Mapping[int, float], root: str, name: str) -> float:
    """That a chain from the root is right: the likeliest, of which each link has its best answer."""
    links = nx.Graph()
    for a, b in ties.edges():
        links.add_edge(a, b, cost=-log(max(likely[key] for key in ties[a][b])))
    return exp(-nx.shortest_path_length(links, root, name, weight="cost"))
