"""``mapmeld observe``: what it finds, what it refuses, what it says and with which exit status."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from commandline import usage_error
from PIL import Image

from algorithms.common.pose import Pose2
from algorithms.files.camera_file import camera_to_bytes
from algorithms.files.camera_picture import picture_to_jpeg
from algorithms.files.encounter_table import EncounterRow, encounters_to_bytes
from algorithms.files.map_file import map_to_bytes
from algorithms.files.observation_file import read_observations
from algorithms.files.scan_file import scan_to_bytes
from algorithms.maps.grid_map import FREE, OCCUPIED, GridMap
from algorithms.simulator.views.robot_views import draw_view
from app.cli.main import main

STOOD = ("--observer-pose=1.0,2.0,0.5", "--observed-pose=3.0,4.0")
TAG = ("--tags", "36h11", "--tag-size", "0.26")


@cache
def view(hardship=None, robot=True):
    """A robot in the open, or what a hardship makes of it."""
    if hardship is None:
        return draw_view(4, "home", robot=robot, distance=(2.0, 3.5))
    return draw_view(50, "office", robot=robot, hardship=hardship)


@pytest.fixture
def seen(tmp_path):
    """A folder with an image, a scan and a calibration."""
    return written(tmp_path, view())


def written(folder, one):
    (folder / "camera.yaml").write_bytes(camera_to_bytes(one.camera))
    (folder / "scan.yaml").write_bytes(scan_to_bytes(one.scan))
    (folder / "seen.jpg").write_bytes(picture_to_jpeg(one.image))
    return folder


def words(folder, *more, out="observation.yaml"):
    files = {"image": "seen.jpg", "camera": "camera.yaml", "scan": "scan.yaml"}
    named = [f"--{key}={folder / name}" for key, name in files.items()]
    return ["observe", *named, *STOOD, f"--out={folder / out}", *more]


def test_a_robot_is_found_and_the_observation_says_where(seen, capsys):
    assert main(words(seen)) == 0
    (made,) = read_observations(seen / "observation.yaml")
    (robot,) = view().robots
    assert abs(made.range - robot.range) < 4 * made.sigma_range
    assert abs(made.bearing - robot.bearing) < 4 * made.sigma_bearing
    assert made.sigma_range < 0.05
    assert (made.observer, made.observed_x, made.observed_y) == (Pose2(1.0, 2.0, 0.5), 3.0, 4.0)
    assert made.observed_heading is None
    said = capsys.readouterr()
    assert said.out.startswith(f"The robot is {made.range:.3f} m")
    assert said.err == ""


def test_json_holds_every_box_and_the_measurement(seen, capsys):
    assert main(words(seen, "--json")) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["found"]
    chosen = told["boxes"][told["chosen"] - 1]
    assert chosen["measurement"] == told["measurement"]
    left, top, right, bottom = chosen["box"]
    u0, v0, u1, v1 = view().robots[0].box
    assert abs(left + right - u0 - u1) < 0.5 * (u1 - u0)
    assert abs(top + bottom - v0 - v1) < 0.5 * (v1 - v0)


def test_the_picture_shows_the_image_with_the_laser_below(seen):
    assert main(words(seen, f"--picture={seen / 'drawn.png'}")) == 0
    with Image.open(seen / "drawn.png") as drawn:
        width, height = drawn.size
    assert width == 960
    assert height > 720


@pytest.mark.parametrize("hardship", ["poster", "night"])
def test_a_poster_and_the_dark_give_no_wrong_sighting(tmp_path, capsys, hardship):
    folder = written(tmp_path, view(hardship))
    status = main(words(folder))
    robots = view(hardship).robots
    if status == 0:
        (made,) = read_observations(folder / "observation.yaml")
        assert min(abs(made.range - one.range) for one in robots) < 4 * made.sigma_range
    else:
        assert status == 1
        assert not (folder / "observation.yaml").exists()
        assert capsys.readouterr().out.startswith("No sighting: ")


def test_nothing_in_view_ends_with_1_and_leaves_no_file(tmp_path, capsys):
    folder = written(tmp_path, view(robot=False))
    assert main(words(folder)) == 1
    assert not (folder / "observation.yaml").exists()
    assert "No sighting: " in capsys.readouterr().out


def test_tags_are_another_detector_and_their_size_spares_the_scan(seen):
    assert main(words(seen, "--tags=36h11")) == 0
    (with_scan,) = read_observations(seen / "observation.yaml")
    alone = [word for word in words(seen, *TAG) if "--scan" not in word]
    assert main(alone) == 0
    (by_size,) = read_observations(seen / "observation.yaml")
    assert by_size.range == pytest.approx(with_scan.range, abs=4 * by_size.sigma_range)
    assert by_size.sigma_range > with_scan.sigma_range


def test_without_calibration_pixels_are_counted(seen):
    named = [word for word in words(seen) if not word.startswith("--camera=")]
    assert main([*named, f"--field-of-view-deg={view().camera.degrees_wide():.1f}"]) == 0
    assert read_observations(seen / "observation.yaml")


def with_wall(folder, name):
    """A map with a wall one metre ahead of who stands at (−1, 0)."""
    cells = np.full((200, 200), FREE, np.int8)
    cells[:, 100:104] = OCCUPIED
    for file, data in map_to_bytes(GridMap(cells, 0.05, Pose2(-5.0, -5.0, 0.0), name), name).items():
        (folder / file).write_bytes(data)


def test_a_map_whose_wall_is_before_the_robot_denies_it(seen, capsys):
    with_wall(seen, "wall")
    apart = [word for word in words(seen, f"--map={seen / 'wall.yaml'}") if "observer-pose" not in word]
    assert main([*apart, "--observer-pose=-1.0,0.0,0.0"]) == 1
    assert "the map has a wall" in capsys.readouterr().out


def test_the_map_in_a_folder_of_encounters_counts(seen, capsys):
    rows = [EncounterRow("seen.jpg", "scan.yaml", Pose2(-1.0, 0.0, 0.0), 3.0, 4.0)]
    (seen / "encounters.csv").write_bytes(encounters_to_bytes(rows))
    with_wall(seen, "map1")
    assert main(["observe", str(seen), f"--out={seen / 'observation.yaml'}"]) == 1
    assert "the map has a wall" in capsys.readouterr().out
    table = str(seen / "encounters.csv")  # which names no map
    assert main(["observe", table, f"--out={seen / 'observation.yaml'}"]) == 0


def test_a_table_gives_a_sighting_for_every_line(seen, capsys):
    rows = [
        EncounterRow("seen.jpg", "scan.yaml", Pose2(1.0, 2.0, 0.5), 3.0, 4.0, 0.1),
        EncounterRow("seen.jpg", "scan.yaml", Pose2(1.5, 2.0, 0.5), 3.5, 4.0),
    ]
    (seen / "encounters.csv").write_bytes(encounters_to_bytes(rows))
    for named in (seen, seen / "encounters.csv"):
        assert main(["observe", str(named), f"--out={seen / 'observation.yaml'}"]) == 0
        first, second = read_observations(seen / "observation.yaml")
        assert (first.observed_heading, second.observed_heading) == (0.1, None)
        assert first.range == second.range
        assert second.observer.x == 1.5
    assert "2 sightings" in capsys.readouterr().out


def test_another_robot_size_is_another_centre(seen):
    centres = []
    for size in ("--robot-size=0.46,0.40", "--robot-radius=0.21"):
        assert main(words(seen, size)) == 0
        centres.append(read_observations(seen / "observation.yaml")[0].range)
    assert 0 < abs(centres[0] - centres[1]) < 0.1


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--box=40"], "--box is 40"),
        (["--tag-size=0.1"], "--tag-size is given without --tags"),
        (["--tags=99h1"], "no family of tags"),
        (["--robot-size=0,1"], "robot's size"),
        (["--robot-radius=0.2", "--robot-size=1,1"], "exclude one another"),
        (["--least-probability=7"], "least probability"),
        (["--field-of-view-deg=60"], "exclude one another"),
        (["--picture=seen.txt"], "let it end in .png"),
        (["--map=nowhere.yaml"], "nowhere.yaml"),
        (["--model=nowhere.npz"], "nowhere.npz"),
    ],
)
def test_what_cannot_be_is_one_line(seen, capsys, more, said):
    assert main(words(seen, *more)) == 2
    told = capsys.readouterr().err
    assert said in told
    assert len(told.splitlines()) == 1
    assert not (seen / "observation.yaml").exists()


def test_a_calibration_of_another_size_is_told(seen, capsys):
    other = replace(view().camera, width=320, height=240, centre=(160.0, 120.0))
    (seen / "camera.yaml").write_bytes(camera_to_bytes(other))
    assert main(words(seen)) == 2
    assert "is 640 × 480 pixels" in capsys.readouterr().err


@pytest.mark.parametrize("left_out", ["image", "scan", "observer-pose", "observed-pose"])
def test_what_is_missing_is_named(seen, capsys, left_out):
    assert usage_error(*(word for word in words(seen) if f"--{left_out}" not in word)) == 2
    assert f"--{left_out}" in capsys.readouterr().err


def test_a_table_and_an_image_exclude_one_another(seen, capsys):
    assert usage_error(*words(seen), str(seen)) == 2
    assert "names its own" in capsys.readouterr().err


def test_an_image_that_is_torn_is_told(seen, capsys):
    (seen / "seen.jpg").write_bytes((seen / "seen.jpg").read_bytes()[:5000])
    assert main(words(seen)) == 2
    assert "seen.jpg" in capsys.readouterr().err
