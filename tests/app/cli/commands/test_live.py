"""``mapmeld live``: from simulated robots on DDS to one map of all, each in a process of its own."""

from __future__ import annotations

import signal
import subprocess
import sys

import numpy as np
import pytest
import yaml
from dds_domains import new_domain
from explorers import exploration
from repository import ROOT

from algorithms.common.pose import Pose2, pose_error
from algorithms.files.fleet_file import read_fleet
from algorithms.files.map_file import read_map
from algorithms.simulator.fleets.exploration import SlamCorrection
from app.cli.main import main

DDS = ("--interface", "lo", "--domain", str(new_domain()))


def begun(*words):
    """The command, as a process whose lines can be read."""
    return subprocess.Popen(
        [sys.executable, "-m", "mapmeld", *words, *DDS], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )


def until(process, *awaited):
    """Read its lines until each of these was in one; all of them."""
    lines, left = [], set(awaited)
    for line in process.stdout:
        lines.append(line)
        left -= {each for each in left if each in line}
        if not left:
            break
    assert not left, "".join(lines)
    return "".join(lines)


def test_robots_that_explore_and_meet_are_merged_without_a_word_from_anybody(tmp_path):
    file = str(tmp_path / "fleet.yaml")
    home = "--building", "home", "--seed", "5", "--speed", "2"
    with begun("simulate", "--ros2", *home, "--fleet", file, "--correct", "r2@14:3") as robots:
        try:
            until(robots, "waiting for somebody who listens")
            with begun("live", "--list") as listed:
                assert "/r1/map  nav_msgs/OccupancyGrid" in listed.stdout.read()
                assert listed.wait() == 0
            with begun(
                "live", file, "--publish", "--out", str(tmp_path / "out"), "--save-every", "2"
            ) as live:
                try:
                    said = until(live, "r2: placed", "r3: placed", "r2: corrected")
                    until(robots, "all have driven")
                    live.send_signal(signal.SIGINT)
                    assert "written to" in live.stdout.read()
                    assert live.wait() == 0
                finally:
                    live.kill()
            with begun("live", file, "--out", str(tmp_path / "out"), "--resume") as again:
                try:
                    until(again, "r2: placed", "r3: placed")  # though nobody meets any more
                finally:
                    again.kill()
        finally:
            robots.kill()
    drives = exploration(SlamCorrection("r2", 28, 3.0))
    written = yaml.safe_load((tmp_path / "out" / "transforms.yaml").read_text())
    assert set(written["merged"]["robots"]) == {"r1", "r2", "r3"}, said
    for name, told in written["merged"]["robots"].items():
        T = Pose2(*told["T_root_robot"].values())
        end = drives.scans
        off = pose_error(T, drives.true_transform(name, end), drives.pose(name, end).xy)
        assert off[0] < 0.3, (name, said)
        assert off[1] < np.radians(1.5), (name, said)
    again = read_fleet(tmp_path / "out")
    assert set(again.maps) == {"r1", "r2", "r3"}
    merged = read_map(tmp_path / "out" / "merged.yaml")  # as Nav2 would
    assert np.count_nonzero(merged.occupied) > np.count_nonzero(drives.grid("r1", drives.scans).occupied)


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--domain", "500"], "DDS domain is 500"),
        (["--save-every", "3"], "--out DIR"),
        (["--save-every", "-1", "--out", "out"], "above 0"),
        (["--sightings", "nowhere"], "is no folder"),
        (["--out", "fleet.yaml"], "is a file"),
        (["--resume"], "--out DIR"),
        (["--out", "."], "holds the fleet's own files"),
        (["--resume", "--out", "new"], "no such file"),
    ],
)
def test_a_mistake_is_told_before_anything_is_opened(tmp_path, flags, said, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fleet.yaml").write_text("robots:\n  r1: {topic: /r1/map}\n  r2: {topic: /r2/map}\n")
    assert main(["live", "fleet.yaml", "--interface", "lo", "--domain", str(new_domain()), *flags]) == 2
    assert said in capsys.readouterr().err


def test_without_a_fleet_and_where_no_map_is_published_it_is_told(capsys):
    assert main(["live"]) == 2
    assert "--list tells the topics" in capsys.readouterr().err
    assert main(["live", "--list", "--interface", "lo", "--domain", str(new_domain())]) == 1
    assert "no maps among 0 topics" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("library", "more", "said"),
    [
        ("cyclonedds.core", "", "pip install 'mapmeld[ros2]'"),
        ("roslibpy", ", rosbridge: 'ws://robot:9090'", "pip install 'mapmeld[rosbridge]'"),
    ],
)
def test_without_its_library_it_says_what_to_install(tmp_path, library, more, said, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    robots = "".join(f"  r{n}: {{topic: /r{n}/map{more}}}\n" for n in (1, 2))
    (tmp_path / "fleet.yaml").write_text(f"robots:\n{robots}")
    assert main(["live", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err


def test_a_domain_of_the_environment_that_is_none_is_told(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "home")
    (tmp_path / "fleet.yaml").write_text("robots:\n  r1: {topic: /r1/map}\n  r2: {topic: /r2/map}\n")
    assert main(["live", str(tmp_path), "--interface", "lo"]) == 2
    assert "ROS_DOMAIN_ID is 'home'" in capsys.readouterr().err
