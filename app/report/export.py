"""What a result leaves the page as: one zip with everything, or each file alone."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from algorithms.files.observation_file import OBSERVATION_FILE, observations_to_bytes
from algorithms.methods.merge_result import MergeResult
from app.model.merge_inputs import MergeInputs
from app.report.result_files import (
    MERGED_FILES,
    OVERLAY_FILE,
    PAGE_FILE,
    REPORT_FILE,
    TRANSFORM_FILE,
    report_of,
    result_files,
)
from app.system.cancellation import Check, unwatched

ARCHIVE = "merged.zip"
# what a robot would act upon: of a refused merge it is given only to who insists
ACTED_UPON = (*MERGED_FILES, TRANSFORM_FILE)
# every file alone, the most wanted first
ALONE = (PAGE_FILE, *reversed(MERGED_FILES), TRANSFORM_FILE, OVERLAY_FILE, REPORT_FILE, OBSERVATION_FILE)


@dataclass(frozen=True, eq=False)
class ResultFiles:
    """A result with what it was made from; its files are made when they are first asked for.

    config : the settings that were used
    """

    result: MergeResult
    inputs: MergeInputs
    config: Any
    _made: dict[str, bytes] = field(default_factory=dict, init=False)

    @property
    def files(self) -> Mapping[str, bytes]:
        """Everything by name: what ``mapmeld merge`` leaves in a folder, and the observation as used."""
        return self.make()

    def make(self, check: Check = unwatched) -> Mapping[str, bytes]:
        """The same; ``check`` is called now and then while they are made, which is once."""
        if not self._made:
            report = report_of(
                self.result, self.config, inputs=self._named(), warnings=self.inputs.readings()
            )
            files = result_files(self.result, self.inputs, self.config, report, with_merged=True, check=check)
            self._made[OBSERVATION_FILE] = observations_to_bytes(self.inputs.observations)
            self._made.update(files)
        return self._made

    def _named(self) -> dict[str, str]:
        i = self.inputs
        return {
            "pair": i.name,
            "map1": i.ref.name if i.ref is not None else "",
            "map2": i.mov.name if i.mov is not None else "",
        }

    def archive(self) -> bytes:
        """A zip with all files."""
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as target:
            for name, content in self.files.items():
                target.writestr(name, content)
        return packed.getvalue()
