"""A merge as files: what was found, how sure it is, and how to publish it; each alone, or all in a zip."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import cv2
import numpy as np

from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import OBSERVATION_FILE, known_to_bytes
from algorithms.maps.map_corrections import NO_CORRECTIONS, Corrected, Corrections, corrected
from algorithms.maps.map_fusion import Fusion
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.suggestions import are_wanted
from algorithms.verdict.contradictions import near_walls
from app.drawing import grid_pixels as render
from app.drawing.palette import LIGHT
from app.model.merge_inputs import MergeInputs
from app.report.export_frame import AS_MERGED, ExportedMap, ExportFrame
from app.report.html_report import report_page
from app.report.json_report import report_json, report_of
from app.report.ros_transform import transform_yaml
from app.report.suggestion_files import suggestion_files
from app.system.cancellation import Check, never_cancelled

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


def overlay(fusion: Fusion, most: int = render.MOST_PIXELS) -> render.Pixels:
    """(H, W, 3) of both maps under T: whose wall it is, where they agree and where they contradict.

    Its first row is the top, as on a screen; what no map knows is grey; ``most`` pixels on a side.
    """
    floor = render.merged_floor(fusion, LIGHT, most).pixels
    picture = np.empty((*floor.shape[:2], 3), dtype=np.uint8)
    picture[:] = LIGHT.unknown
    for layer in (floor, render.merged_walls(fusion, near_walls(fusion), LIGHT, most).pixels):
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
    exported: ExportedMap | None,
    check: Check = never_cancelled,
) -> dict[str, bytes]:
    """All files of a result by name, in the order they are to be written: the report is the last.

    exported : the merged map as a robot would act upon it, which is left with the transform; None: neither is
    check    : is called now and then
    """
    files: dict[str, bytes] = {}
    if exported is not None:
        files |= map_to_bytes(exported.cells.grid, MERGED)
        files[TRANSFORM_FILE] = transform_yaml(result, inputs.names, exported.frame)
    if are_wanted(result) and inputs.ref is not None and inputs.mov is not None:
        files |= suggestion_files(result, inputs.ref, inputs.mov, inputs.names)
    check(0.1)
    files[OVERLAY_FILE] = overlay_png(result)
    check(0.2)
    files[PAGE_FILE] = report_page(result, inputs, config, report, exported, check)
    files[REPORT_FILE] = report_json(report)
    return files


@dataclass(frozen=True, eq=False)
class ResultFiles:
    """A result, its inputs and settings; its files are made when they are first asked for.

    frame : in which the merged map is given away
    corrections : that a person made in it
    """

    result: MergeResult
    inputs: MergeInputs
    config: Any
    frame: ExportFrame = AS_MERGED
    corrections: Corrections = NO_CORRECTIONS
    _made: dict[str, bytes] = field(default_factory=dict, init=False)

    @cached_property
    def exported(self) -> ExportedMap:
        """The merged map as it is given away; raises SettingError, TooLargeError."""
        return self.frame.given_corrected(self.corrected, self.result.T_ref_mov)

    @cached_property
    def corrected(self) -> Corrected:
        """The merged map as a person corrected it, in map 1's frame."""
        return corrected(self.result.fusion, self.corrections)

    @property
    def files(self) -> Mapping[str, bytes]:
        """Everything by name: what ``mapmeld merge`` leaves in a folder, and what was known."""
        return self.make()

    def make(self, check: Check = never_cancelled) -> Mapping[str, bytes]:
        """The same; ``check`` is called now and then while they are made, which is once."""
        if not self._made:
            i, maps = self.inputs, {"map1": self.inputs.ref, "map2": self.inputs.mov}
            named = {"pair": i.name} | {key: grid.name if grid else "" for key, grid in maps.items()}
            report = report_of(self.result, self.config, inputs=named, pair=i, exported=self.exported)
            files = result_files(self.result, i, self.config, report, self.exported, check)
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
