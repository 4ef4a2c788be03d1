"""``mapmeld bag``, and recordings wherever the command line takes a map or a sighting."""

from __future__ import annotations

import json

import numpy as np
import pytest
from bags import (
    Recorded,
    camera_message,
    grid_message,
    image_message,
    robot_frames,
    scan_message,
    sensor_frames,
    transform_message,
    write_bag,
)
from commandline import usage_error
from drawn import drawn_map

from algorithms.common.pose import Pose2, pose_error
from algorithms.files.case_folder import read_case
from algorithms.files.map_file import read_map
from algorithms.files.observation_file import read_observations
from algorithms.simulator.views.robot_views import draw_view
from app.cli.main import main
from app.system.data_paths import samples

FLAT = drawn_map(Pose2(), resolution=0.1)
OBSERVER, OBSERVED = Pose2(1.0, 2.0, 0.5), Pose2(3.0, 4.0, -1.0)


def test_info_tells_topics_times_frames_and_uses(tmp_path, capsys):
    told = [
        transform_message("map", "odom", 0.0, (0, 0, 0)),
        transform_message("odom", "base_link", 0.5, (0, 0, 0)),
        grid_message(FLAT, 1.0, "/robot1/map"),
        grid_message(FLAT, 4.0, "/robot1/map"),
        Recorded("/chatter", "std_msgs/msg/String", 5.0, {}),
    ]
    path = write_bag(tmp_path, "robot1", "ros1", told)
    assert main(["bag", "info", str(path)]) == 0
    said = capsys.readouterr().out
    assert "a ROS 1 bag, 5 messages, 5.0 s from 2023-11-14 22:13:20 UTC on" in said
    grid = next(line for line in said.splitlines() if "/robot1/map" in line)
    assert "1.0 s  4.0 s" in grid
    assert f"map: {FLAT.width} × {FLAT.height} cells of 0.1 m, frame map" in grid
    assert "of no use here: /chatter" in said
    assert "frames: map\n" in said
    assert main(["bag", "info", str(path), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert {each["name"]: each["messages"] for each in data["topics"]}["/tf"] == 2
    assert data["frames"] == {"map": None, "odom": "map", "base_link": "odom"}


def test_map_writes_what_nav2_loads(tmp_path, capsys):
    path = write_bag(tmp_path, "robot1", "mcap", [grid_message(FLAT, 1.0)])
    assert main(["bag", "map", f"{path}#/map@1", "--out", str(tmp_path / "map1.yaml")]) == 0
    assert np.array_equal(read_map(tmp_path / "map1.yaml").cells, FLAT.cells)
    assert f"{FLAT.width} × {FLAT.height} cells of 0.1 m" in capsys.readouterr().out


def test_mistakes_are_told_in_a_line(tmp_path, capsys):
    (tmp_path / "notes.bag").write_text("no bag")
    for name, found in (("missing.bag", "no such file"), ("notes.bag", "is no recording of ROS")):
        assert main(["bag", "info", str(tmp_path / name)]) == 2
        assert found in capsys.readouterr().err
    path = write_bag(tmp_path, "robot1", "mcap", [grid_message(FLAT, 1.0)])
    for words, found in ((["map", path], "--out is missing"), (["info", f"{path}@1"], "leave out")):
        assert usage_error("bag", *words) == 2
        assert found in capsys.readouterr().err


def test_two_recordings_merge_to_the_answer_of_their_files(tmp_path):
    folder = samples()["apartment_r2_r1"]
    case = read_case(folder)
    first = write_bag(tmp_path, "robot1", "ros1-lz4", [grid_message(case.ref, 3.0)])
    second = write_bag(tmp_path, "robot2", "db3", [grid_message(case.mov, 3.0, "/robot2/map", "robot2/map")])
    seen = ["--observation", str(folder / "observation.yaml")]
    answers = []
    for maps in (
        (f"{first}", f"{second}#/robot2/map"),
        (folder / "map1.yaml", folder / "map2.yaml"),
    ):
        out = tmp_path / f"out{len(answers)}"
        assert main(["merge", *map(str, maps), *seen, "--out", str(out)]) == 0
        answers.append(json.loads((out / "report.json").read_text())["T_ref_mov"])
    a, b = (Pose2(each["x"], each["y"], each["theta"]) for each in answers)
    distance, angle = pose_error(a, b, np.zeros(2))
    assert distance < 0.001
    assert np.degrees(angle) < 0.001


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """Robot 1's recording with what it saw, and robot 2's with where it was."""
    folder, at = tmp_path_factory.mktemp("recordings"), 9.0
    one = draw_view(4, "home", robot=True, distance=(2.0, 3.5))
    first = [
        *sensor_frames(one.camera.mounting, one.scan.mounting),
        *robot_frames(OBSERVER, at),
        image_message(one.image, at),
        camera_message(one.camera, at),
        scan_message(one.scan, at),
    ]
    # the same clock, another beginning
    second = robot_frames(OBSERVED, at + 1)
    return one, write_bag(folder, "robot1", "mcap", first), write_bag(folder, "robot2", "ros1", second)


def test_a_sighting_comes_out_of_two_recordings(recordings, tmp_path, capsys):
    one, first, second = recordings
    out = tmp_path / "observation.yaml"
    words = ["observe", "--bag", str(first), "--at", "9", "--out", str(out)]
    assert main([*words, "--observed-bag", str(second), "--picture", str(tmp_path / "seen.png")]) == 0
    (made,) = read_observations(out)
    (robot,) = one.robots
    assert abs(made.range - robot.range) < 4 * made.sigma_range
    assert abs(made.bearing - robot.bearing) < 4 * made.sigma_bearing
    assert pose_error(made.observer, OBSERVER, np.zeros(2)) == pytest.approx((0, 0), abs=1e-6)
    assert (made.observed_x, made.observed_y) == pytest.approx((OBSERVED.x, OBSERVED.y), abs=1e-6)
    assert (tmp_path / "seen.png").exists()
    assert "without robot 1's map" in capsys.readouterr().err  # none was recorded
    for more, found in (
        ([], "where robot 2 was is missing"),
        (["--observed-bag", str(second), "--frames", "map,base"], "no frame base"),
        (["--observed-frames", "robot2/map,robot2/base_link"], "no frame robot2/map"),
        (["--observed-bag", str(tmp_path)], "is no recording"),
    ):
        assert main([*words, *more]) == 2
        assert found in capsys.readouterr().err
    assert main(["observe", "--bag", str(first), "--out", str(out), "--observed-pose", "1,2"]) == 2
    assert "--at is missing" in capsys.readouterr().err
