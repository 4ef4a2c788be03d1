"""``mapmeld fleet`` leaves a map, every transform, the graph and the reports, and says who is placed."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import is_name
from algorithms.files.atomic_write import write_files
from algorithms.files.map_file import map_to_bytes, read_map
from algorithms.files.observation_file import known_to_bytes
from algorithms.maps.grid_map import GridMap
from app.cli.main import main
from app.report.fleet_files import transforms_yaml
from app.report.ros_transform import frame_names, publish_command

ALL = {"merged.pgm", "merged.yaml", "transforms.yaml", "graph.g2o", "report.html", "report.json"}

MINE = "merged_island_of_mine.yaml"


def sighting(o, observer: str, observed: str) -> dict:
    """As the fleet file has it."""
    plain = yaml.safe_load(known_to_bytes([o]))
    plain["observer"]["robot"], plain["observed"]["robot"] = observer, observed
    return plain


@pytest.fixture(scope="module")
def folder(small_case, strangers, tmp_path_factory) -> Path:
    """Ann saw Bob; it is said, too, that she saw Dan, whose map is of another building."""
    folder = tmp_path_factory.mktemp("fleet") / "three"
    maps = {"ann": small_case.ref, "bob": small_case.mov, "dan": strangers.mov}
    files = {name: data for robot, grid in maps.items() for name, data in map_to_bytes(grid, robot).items()}
    fleet = {
        "robots": {name: {"map": f"{name}.yaml"} for name in maps},
        "sightings": [
            sighting(small_case.observations[0], "ann", "bob"),
            sighting(strangers.observations[0], "ann", "dan"),
        ],
    }
    write_files({folder / name: data for name, data in files.items()})
    (folder / "fleet.yaml").write_text(yaml.safe_dump(fleet, sort_keys=False))
    return folder


@pytest.fixture(scope="module")
def left(folder: Path) -> Path:
    """What a merge of it leaves."""
    out = folder.parent / "out"
    write_files(
        {out / name: b"of an earlier merge" for name in ("merged_island2.yaml", "merged_island2.pgm")}
    )
    write_files({out / MINE: b"a person's own"})
    assert main(["fleet", str(folder), "--out", str(out), "--jobs", "1"]) == 1  # Dan is not placed
    return out


def test_the_merged_map_and_every_transform_are_left(left, small_case):
    assert {path.name for path in left.iterdir()} == ALL | {MINE}  # of an earlier merge there is no island
    assert read_map(left / "merged.yaml").resolution == small_case.ref.resolution
    told = yaml.safe_load((left / "transforms.yaml").read_text())
    assert set(told["merged"]["robots"]) == {"ann", "bob"}
    T, true = told["merged"]["robots"]["bob"]["T_root_robot"], small_case.truth.T_ref_mov
    assert (T["x"], T["y"]) == pytest.approx((true.x, true.y), abs=0.1)
    assert "--child-frame-id bob/map" in told["merged"]["robots"]["bob"]["publish"]


def test_the_report_says_who_is_placed_and_which_sighting_is_left_out(left):
    report = json.loads((left / "report.json").read_text())
    assert {name: robot["placed"] for name, robot in report["robots"].items()} == {
        "ann": True,
        "bob": True,
        "dan": False,
    }
    assert [seen["used"] for seen in report["sightings"]] == [True, False]
    assert report["robots"]["dan"]["reason"]
    page = (left / "report.html").read_text()
    assert "2 of 3 robots" in page
    assert "<script" not in page


def test_the_graph_of_another_tools_format_says_the_same(left):
    lines = (left / "graph.g2o").read_text().splitlines()
    names = dict(line.split()[1:] for line in lines if line.startswith("#"))
    told = yaml.safe_load((left / "transforms.yaml").read_text())["merged"]["robots"]
    for line in lines:
        kind, *fields = line.split()
        if kind == "VERTEX_SE2" and names[fields[0]] in told:
            T = told[names[fields[0]]]["T_root_robot"]
            assert [float(field) for field in fields[1:]] == [T["x"], T["y"], T["theta"]]
    (edge,) = (line.split()[3:] for line in lines if line.startswith("EDGE_SE2"))
    information = np.zeros((3, 3))
    information[np.triu_indices(3)] = [float(field) for field in edge[3:]]
    whole = information + np.triu(information, 1).T
    assert np.linalg.eigvalsh(whole).min() > 0


def test_the_same_fleet_leaves_the_same_files_with_processes(folder, left, tmp_path, capsys):
    assert main(["fleet", str(folder / "fleet.yaml"), "--out", str(tmp_path), "--jobs", "2", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["anchor"] == "ann"
    for name in ("merged.pgm", "transforms.yaml", "graph.g2o"):
        assert (tmp_path / name).read_bytes() == (left / name).read_bytes()


def test_what_is_wrong_is_one_line_and_nothing_is_written(folder, tmp_path, capsys):
    broken = tmp_path / "fleet.yaml"
    broken.write_text((folder / "fleet.yaml").read_text().replace("robot: dan", "robot: eve"))
    assert main(["fleet", str(broken), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert re.search(r"fleet\.yaml: sighting 2: observed\.robot is 'eve'", said)
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_fleets_own_folder_is_not_written_to(folder, capsys):
    before = {path.name for path in folder.iterdir()}
    assert main(["fleet", str(folder), "--out", str(folder)]) == 2
    assert "choose another --out" in capsys.readouterr().err
    assert {path.name for path in folder.iterdir()} == before


def test_a_pose_is_published_as_it_is():
    said = publish_command(Pose2(1.5, -2.0, 0.25), "ann/map", "bob/map")
    assert "--x 1.500000 --y -2.000000 --yaw 0.250000 --frame-id ann/map" in said


ODD = [
    "null",
    "1e3",
    "no",
    "2024-01-01",
    "r 2",
    "a: b",
    "#",
    "- a",
    "'",
    '"',
    "\\",
    "$(reboot)",
    "a; b",
    "<b>",
]
NAMES = st.lists(
    st.one_of(st.sampled_from(ODD), st.text(max_size=20).filter(is_name)), min_size=2, max_size=3, unique=True
)


@given(NAMES)
def test_whatever_robots_are_called_their_transforms_read_back_and_a_shell_runs_one_command(names):
    island = SimpleNamespace(root=names[0], poses={name: Pose2(1.0, 2.0, 0.5) for name in names})
    told = yaml.safe_load(transforms_yaml(SimpleNamespace(islands=(island,))))
    assert told["merged"]["root"] == names[0]
    assert list(told["merged"]["robots"]) == names
    frames = dict(zip(names, frame_names(names), strict=True))
    assert len(set(frames.values())) == len(names)
    for name, robot in told["merged"]["robots"].items():
        words = shlex.split(robot["publish"])
        assert len(words) == 14
        assert words[-3::2] == ["map" if name == names[0] else frames[names[0]], frames[name]]


def test_a_warning_names_the_robot_whose_map_is_odd_and_who_is_alone_is_said_to_be(tmp_path, capsys):
    empty = GridMap(np.full((40, 50), -1, dtype=np.int8), 0.05)
    files = {file: data for name in "ab" for file, data in map_to_bytes(empty, name).items()}
    write_files({tmp_path / name: data for name, data in files.items()})
    (tmp_path / "fleet.yaml").write_text("robots: {Ann: {map: a.yaml}, Bob: {map: b.yaml}}")
    assert main(["fleet", str(tmp_path), "--out", str(tmp_path / "out"), "--jobs", "1"]) == 1
    told = capsys.readouterr()
    assert "warning: Bob's map (b): no cell of it is known" in told.err
    assert re.search(r"Bob +alone .* –\n", told.out)


def test_a_sighting_that_cannot_be_says_why_with_the_robots_names(folder, tmp_path, capsys):
    plain = yaml.safe_load((folder / "fleet.yaml").read_text())
    plain["sightings"][0]["observer"]["pose"][0] = -30_000.0
    for robot in plain["robots"].values():
        robot["map"] = str(folder / robot["map"])
    (tmp_path / "fleet.yaml").write_text(yaml.safe_dump(plain, sort_keys=False))
    main(["fleet", str(tmp_path), "--out", str(tmp_path / "out"), "--jobs", "1"])
    told = capsys.readouterr().out
    assert "sighting 1 is left out: the observation puts ann at (-30000, " in told
    assert "robot 1" not in told
    assert "robot 2" not in told


def test_what_is_known_and_left_out_says_why(folder, tmp_path, capsys):
    plain = yaml.safe_load((folder / "fleet.yaml").read_text())
    plain["sightings"] = []
    plain["known"] = [{"of": "dan", "in": "ann", "near": {"in": [0.0, 0.0], "of": [1e6, 0.0]}}]
    for robot in plain["robots"].values():
        robot["map"] = str(folder / robot["map"])
    (tmp_path / "fleet.yaml").write_text(yaml.safe_dump(plain, sort_keys=False))
    main(["fleet", str(tmp_path), "--out", str(tmp_path / "out"), "--jobs", "1"])
    told = capsys.readouterr().out
    assert "what is known of dan in ann is left out: near: a place lies at (1e+06, 0) m" in told
