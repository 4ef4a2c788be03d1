"""``mapmeld simulate``: what it records can be read, and what cannot be is refused."""

from __future__ import annotations

import numpy as np
import pytest
from explorers import exploration

from algorithms.files.bags.bag_path import BagPath
from algorithms.files.bags.bag_reader import open_bag
from algorithms.files.bags.frame_tree import frames_around
from algorithms.files.bags.map_messages import read_bag_map
from app.cli.main import main
from app.live.bag_writing import BagRecorder
from app.live.live_fleet_file import read_live_fleet

HOME = ("--building", "home", "--seed", "5")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("simulated")
    bag = folder / "bag"
    assert main(["simulate", "--bag", str(bag), *HOME, "--fleet", str(folder / "fleet.yaml")]) == 0
    return bag


def test_the_maps_of_a_recording_are_those_that_the_robots_made(recorded):
    drives = exploration()
    for name in drives.names:
        grid = read_bag_map(BagPath(recorded, f"/{name}/map"))
        expected = drives.grid(name, drives.scans)
        np.testing.assert_array_equal(grid.cells, expected.cells)
        assert (grid.resolution, grid.origin) == (expected.resolution, expected.origin)


def test_its_transforms_say_where_the_robots_are(recorded):
    drives = exploration()
    with open_bag(recorded) as bag:
        topics = {topic.name for topic in bag.topics}
        at = bag.begin + 10_000_000_000  # a scan is half a second
        pose = frames_around(bag, at).pose("r2/map", "r2/base_link", at)
    np.testing.assert_allclose(pose.xy, drives.pose("r2", 20).xy, atol=1e-6)
    assert {"/r1/scan", "/r1/sees/r2", "/r3/map", "/tf"} <= topics


def test_its_fleet_file_is_one_that_live_reads(recorded):
    fleet = read_live_fleet(recorded.parent)
    assert fleet.robots["r2"].topic == "/r2/map"
    assert fleet.robots["r2"].sees["r1"] == "/r2/sees/r1"


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--bag", "{here}"], "is there already"),
        (["--bag", "{here}/new", "--speed", "0"], "--speed is 0"),
        (["--bag", "{here}/new", "--correct", "r9@3:1"], "names 'r9'"),
    ],
)
def test_a_mistake_is_told_in_a_line_and_leaves_nothing(recorded, flags, said, capsys):
    here = recorded.parent
    assert main(["simulate", *HOME, *(flag.format(here=here) for flag in flags)]) == 2
    assert said in capsys.readouterr().err
    assert not (here / "new").exists()


def test_who_interrupts_a_recording_leaves_none(tmp_path, monkeypatch, capsys):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(BagRecorder, "write", interrupted)
    assert main(["simulate", "--bag", str(tmp_path / "bag"), *HOME]) == 130
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("flags", [[], ["--ros2", "--bag", "x"], ["--ros2", "--correct", "r1"]])
def test_flags_that_do_not_go_together_are_refused(flags, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["simulate", *flags])
    assert ended.value.code == 2
