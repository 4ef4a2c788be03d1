"""ROS messages from their bytes: the types that are read, by definitions of ours."""

from __future__ import annotations

from typing import Any

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from algorithms.common.errors import InputFileError

GRID = "nav_msgs/msg/OccupancyGrid"
GRID_UPDATE = "map_msgs/msg/OccupancyGridUpdate"
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
SCAN = "sensor_msgs/msg/LaserScan"
SEEN = "geometry_msgs/msg/PoseWithCovarianceStamped"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

# These have been the same for as long as there are bags: the definitions that a recording brings with it are
# not needed, and not trusted. The library has the others.
FURTHER_TYPES = {
    GRID_UPDATE: "std_msgs/Header header\nint32 x\nint32 y\nuint32 width\nuint32 height\nint8[] data",
    **dict.fromkeys(TRANSFORMS, "geometry_msgs/TransformStamped[] transforms"),
}


class MessageReader:
    """Makes messages of the bytes of ROS 1, or of ROS 2 (CDR)."""

    def __init__(self, ros1: bool) -> None:
        self.types = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
        for name, text in FURTHER_TYPES.items():
            if name not in self.types.fielddefs:
                self.types.register(get_types_from_msg(text, name))
        self._read = self.types.deserialize_ros1 if ros1 else self.types.deserialize_cdr

    def read(self, name: str, kind: str, data: bytes) -> Any:
        """A message of a type. name : of where it comes from; raises InputFileError"""
        try:
            return self._read(data, kind)
        except Exception as error:  # what damaged bytes lead to is known to nobody
            raise InputFileError(name, f"its message ({kind}) is damaged", "record it again") from error
