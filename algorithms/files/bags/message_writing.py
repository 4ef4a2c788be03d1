"""ROS messages made of fields by name, and their bytes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from algorithms.files.bags.message_types import MessageReader

Fields = Mapping[str, Any]
"""A message's fields by name, a message in it as its own fields; what is left out is 0 or empty."""


class MessageWriter:
    """Makes messages of ROS 1, or of ROS 2, by the definitions that ``MessageReader`` reads with."""

    def __init__(self, ros1: bool = False) -> None:
        self.types = MessageReader(ros1).types
        self._serialize = self.types.serialize_ros1 if ros1 else self.types.serialize_cdr

    def write(self, kind: str, fields: Fields) -> bytes:
        """The bytes of a message of a type."""
        return bytes(self._serialize(self.fill(kind, fields), kind))

    def fill(self, kind: str, fields: Fields) -> Any:
        """The message; raises what numpy raises where a field does not fit its type."""
        definitions: Any = self.types.fielddefs
        values: dict[str, Any] = {}
        for field, (shape, detail) in definitions[kind][1]:
            given = fields.get(field, fields.get(field.lower()))
            if shape.name == "BASE":
                empty: Any = {"string": "", "bool": False}.get(detail[0], 0)
                values[field] = given if given is not None else empty
            elif shape.name == "NAME":
                values[field] = self.fill(detail, given or {})
            else:
                inner, inner_detail = detail[0]
                if inner.name == "NAME":
                    values[field] = [self.fill(inner_detail, each) for each in given or ()]
                else:
                    size = detail[1] if shape.name == "ARRAY" else 0
                    dtype = np.dtype(inner_detail[0])
                    values[field] = np.asarray(given if given is not None else np.zeros(size), dtype=dtype)
        return self.types.types[kind](**values)
