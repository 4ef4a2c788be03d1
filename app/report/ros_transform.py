"""Transforms as a robot takes them: the file transform.yaml, and the commands that publish them in ROS 2."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from algorithms.common.pose import Pose2
from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.files.yaml_fields import number_text, quoted
from algorithms.methods.merge_result import MergeResult
from app.report.export_frame import AS_MERGED, ExportFrame

CHOSEN = "map"  # what ROS calls a frame that is neither robot's: the one that Nav2 plans in


def frames_of(names: RobotNames) -> tuple[str, str]:
    """What ROS calls the frames of the two maps."""
    if names == UNNAMED:
        return "map1", "map2"
    ref, mov = frame_names((names.ref, names.mov))
    return ref, mov


def frame_names(robots: Sequence[str]) -> tuple[str, ...]:
    """What ROS calls the frame of each robot's map: in small letters, where that keeps them apart."""
    usual = tuple("_".join(name.lower().split()) for name in robots)
    return tuple(f"{name}/map" for name in (usual if len(set(usual)) == len(usual) else robots))


def publish_command(T: Pose2, parent: str, child: str) -> str:
    """The command that tells ROS 2 where a frame lies in another; to a shell a name is a name."""
    return (
        f"ros2 run tf2_ros static_transform_publisher --x {T.x:.6f} --y {T.y:.6f} --yaw {T.theta:.6f} "
        f"--frame-id {shlex.quote(parent)} --child-frame-id {shlex.quote(child)}"
    )


def parent_of(frame: ExportFrame, names: RobotNames) -> str:
    """What ROS calls the frame that the merged map is in."""
    ref, mov = frames_of(names)
    return {"ref": ref, "mov": mov}.get(str(frame.frame), CHOSEN)


def publish_commands(T_ref_mov: Pose2, names: RobotNames, frame: ExportFrame = AS_MERGED) -> list[str]:
    """The commands that hang the frames of both maps below that of the merged one; it may be one of them."""
    parent, T_frame_ref = parent_of(frame, names), frame.in_ref(T_ref_mov).inverse()
    below = zip(frames_of(names), (T_frame_ref, T_frame_ref @ T_ref_mov), strict=True)
    return [publish_command(T, parent, child) for child, T in below if child != parent]


def transform_yaml(result: MergeResult, names: RobotNames = UNNAMED, frame: ExportFrame = AS_MERGED) -> bytes:
    """The content of transform.yaml; the numbers read back as they are."""
    T, told = result.T_ref_mov, names.told
    points = told("Takes points of map 2's frame to map 1's; m, m, rad.")
    where = f"T_ref_frame: {_pose(frame.in_ref(T))}  # {told('where it lies in map 1')}"
    lines = [
        f"# {points} The robots' maps are the frames {', '.join(frames_of(names))}.",
        f"T_ref_mov: {_pose(T)}",
        f"method: {quoted(result.method)}",
        f"accepted: {'true' if result.verdict.accepted else 'false'}",
        f"outcome: {quoted(result.verdict.outcome.value)}",
        f"frame: {quoted(parent_of(frame, names))}  # of the merged map",
        *([] if frame.frame == "ref" else [where]),
        f"# Publishes it in ROS 2; {told(frame.said)} is the parent:",
    ]
    first, *more = (quoted(command) for command in publish_commands(T, names, frame))
    lines += [f"publish: {first}"] if not more else ["publish:", *(f"  - {each}" for each in (first, *more))]
    return ("\n".join(lines) + "\n").encode()


def _pose(T: Pose2) -> str:
    x, y, theta = (number_text(value) for value in (T.x, T.y, T.theta))
    return f"{{x: {x}, y: {y}, theta: {theta}}}"
