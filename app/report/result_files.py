"""A merge as files: what was found, how sure it is, and how to publish it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, is_dataclass
from enum import Enum
from typing import Any

import cv2
import numpy as np

from algorithms.common.errors import NoAnswerError
from algorithms.files.map_file import map_to_bytes
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.verdict.decision import Outcome
from algorithms.verdict.performance_index import performance_index
from algorithms.verdict.ranking import Weighed
from app.drawing import grid_pixels as render
from app.drawing.palette import LIGHT
from app.model.merge_inputs import MergeInputs
from app.report.html_report import report_page
from app.report.ros_transform import transform_yaml
from app.system.cancellation import Check, unwatched
from app.system.version import versions

MERGED = "merged"
MERGED_FILES = (f"{MERGED}.pgm", f"{MERGED}.yaml")
TRANSFORM_FILE = "transform.yaml"
OVERLAY_FILE = "overlay.png"
PAGE_FILE = "report.html"
REPORT_FILE = "report.json"


def report_of(
    result: MergeResult,
    config: Any = None,
    load_s: float = 0.0,
    inputs: Mapping[str, str] | None = None,
    warnings: Sequence[str] = (),
) -> dict[str, Any]:
    """What report.json says: metres and radians; a number that is not finite is null.

    config : the settings that were used
    load_s : seconds spent on reading the maps
    inputs : the files it was made from, as the user named them
    warnings : what is odd about how the maps were read
    """
    T, verdict = result.T_ref_mov, result.verdict
    report = {
        "T_ref_mov": {"x": T.x, "y": T.y, "theta": T.theta},
        "covariance": result.covariance,
        "verdict": asdict(verdict),
        "objective": result.value,
        "proven_optimal": result.proven_optimal,
        "method": result.method,
        "seed": result.seed,
        "timings_s": {"load": load_s, **result.timings_s},
        "proof": proof_of(result),
        "answers": [_answer(weighed) for weighed in result.weighed],
        "performance_index_at_estimate": performance_index(result.fusion),
        "settings": config,
        "inputs": dict(inputs or {}),
        "warnings": list(warnings),
        "versions": versions(),
    }
    return {key: plain(value) for key, value in report.items()}


def _answer(weighed: Weighed) -> dict[str, Any]:
    """An answer that may be right: its transform, its log-odds were it alone, and what it rests on."""
    T = weighed.T_ref_mov
    return {
        "T_ref_mov": {"x": T.x, "y": T.y, "theta": T.theta},
        "score": weighed.score,
        "quantities": dict(weighed.quantities),
        "deviations": weighed.deviations,
        "evidence": asdict(weighed.evidence),
    }


def report_of_no_answer(
    refusal: NoAnswerError,
    method: str,
    seed: int,
    config: Any = None,
    load_s: float = 0.0,
    inputs: Mapping[str, str] | None = None,
    warnings: Sequence[str] = (),
) -> dict[str, Any]:
    """What report.json says where the method found no transform: the keys of ``report_of``, null where
    there is nothing to say.
    """
    report = {
        "T_ref_mov": None,
        "covariance": None,
        "verdict": {
            "accepted": False,
            "outcome": Outcome.REFUSED,
            "probability": 0.0,
            "reason": str(refusal),
        },
        "objective": None,
        "proven_optimal": False,
        "method": method,
        "seed": seed,
        "timings_s": {"load": load_s},
        "proof": None,
        "answers": [],
        "performance_index_at_estimate": None,
        "settings": config,
        "inputs": dict(inputs or {}),
        "warnings": list(warnings),
        "versions": versions(),
    }
    return {key: plain(value) for key, value in report.items()}


def proof_of(result: MergeResult) -> dict[str, Any] | None:
    """How the proof ended, in the units of "objective"; None for a method without one.

    nodes  : blocks of transforms that were bounded
    gap    : how much better than the best found something could still be
    rivals : the best transforms elsewhere, best first
    """
    proof = result.proof
    if proof is None:
        return None
    rivals = zip(proof.rivals.tolist(), proof.rival_values.tolist(), strict=True)
    return {
        "nodes": proof.nodes,
        "gap": proof.gap,
        "proven": proof.proven,
        "stopped": proof.stopped,
        "swarm_found_it": result.search_found_it,
        "rivals": [
            {"T_ref_mov": {"x": x, "y": y, "theta": theta}, "value": value} for (x, y, theta), value in rivals
        ],
    }


def report_json(report: Mapping[str, Any]) -> bytes:
    """The content of report.json, a line per key."""
    lines = (f"  {json.dumps(key)}: {_json(value)}" for key, value in report.items())
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def overlay(fusion: Fusion, most: int = render.MOST_PIXELS) -> render.Pixels:
    """(H, W, 3) of both maps under T: whose wall it is, where they agree and where they contradict.

    Its first row is the top, as on a screen; what no map knows is grey; ``most`` pixels on a side.
    """
    floor = render.merged_floor(fusion, LIGHT, most).pixels
    picture = np.empty((*floor.shape[:2], 3), dtype=np.uint8)
    picture[:] = LIGHT.unknown
    for layer in (floor, render.merged_walls(fusion, LIGHT, most).pixels):
        cv2.copyTo(cv2.cvtColor(layer, cv2.COLOR_RGBA2RGB), np.ascontiguousarray(layer[..., 3]), picture)
    return render.upright(picture)


def overlay_png(result: MergeResult) -> bytes:
    """That picture as a file."""
    done, png = cv2.imencode(".png", overlay(result.fusion)[..., ::-1])  # OpenCV keeps blue first
    assert done
    return png.tobytes()


def result_files(
    result: MergeResult,
    inputs: MergeInputs,
    config: Any,
    report: Mapping[str, Any],
    with_merged: bool,
    check: Check = unwatched,
) -> dict[str, bytes]:
    """All files of a result by name, in the order they are to be written: the report is the last.

    inputs, config : what was merged, and the settings that were used
    with_merged    : also what a robot would act upon: the merged map and the transform
    check          : is called now and then
    """
    files: dict[str, bytes] = {}
    if with_merged:
        files |= map_to_bytes(result.fusion.merged, MERGED)
        files[TRANSFORM_FILE] = transform_yaml(result)
    check(0.1)
    files[OVERLAY_FILE] = overlay_png(result)
    check(0.2)
    files[PAGE_FILE] = report_page(result, inputs, config, report, check)
    files[REPORT_FILE] = report_json(report)
    return files


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


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
