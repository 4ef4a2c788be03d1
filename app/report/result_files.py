"""A merge as files: what was found, how sure it is, and how to publish it; each alone, or all in a zip."""

from __future__ import annotations

import io
import json
import math
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, is_dataclass, replace
from enum import Enum
from typing import Any

import cv2
import numpy as np

from algorithms.common.errors import NoAnswerError
from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import OBSERVATION_FILE, known_to_bytes
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.suggestions import are_wanted
from algorithms.verdict.decision import Outcome
from algorithms.verdict.performance_index import performance_index
from app.drawing import grid_pixels as render
from app.drawing.palette import LIGHT
from app.model.merge_inputs import MergeInputs
from app.report.html_report import report_page
from app.report.ros_transform import transform_yaml
from app.report.suggestion_files import suggestion_files
from app.system.cancellation import Check, never_cancelled
from app.system.version import versions

MERGED = "merged"
MERGED_FILES = (f"{MERGED}.pgm", f"{MERGED}.yaml")
TRANSFORM_FILE = "transform.yaml"
OVERLAY_FILE = "overlay.png"
PAGE_FILE = "report.html"
REPORT_FILE = "report.json"
ARCHIVE = "merged.zip"
# what a robot would act upon: of a refused merge it is given only to who insists
ACTED_UPON = (*MERGED_FILES, TRANSFORM_FILE)
# every file alone, the most wanted first
ALONE = (PAGE_FILE, *reversed(MERGED_FILES), TRANSFORM_FILE, OVERLAY_FILE, REPORT_FILE, OBSERVATION_FILE)


def report_of(
    result: MergeResult,
    config: Any = None,
    load_s: float = 0.0,
    inputs: Mapping[str, str] | None = None,
    warnings: Sequence[str] = (),
) -> dict[str, Any]:
    """What report.json says: metres and radians; a number that is not finite is null. "resampled" are the
    cells of maps that were coarser than the merged one's, "scan" says how the plane was searched.

    load_s   : seconds spent on reading the maps
    inputs   : the files it was made from, as the user named them
    warnings : what is odd about how the maps were read
    """
    found = {
        "T_ref_mov": asdict(result.T_ref_mov),
        "covariance": result.covariance,
        "verdict": result.verdict,
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
    }
    return _report(found, result.method, result.seed, config, load_s, inputs, warnings)


def report_of_no_answer(refusal: NoAnswerError, method: str, seed: int, *about: Any) -> dict[str, Any]:
    """What report.json says where the method found no transform: the keys of ``report_of``, null where
    there is nothing to say.

    about : config, load_s, inputs and warnings of ``report_of``
    """
    verdict = {"accepted": False, "outcome": Outcome.REFUSED, "probability": 0.0, "reason": str(refusal)}
    return _report({"verdict": verdict}, method, seed, *about)


def _report(
    found: Mapping[str, Any],
    method: str,
    seed: int,
    config: Any,
    load_s: float,
    inputs: Mapping[str, str] | None,
    warnings: Sequence[str],
) -> dict[str, Any]:
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
        "settings": config,
        "inputs": dict(inputs or {}),
        "warnings": warnings,
        "versions": versions(),
    }
    return {key: plain(value) for key, value in (report | found).items()}


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
    done, png = cv2.imencode(".png", overlay(result.fusion)[..., ::-1])  # OpenCV keeps blue first
    assert done
    return png.tobytes()


def result_files(
    result: MergeResult,
    inputs: MergeInputs,
    config: Any,
    report: Mapping[str, Any],
    with_merged: bool,
    check: Check = never_cancelled,
) -> dict[str, bytes]:
    """All files of a result by name, in the order they are to be written: the report is the last.

    with_merged : also what a robot would act upon: the merged map and the transform
    check       : is called now and then
    """
    files: dict[str, bytes] = {}
    if with_merged:
        files |= map_to_bytes(result.fusion.merged, MERGED)
        files[TRANSFORM_FILE] = transform_yaml(result, inputs.names)
    if are_wanted(result) and inputs.ref is not None and inputs.mov is not None:
        files |= suggestion_files(result, inputs.ref, inputs.mov, inputs.names)
    check(0.1)
    files[OVERLAY_FILE] = overlay_png(result)
    check(0.2)
    files[PAGE_FILE] = report_page(result, inputs, config, report, check)
    files[REPORT_FILE] = report_json(report)
    return files


@dataclass(frozen=True, eq=False)
class ResultFiles:
    """A result, its inputs and settings; its files are made when they are first asked for."""

    result: MergeResult
    inputs: MergeInputs
    config: Any
    _made: dict[str, bytes] = field(default_factory=dict, init=False)

    @property
    def files(self) -> Mapping[str, bytes]:
        """Everything by name: what ``mapmeld merge`` leaves in a folder, and what was known."""
        return self.make()

    def make(self, check: Check = never_cancelled) -> Mapping[str, bytes]:
        """The same; ``check`` is called now and then while they are made, which is once."""
        if not self._made:
            i, maps = self.inputs, {"map1": self.inputs.ref, "map2": self.inputs.mov}
            named = {"pair": i.name} | {key: grid.name if grid else "" for key, grid in maps.items()}
            if i.names != UNNAMED:
                named |= {"robot1": i.names.ref, "robot2": i.names.mov}
            warnings = [i.names.told(remark) for remark in i.readings()]
            verdict = self.result.verdict
            told = {"reason": i.names.told(verdict.reason), "hint": i.names.told(verdict.hint)}
            result = replace(self.result, verdict=replace(verdict, **told))
            report = report_of(result, self.config, inputs=named, warnings=warnings)
            files = result_files(self.result, i, self.config, report, with_merged=True, check=check)
            known = {OBSERVATION_FILE: known_file(i)} if i.known else {}
            self._made.update(known | files)
        return self._made


def known_file(inputs: MergeInputs) -> bytes:
    """What is known, as an observation file; its remarks name the robots."""
    return inputs.names.told(known_to_bytes(inputs.known).decode()).encode()


def zip_bytes(files: Mapping[str, bytes]) -> bytes:
    """A zip of files by their names."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in files.items():
            target.writestr(name, content)
    return packed.getvalue()


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
