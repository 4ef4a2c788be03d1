"""A project in place of two maps: merged as it was left, unless something is given beside it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from commandline import usage_error

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import RobotNames
from algorithms.files.map_file import read_map
from algorithms.fleets.pair_hypotheses import Hypothesis, PairFinding, PairOrder
from algorithms.maps.grid_map import OCCUPIED, UNKNOWN
from algorithms.maps.map_corrections import Corrections, Edit
from algorithms.methods import registry as methods
from algorithms.methods.merge_result import BY_HAND
from algorithms.methods.registry import METHODS
from algorithms.observations.fleet import Fleet
from app.cli.main import main
from app.model.fleet_state import FleetState
from app.model.merge_inputs import Files, MergeInputs
from app.model.settings import with_value
from app.page.project.project_file import project_to_bytes, read_project
from app.page.undo.page_snapshot import PageSnapshot
from app.page.undo.undo_history import SavedTab, UndoStep
from app.report.export_frame import ExportFrame


@pytest.fixture
def project(small_case, tmp_path):
    """A project of the pair, with settings, names and a frame of its own."""
    inputs = replace(MergeInputs.of(small_case), names=RobotNames("Bob", "Alice"))
    config = with_value(METHODS["spectra-swarm"].defaults, ("augment", "spread"), 4.5)
    page = PageSnapshot(inputs, Files(), "spectra-swarm", config, 7, export=ExportFrame("mov"))
    saved = SavedTab((UndoStep("load", page), UndoStep("seed", replace(page, seed=8))), 0)
    path = tmp_path / "flat.mapmeld"
    path.write_bytes(project_to_bytes(saved))
    return path


def merged(project, *words):
    """What the report says, and which settings are no defaults."""
    main(["merge", str(project), "--out", str(project.parent / "out"), *words])
    report = json.loads((project.parent / "out" / "report.json").read_text())
    return report, {name: pair["value"] for name, pair in report["changed_settings"].items()}


def test_a_project_is_merged_as_it_was_left_and_what_is_given_beside_it_counts_more(project, small_case):
    report, settings = merged(project)
    config = with_value(METHODS["spectra-swarm"].defaults, ("augment", "spread"), 4.5)
    pair = small_case.ref, small_case.mov, small_case.observations
    *_, last = methods.run("spectra-swarm", *pair, config, 7)
    assert report["T_ref_mov"] == pytest.approx(vars(last.detail.T_ref_mov))
    assert (report["method"], report["seed"]) == ("spectra-swarm", 7)
    assert settings == {"augment.spread": 4.5}
    assert report["inputs"] == {"project": str(project), "robot1": "Bob", "robot2": "Alice"}
    assert report["merged_map"]["frame"] == "alice/map"

    words = "--seed 1 --swarm.particles 50 --names A B --frame ref"
    report, settings = merged(project, *words.split())
    assert report["seed"] == 1
    assert settings == {"augment.spread": 4.5, "swarm.particles": 50}
    assert report["inputs"]["robot1"] == "A"
    assert merged(project, "--method", "spectra-proven")[1] == {}


def test_what_was_corrected_in_a_project_is_in_its_merged_map_and_not_in_its_verdict(project):
    plain, _ = merged(project)
    saved = read_project(project)
    line = Edit("keep-out", ((0.0, 0.0), (1.0, 0.0)))
    page = replace(saved.steps[0].snapshot, corrections=Corrections(edits=(line,)))
    project.write_bytes(project_to_bytes(SavedTab((UndoStep("keep-out line", page),))))
    report, _ = merged(project, "--crop", "--frame", "ref")
    grid = read_map(project.parent / "out" / "merged.yaml")
    assert all(grid.value_at(np.array([x, 0.0])) == OCCUPIED for x in np.linspace(0, 1, 30))
    assert (grid.cells[0] != UNKNOWN).any() and (grid.cells[:, -1] != UNKNOWN).any()  # noqa: PT018
    assert report["verdict"]["probability"] == plain["verdict"]["probability"]
    assert report["merged_map"]["cells_corrected"] > 0
    assert report["merged_map"]["corrections"]["crop"] is True
    assert "1 keep-out line" in (project.parent / "out" / "report.html").read_text()


def test_an_answer_taken_by_hand_in_a_project_is_taken(project, capsys):
    saved = read_project(project)
    page = replace(saved.steps[0].snapshot, hand=Pose2(1.0, 2.0, 0.5), taken=BY_HAND)
    project.write_bytes(project_to_bytes(SavedTab((UndoStep("take it by hand", page),))))
    assert main(["merge", str(project), "--out", str(project.parent / "out")]) == 0
    assert "x 1.000 m, y 2.000 m" in capsys.readouterr().out


def test_a_project_that_cannot_be_merged_is_told_in_one_line(project, capsys):
    words = ["merge", str(project), "--out", str(project.parent / "out")]
    for command in (["merge", project, project, "--out", "x"], ["serve", project, project]):
        assert usage_error(*command) == 2
        assert "give it alone" in capsys.readouterr().err
    page = read_project(project).steps[0].snapshot
    unknown = {"inputs": page.inputs.knowing((), "sighting")}
    fleet = Fleet({"a": page.inputs.ref, "b": page.inputs.mov})
    for change, told in (
        (unknown, "cannot be merged yet; open it with mapmeld serve. Place"),
        (
            {"inputs": MergeInputs(), "fleet": FleetState(fleet)},
            "shows a fleet; merge it with: mapmeld fleet",
        ),
    ):
        project.write_bytes(project_to_bytes(SavedTab((UndoStep("load", replace(page, **change)),))))
        assert main(words) == 2
        assert told in capsys.readouterr().err
    project.write_bytes(b"hello")
    assert main(words) == 2
    assert "is no zip" in capsys.readouterr().err


def test_the_fleet_of_a_project_is_merged_with_what_was_found_of_it_and_what_its_open_pair_knows(
    project, small_case, capsys
):
    command = ["fleet", str(project), "--out", str(project.parent / "fleet"), "--json"]

    def told(state):
        """What report.json says of a project that was left with this fleet."""
        project.write_bytes(project_to_bytes(SavedTab((UndoStep("load", replace(page, fleet=state)),))))
        main(command)
        return json.loads(capsys.readouterr().out)

    assert main(command) == 2
    assert "holds two maps and no fleet; merge it with: mapmeld merge" in capsys.readouterr().err
    page = read_project(project).steps[0].snapshot
    state = FleetState(Fleet({"Bob": page.inputs.ref, "Alice": page.inputs.mov}))
    order = PairOrder("Bob", "Alice", ())
    answer = Hypothesis(Pose2(1.0, 2.0, 0.5), np.diag((1e-4, 1e-4, 1e-6)), 0.99, 4.6)
    by_hand = state.with_finding(PairFinding(order, np.zeros(2), (answer,), "by hand", accepted=True))
    (pair,) = told(by_hand)["pairs"]
    assert pair["verdict"] == "by hand"

    known = told(state.open(order))
    assert [each["observer"] for each in known["sightings"]] == ["Bob"]
    assert known["robots"]["Alice"]["T_root_robot"]["x"] == pytest.approx(
        small_case.truth.T_ref_mov.x, abs=0.1
    )
    assert main([*command, "--frame", "nobody"]) == 2
    assert "nobody" in capsys.readouterr().err
