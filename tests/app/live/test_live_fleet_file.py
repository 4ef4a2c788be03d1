"""The fleet file of robots that run."""

from __future__ import annotations

import pytest

from algorithms.common.errors import InputFileError
from app.live.live_fleet_file import read_live_fleet

GOOD = "robots:\n  r1: {topic: /r1/map}\n  r2: {topic: /r2/map}\n"


def read(folder, text):
    (folder / "fleet.yaml").write_text(text)
    return read_live_fleet(folder)


def test_what_is_left_out_is_the_usual(tmp_path):
    fleet = read(tmp_path, GOOD)
    assert fleet.anchor == "r1"
    robot = fleet.robots["r2"]
    assert (robot.topic, robot.base, robot.tf, robot.bridge, dict(robot.sees)) == (
        "/r2/map",
        "",
        "/tf",
        "",
        {},
    )


def test_all_that_can_be_said_of_a_robot_is_read(tmp_path):
    text = GOOD.replace(
        "r1: {topic: /r1/map}",
        "r1: {topic: /map, base: base, tf: /r1/tf, sees: {r2: /it}, rosbridge: 'ws://h:9090'}",
    )
    robot = read(tmp_path, f"anchor: r2\n{text}").robots["r1"]
    assert (robot.topic, robot.base, robot.tf, robot.bridge, dict(robot.sees)) == (
        "/map",
        "base",
        "/r1/tf",
        "ws://h:9090",
        {"r2": "/it"},
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("robots:\n  r1: {topic: /map}\n", "names 1 robots"),
        (GOOD.replace("topic: /r2/map", "topc: /r2/map"), "did you mean topic"),
        (GOOD.replace("/r2/map", "''"), "r2.topic is"),
        (GOOD.replace("/r2/map", "/a map"), "no name that ROS knows"),
        (GOOD.replace("/r2/map", "/" + "m" * 300), "no name that ROS knows"),
        (GOOD.replace("topic: /r2/map", "topic: /r2/map, sees: {r3: /it}"), "none of the other robots"),
        (GOOD.replace("topic: /r2/map", "topic: /r2/map, sees: {r2: /it}"), "none of the other robots"),
        (GOOD.replace("topic: /r2/map", "map: none.yaml"), "no such file"),
        ("anchor: r9\n" + GOOD, "r9"),
        ("anchor: r9", "robots"),
    ],
)
def test_a_mistake_is_told_in_a_line_that_names_the_file(tmp_path, text, said):
    with pytest.raises(InputFileError, match=said) as caught:
        read(tmp_path, text)
    assert "fleet.yaml" in str(caught.value) or "none.yaml" in str(caught.value)
