"""The notebook of the method runs from its first cell to its last, and comes to what the library comes to."""

from __future__ import annotations

import json
from typing import Any

import matplotlib.pyplot as plt
import pytest
from repository import ROOT

from algorithms.common.pose import pose_error

NOTEBOOK = ROOT / "docs" / "notebooks" / "method.ipynb"
CELLS = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
CODE = ["".join(cell["source"]) for cell in CELLS if cell["cell_type"] == "code"]


@pytest.fixture
def run(monkeypatch) -> dict[str, Any]:
    """The names that there are after the last cell; run as Jupyter does, in the notebook's folder."""
    monkeypatch.chdir(NOTEBOOK.parent)
    plt.switch_backend("agg")
    names: dict[str, Any] = {}
    for code in CODE:
        exec(compile(code, NOTEBOOK.name, "exec"), names)
    plt.close("all")
    return names


def test_the_method_step_by_step_comes_to_the_truth_and_to_what_merge_says(run):
    at, truth = run["at"].x_mov, run["case"].truth.T_ref_mov
    for T, near in ((run["best"], 0.25), (run["T"], 0.1)):
        metres, radians = pose_error(truth, T, at)
        assert metres < near
        assert radians < 0.02
    assert run["result"].verdict.accepted
    assert run["result"].verdict.reason.startswith("Merged")


def test_it_is_short_and_kept_without_what_a_run_leaves_in_it():
    assert sum(bool(line.strip()) for code in CODE for line in code.splitlines()) <= 75
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in CELLS)
