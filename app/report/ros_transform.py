"""A transform as a robot takes it: the file transform.yaml, and the command that publishes it in ROS 2."""

from __future__ import annotations

from algorithms.files.yaml_fields import number_text, quoted
from algorithms.methods.merge_result import MergeResult


def publish_command(result: MergeResult) -> str:
    """The command that tells ROS 2 where map 2's frame lies in map 1's."""
    T = result.T_ref_mov
    return (
        f"ros2 run tf2_ros static_transform_publisher --x {T.x:.6f} --y {T.y:.6f} --yaw {T.theta:.6f} "
        "--frame-id map1 --child-frame-id map2"
    )


def transform_yaml(result: MergeResult) -> bytes:
    """The content of transform.yaml; T is written so that it reads back to the same numbers."""
    T = result.T_ref_mov
    x, y, theta = (number_text(value) for value in (T.x, T.y, T.theta))
    accepted = "true" if result.verdict.accepted else "false"
    return (
        "# Takes points of map 2's frame to map 1's; m, m, rad. The robots' maps are the frames map1, map2.\n"
        f"T_ref_mov: {{x: {x}, y: {y}, theta: {theta}}}\n"
        f"method: {quoted(result.method)}\n"
        f"accepted: {accepted}\n"
        f"outcome: {quoted(result.verdict.outcome.value)}\n"
        "# Publishes it in ROS 2; map 1's frame is the parent:\n"
        f'publish: "{publish_command(result)}"\n'
    ).encode()
