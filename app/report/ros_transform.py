"""A transform as a robot takes it: the file transform.yaml, and the command that publishes it in ROS 2."""

from __future__ import annotations

import shlex

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.files.yaml_fields import number_text, quoted
from algorithms.methods.merge_result import MergeResult


def frames_of(names: RobotNames) -> tuple[str, str]:
    """What ROS calls the frames of the two maps."""
    return ("map1", "map2") if names == UNNAMED else (f"{names.ref}/map", f"{names.mov}/map")


def publish_command(T: Pose2, parent: str, child: str) -> str:
    """The command that tells ROS 2 where a frame lies in another; to a shell a name is a name."""
    return (
        f"ros2 run tf2_ros static_transform_publisher --x {T.x:.6f} --y {T.y:.6f} --yaw {T.theta:.6f} "
        f"--frame-id {shlex.quote(parent)} --child-frame-id {shlex.quote(child)}"
    )


def transform_yaml(result: MergeResult, names: RobotNames = UNNAMED) -> bytes:
    """The content of transform.yaml; T is written so that it reads back to the same numbers."""
    T = result.T_ref_mov
    x, y, theta = (number_text(value) for value in (T.x, T.y, T.theta))
    accepted = "true" if result.verdict.accepted else "false"
    frames = frames_of(names)
    points = names.told("Takes points of map 2's frame to map 1's; m, m, rad.")
    parent = names.told("Publishes it in ROS 2; map 1's frame is the parent:")
    return (
        f"# {points} The robots' maps are the frames {', '.join(frames)}.\n"
        f"T_ref_mov: {{x: {x}, y: {y}, theta: {theta}}}\n"
        f"method: {quoted(result.method)}\n"
        f"accepted: {accepted}\n"
        f"outcome: {quoted(result.verdict.outcome.value)}\n"
        f"# {parent}\n"
        f"publish: {quoted(publish_command(T, *frames))}\n"
    ).encode()
