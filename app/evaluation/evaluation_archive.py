"""What a comparison or a sweep of the page leaves it as: a zip of what the command leaves in a folder."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence
from threading import Lock

from algorithms.files.case_folder import Case
from app.evaluation.comparison_files import case_files, contest_files
from app.evaluation.method_comparison import ComparedRun, Configs
from app.evaluation.parameter_sweep import SweepPlan, SweepPoint
from app.evaluation.sweep_files import sweep_files

_DRAWING = Lock()  # matplotlib is told how to draw for the whole process


def contest_archive(case: Case, scores: Sequence[ComparedRun], configs: Configs, seed: int) -> bytes:
    """Tables, bars and merged maps of one pair."""
    with _DRAWING:
        return _zipped({**contest_files(scores, configs, seed), **case_files(case.name, case, scores)})


def sweep_archive(case: Case, plan: SweepPlan, points: Sequence[SweepPoint]) -> bytes:
    """Tables and the figure of a sweep, as far as it came."""
    with _DRAWING:
        return _zipped(sweep_files(case, plan, points))


def _zipped(files: Mapping[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in files.items():
            target.writestr(name, content)
    return packed.getvalue()
