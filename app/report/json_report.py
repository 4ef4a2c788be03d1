"""What report.json says of a merge: for programs, and for who wants to make it again."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass, replace
from enum import Enum
from typing import Any

import numpy as np

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from algorithms.verdict.decision import Outcome
from algorithms.verdict.performance_index import performance_index
from app.model.merge_inputs import MergeInputs
from app.model.settings import settings_of, value_at
from app.report.export_frame import ExportedMap
from app.report.ros_transform import parent_of
from app.system.clock import made_at
from app.system.version import versions

NO_PAIR = MergeInputs()


def report_of(
    result: MergeResult,
    config: Any = None,
    load_s: float = 0.0,
    inputs: Mapping[str, str] | None = None,
    pair: MergeInputs = NO_PAIR,
    exported: ExportedMap | None = None,
) -> dict[str, Any]:
    """What report.json says: metres and radians; a number that is not finite is null. "resampled" are the
    cells of maps that were coarser than the merged one's, "scan" says how the plane was searched.

    load_s   : seconds spent on reading the maps
    inputs   : the files it was made from, as the user named them
    pair     : what was merged: its files and their hashes, what is odd about them, what the robots are called
    exported : the merged map as it is given away; None: there is none
    """
    verdict, told = result.verdict, pair.names.told
    found = {
        "T_ref_mov": asdict(result.T_ref_mov),
        "covariance": result.covariance,
        "verdict": replace(verdict, reason=told(verdict.reason), hint=told(verdict.hint)),
        "objective": result.value,
        "proven_optimal": result.proven_optimal,
        "timings_s": {"load": load_s, **result.timings_s},
        "scan": result.scan,
        "proof": proof_of(result),
        "answers": [
            {
                "T_ref_mov": asdict(weighed.T_ref_mov),
                "score": weighed.score,
                "quantities": weighed.quantities,
                "deviations": weighed.deviations,
                "evidence": weighed.evidence,
            }
            for weighed in result.weighed
        ],
        "performance_index_at_estimate": performance_index(result.fusion),
        "resampled": {f"map{number}": cell for number, cell in result.fusion.resampled.items()},
        "merged_map": None if exported is None else _exported(exported, pair.names),
    }
    return _report(found, result.method, result.seed, config, load_s, inputs, pair)


def report_of_no_answer(
    refusal: NoAnswerError,
    method: str,
    seed: int,
    config: Any = None,
    load_s: float = 0.0,
    inputs: Mapping[str, str] | None = None,
    pair: MergeInputs = NO_PAIR,
) -> dict[str, Any]:
    """What report.json says where the method found no transform: the keys of ``report_of``, null where
    there is nothing to say. Arguments as there.
    """
    reason = pair.names.told(str(refusal))
    verdict = {"accepted": False, "outcome": Outcome.REFUSED, "probability": 0.0, "reason": reason}
    return _report({"verdict": verdict}, method, seed, config, load_s, inputs, pair)


def _report(
    found: Mapping[str, Any],
    method: str,
    seed: int,
    config: Any,
    load_s: float,
    inputs: Mapping[str, str] | None,
    pair: MergeInputs,
) -> dict[str, Any]:
    robots = {} if pair.names == UNNAMED else {"robot1": pair.names.ref, "robot2": pair.names.mov}
    report = {
        "T_ref_mov": None,
        "covariance": None,
        "verdict": None,
        "objective": None,
        "proven_optimal": False,
        "method": method,
        "seed": seed,
        "timings_s": {"load": load_s},
        "scan": None,
        "proof": None,
        "answers": [],
        "performance_index_at_estimate": None,
        "resampled": {},
        "merged_map": None,
        "settings": config,
        "changed_settings": changed_settings(method, config),
        "inputs": {**(inputs or {}), **robots},
        "files": pair.files,
        "warnings": [pair.names.told(remark) for remark in pair.readings()],
        "made": made_at(),
        "versions": versions(),
    }
    return {key: plain(value) for key, value in (report | found).items()}


def changed_settings(method: str, config: Any) -> dict[str, Any]:
    """The settings that differ from the method's defaults, by the names of their flags, with both values."""
    defaults = METHODS[method].defaults if method in METHODS else None
    if config is None or type(config) is not type(defaults):
        return {}
    pairs = {
        ".".join(each.path): {"value": each.default, "default": value_at(defaults, each.path)}
        for each in settings_of(config)
    }
    return {name: pair for name, pair in pairs.items() if pair["value"] != pair["default"]}


def _exported(exported: ExportedMap, names: RobotNames) -> dict[str, Any]:
    """What report.json says of the merged map: metres, radians, cells."""
    cells = exported.cells
    return {
        "frame": parent_of(exported.frame, names),
        "T_ref_frame": exported.T_ref_frame,
        "resolution": cells.grid.resolution,
        "origin": cells.grid.origin,
        "cells_changed": cells.changed,
        "now_wall": cells.now_wall,
        "now_free": cells.now_free,
        "corrections": exported.corrections,
        "cells_corrected": exported.corrected,
    }


def proof_of(result: MergeResult) -> dict[str, Any] | None:
    """How the proof ended, in the units of "objective"; None for a method without one.

    nodes  : blocks of transforms that were bounded
    gap    : how much better than the best found something could still be
    rivals : the best transforms elsewhere, best first
    """
    proof = result.proof
    if proof is None:
        return None
    rivals = zip(proof.rivals, proof.rival_values, strict=True)
    return {
        "nodes": proof.nodes,
        "gap": proof.gap,
        "proven": proof.proven,
        "stopped": proof.stopped,
        "swarm_found_it": result.search_found_it,
        "rivals": [
            {"T_ref_mov": asdict(Pose2.from_array(pose)), "value": float(value)} for pose, value in rivals
        ],
    }


def report_json(report: Mapping[str, Any]) -> bytes:
    """The content of report.json, a line per key."""
    texts = {key: json.dumps(value, ensure_ascii=False, allow_nan=False) for key, value in report.items()}
    lines = (f"  {json.dumps(key)}: {text}" for key, text in texts.items())
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def plain(value: Any) -> Any:
    """The value as JSON can hold it."""
    if isinstance(value, Enum):
        return value.value
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
