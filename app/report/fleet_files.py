"""A fleet's result as files: its maps, where every robot's frame lies, the pose graph, the reports."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from algorithms.common.pose import Pose2
from algorithms.files.map_file import map_to_bytes
from algorithms.files.yaml_fields import number_text, quoted
from algorithms.fleets.fleet_merge import FleetResult
from algorithms.fleets.island import Island
from algorithms.observations.fleet import Fleet
from app.report.export_frame import AS_MERGED, ExportedMap, ExportFrame
from app.report.fleet_report import fleet_page
from app.report.json_report import plain, report_json
from app.report.result_files import MERGED, PAGE_FILE, REPORT_FILE
from app.report.ros_transform import CHOSEN, frame_names, publish_command
from app.system.clock import made_at
from app.system.version import versions

TRANSFORMS_FILE = "transforms.yaml"
GRAPH_FILE = "graph.g2o"


def island_name(number: int) -> str:
    """What the map of an island is called, by its number from 1: the anchor's is the merged one."""
    return MERGED if number == 1 else f"{MERGED}_island{number}"


def remove_other_islands(folder: Path, stems: Collection[str]) -> None:
    """Take away maps of islands that an earlier merge left in a folder and that are not among ``stems``."""
    for path in folder.glob(f"{MERGED}_island*"):
        if path.stem not in stems and re.fullmatch(rf"{MERGED}_island\d+\.(yaml|pgm)", path.name):
            path.unlink(missing_ok=True)


def exported_maps(result: FleetResult, frame: ExportFrame = AS_MERGED) -> dict[str, ExportedMap]:
    """The maps of the islands as they are given away, by their names: each in the frame of its island's root.

    raises : SettingError, TooLargeError
    """
    return {
        island_name(number): frame.given(island.fusion.merged, Pose2())
        for number, island in enumerate(result.islands, 1)
        if number == 1 or len(island.poses) > 1
    }


def fleet_files(
    fleet: Fleet, result: FleetResult, name: str, exported: Mapping[str, ExportedMap] | None = None
) -> dict[str, bytes]:
    """All files by name, in the order they are to be written: the reports are the last.

    name     : of the fleet, for people
    exported : its maps; None: as they were merged
    """
    files: dict[str, bytes] = {}
    for stem, each in (exported or exported_maps(result)).items():
        files |= map_to_bytes(each.cells.grid, stem)
    files[TRANSFORMS_FILE] = transforms_yaml(result)
    files[GRAPH_FILE] = graph_g2o(result)
    files[PAGE_FILE] = fleet_page(fleet, result, name)
    files[REPORT_FILE] = report_json(fleet_report(fleet, result, name))
    return files


def transforms_yaml(result: FleetResult) -> bytes:
    """Where every robot's frame lies in its island's, and the command that publishes it in ROS 2."""
    lines = [
        "# Takes points of a robot's frame to that of the root of its map; m, m, rad. "
        "The robots' maps are the frames NAME/map, the name in small letters; "
        "the root's lies in that of the merged map."
    ]
    robots = [name for island in result.islands for name in island.poses]
    frames = dict(zip(robots, frame_names(robots), strict=True))
    for number, island in enumerate(result.islands, 1):
        merged = CHOSEN if number == 1 else f"{CHOSEN}_island{number}"
        lines += [f"{island_name(number)}:", f"  root: {quoted(island.root)}", "  robots:"]
        for name, T in island.poses.items():
            x, y, theta = (number_text(value) for value in (T.x, T.y, T.theta))
            lines.append(f"    {quoted(name)}:")
            lines.append(f"      T_root_robot: {{x: {x}, y: {y}, theta: {theta}}}")
            # ROS refuses a frame that is its own parent: the root's hangs below that of the merged map
            parent = merged if name == island.root else frames[island.root]
            lines.append(f"      publish: {quoted(publish_command(T, parent, frames[name]))}")
    return ("\n".join(lines) + "\n").encode()


def graph_g2o(result: FleetResult) -> bytes:
    """The pose graph for other tools: a vertex a robot, an edge an answer that the poses rest on."""
    ids = {name: k for k, name in enumerate(name for island in result.islands for name in island.poses)}
    lines = [f"# {number} {name}" for name, number in ids.items()]
    for island in result.islands:
        for name, T in island.poses.items():
            lines.append(f"VERTEX_SE2 {ids[name]} {T.x!r} {T.y!r} {T.theta!r}")
        lines.append(f"FIX {ids[island.root]}")
    for number, k in result.chosen.items():
        finding = result.findings[number]
        answer = finding.hypotheses[k]
        T, information = answer.T_ref_mov, np.linalg.inv(answer.covariance)
        numbers = [T.x, T.y, T.theta, *information[np.triu_indices(3)].tolist()]
        ends = f"{ids[finding.order.ref]} {ids[finding.order.mov]}"
        lines.append(f"EDGE_SE2 {ends} {' '.join(repr(float(number)) for number in numbers)}")
    return ("\n".join(lines) + "\n").encode()


def fleet_report(fleet: Fleet, result: FleetResult, name: str) -> dict[str, Any]:
    """What report.json says: metres and radians."""
    left = {each.number: each for each in result.left_out}
    return {
        "fleet": name,
        "anchor": fleet.anchor,
        "robots": {
            robot: _robot(number, island, robot, result)
            for number, island in enumerate(result.islands, 1)
            for robot in island.poses
        },
        "sightings": [
            {
                "number": number,
                "observer": seen.observer,
                "observed": seen.observed,
                "used": number not in left,
                "off_m": left[number].distance if number in left else None,
                "reason": left[number].reason if number in left else "",
            }
            for number, seen in enumerate(fleet.sightings)
        ],
        "pairs": [_pair(number, result) for number in range(len(result.findings))],
        "files": {robot: plain(grid.files) for robot, grid in fleet.maps.items()},
        "made": made_at(),
        "versions": versions(),
    }


def _robot(number: int, island: Island, name: str, result: FleetResult) -> Mapping[str, Any]:
    return {
        "map": f"{island_name(number)}.yaml" if number == 1 or len(island.poses) > 1 else None,
        "placed": number == 1,
        "root": island.root,
        "T_root_robot": asdict(island.poses[name]),
        "covariance": plain(island.covariances[name]),
        "probability": island.probability[name],
        "reason": result.refused.get(name, "" if number == 1 else "nothing ties it to the anchor"),
    }


def _pair(number: int, result: FleetResult) -> Mapping[str, Any]:
    finding, chosen = result.findings[number], result.chosen.get(number)
    return {
        "observer": finding.order.ref,
        "observed": finding.order.mov,
        "sightings": list(finding.order.sightings),
        "chosen": chosen,
        "probability": result.likely.get(number),
        "answers": [
            {"T_ref_mov": asdict(answer.T_ref_mov), "probability": answer.probability}
            for answer in finding.hypotheses
        ],
        "verdict": finding.said,
    }
