"""Types of ROS messages for DDS, made from their definitions; the bytes are read and written by rosbags.

Cyclone's own reading of a message makes a Python list of its cells: a map of 1000 × 1000 would take a second.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from cyclonedds.idl import make_idl_struct, types

from algorithms.files.bags.message_types import MessageReader

BASIC = {
    "bool": bool,
    "string": str,
    "byte": types.uint8,
    "octet": types.uint8,
    "char": types.uint8,
    **{
        name: getattr(types, name)
        for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
    },
    "float32": types.float32,
    "float64": types.float64,
}


class RawMessage:
    """What was sent, with the four bytes before it that say how."""

    def __init__(self, data: bytes) -> None:
        self.data = data


@cache
def dds_type(kind: str) -> Any:
    """The type by which ROS 2 publishes messages of a kind, which yields and takes them as bytes."""
    made = _struct(kind)
    made.deserialize = classmethod(lambda cls, data, **_: RawMessage(data))
    made.serialize = lambda self, **_: self.data
    return made


def dds_message(kind: str, data: bytes) -> Any:
    """A message of a type, by its bytes, as a writer takes it."""
    message = object.__new__(dds_type(kind))
    message.data = data
    return message


@cache
def _struct(kind: str) -> Any:
    package, _, name = kind.split("/")
    fields = {field: _of(shape, detail) for field, (shape, detail) in _definitions()[kind][1]}
    return make_idl_struct(f"{name}_", f"{package}::msg::dds_::{name}_", fields)


def _of(shape: Any, detail: Any) -> Any:
    if shape.name == "BASE":
        return BASIC[detail[0]]
    if shape.name == "NAME":
        return _struct(detail)
    each = _of(*detail[0])
    return types.array[each, detail[1]] if shape.name == "ARRAY" else types.sequence[each]


@cache
def _definitions() -> Any:
    return MessageReader(ros1=False).types.fielddefs
