"""What publishes the robots' frames: one parent each, in the frame that the merged map is in."""

import shlex

import pytest
import yaml

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from app.report.export_frame import ExportFrame
from app.report.ros_transform import frame_names, publish_commands, transform_yaml

BOB_AND_ALICE = RobotNames("Bob", "Alice")
CHOSEN = ExportFrame(Pose2(1.0, -2.0, 0.5))


def published(command):
    """Parent, child, and the transform of the child in the parent, of a command."""
    words = shlex.split(command)
    given = dict(zip(words[4::2], words[5::2], strict=True))
    T = Pose2(*(float(given[name]) for name in ("--x", "--y", "--yaw")))
    return given["--frame-id"], given["--child-frame-id"], T.array()


def test_transform_yaml_reads_back_to_the_same_transform(result):
    told = yaml.safe_load(transform_yaml(result))
    assert Pose2(**told["T_ref_mov"]) == result.T_ref_mov
    assert told["accepted"] is True


def test_the_publisher_makes_map_1_the_parent_of_map_2(result):
    words = yaml.safe_load(transform_yaml(result))["publish"].split()
    assert words[:4] == ["ros2", "run", "tf2_ros", "static_transform_publisher"]
    given = dict(zip(words[4::2], words[5::2], strict=True))
    assert (given.pop("--frame-id"), given.pop("--child-frame-id")) == ("map1", "map2")
    T = result.T_ref_mov
    assert {name: float(value) for name, value in given.items()} == pytest.approx(
        {"--x": T.x, "--y": T.y, "--yaw": T.theta}, abs=1e-6
    )


def test_in_map_2s_frame_map_1_is_the_child(result):
    frame = ExportFrame("mov")
    ((parent, child, T),) = map(published, publish_commands(result.T_ref_mov, UNNAMED, frame))
    assert (parent, child) == ("map2", "map1")
    assert pytest.approx(result.T_ref_mov.inverse().array(), abs=1e-6) == T
    told = yaml.safe_load(transform_yaml(result, frame=frame))
    assert told["frame"] == "map2"
    assert Pose2(**told["T_ref_mov"]) == Pose2(**told["T_ref_frame"]) == result.T_ref_mov


def test_in_a_chosen_frame_both_maps_are_children_of_it_and_lie_to_each_other_as_before(result):
    told = yaml.safe_load(transform_yaml(result, BOB_AND_ALICE, CHOSEN))
    ref, mov = map(published, told["publish"])
    assert [each[:2] for each in (ref, mov)] == [("map", "bob/map"), ("map", "alice/map")]
    assert Pose2(**told["T_ref_frame"]) == CHOSEN.frame
    again = Pose2(*ref[2]).inverse() @ Pose2(*mov[2])
    assert again.array() == pytest.approx(result.T_ref_mov.array(), abs=1e-5)
    assert Pose2(*ref[2]).apply(CHOSEN.frame.xy) == pytest.approx((0, 0), abs=1e-5)


@pytest.mark.parametrize(
    ("robots", "frames"),
    [
        (("Bob", "Alice"), ("bob/map", "alice/map")),
        (("Robot  2", "r1"), ("robot_2/map", "r1/map")),
        (("Bob", "bob"), ("Bob/map", "bob/map")),
    ],
)
def test_frames_are_named_after_the_robots_in_small_letters_unless_two_would_be_one(robots, frames):
    assert frame_names(robots) == frames
