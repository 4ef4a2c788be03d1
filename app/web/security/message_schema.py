"""The messages that the page's own script sends, field by field: whatever else comes is none of them.

viser reads a frame into mappings and lists before it looks at it, and a mapping whose keys were chosen for
it takes a minute to be read, in which nothing else runs. Here a frame is read as what it says it is: keys
are the names of fields, values are shallow, and nothing of the sender's choice is ever built.

Files come by connections of their own (upload.py): viser's messages for them are none of the page's.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec

MAX_WORDS = 64 * 1024  # bytes of a message
MAX_TEXT = 10_000  # letters in a control
MAX_PARTS = 64  # numbers in a control
MAX_NUMBER = 1e12

# Not a "type | None" among them: these are looked at when the module is read, on Python 3.10, too
Text = Annotated[str, msgspec.Meta(max_length=MAX_TEXT)]
Id = Annotated[str, msgspec.Meta(min_length=1, max_length=64)]
Number = Annotated[float, msgspec.Meta(ge=-MAX_NUMBER, le=MAX_NUMBER)]  # NaN is on neither side
Count = Annotated[int, msgspec.Meta(ge=0, le=int(MAX_NUMBER))]
Name = Annotated[str, msgspec.Meta(min_length=1, max_length=64)]
Plain = None | bool | int | float | str
Value = Plain | Annotated[list[Plain], msgspec.Meta(max_length=MAX_PARTS)]
Two, Three, Four = tuple[Number, Number], tuple[Number, Number, Number], tuple[Number, Number, Number, Number]


class Message(msgspec.Struct, forbid_unknown_fields=True):
    """Some message; what it is of, its ``type`` tells."""

    type: str


class GuiUpdateMessage(Message):
    """What a control holds now."""

    uuid: Id
    updates: dict[Name, Value]


class ViewerCameraMessage(Message):
    """Where a tab's camera is."""

    wxyz: Four
    position: Three
    look_at: Three
    up_direction: Three
    fov: Number
    near: Number
    far: Number
    image_height: Count
    image_width: Count


class ScenePointerMessage(Message):
    """A click on the map."""

    event_type: Literal["click"]
    ray_origin: Three
    ray_direction: Three
    screen_pos: tuple[Two]
    modifier: Text | None


class _Kind(msgspec.Struct):
    """Of a message the kind alone; what else it holds is skipped, not read."""

    type: str


# All that the page's own script ever sends
MESSAGES: dict[str, type[Message]] = {
    kind.__name__: kind for kind in (GuiUpdateMessage, ViewerCameraMessage, ScenePointerMessage)
}


def fault(raw: Any) -> str:
    """What is wrong with a frame, in a word; "" for a message that the page could have sent.

    "garbage" : no message of any kind
    """
    try:
        kind = msgspec.msgpack.decode(raw, type=_Kind).type if isinstance(raw, bytes) else None
        if kind is None:
            return "garbage"
        if kind not in MESSAGES:
            return "unasked"
        if len(raw) > MAX_WORDS:
            return "too long"
        try:
            msgspec.msgpack.decode(raw, type=MESSAGES[kind])
        except msgspec.ValidationError:
            return "malformed"
    except (msgspec.DecodeError, RecursionError, ValueError):  # ValueError: a text that is no UTF-8
        return "garbage"
    return ""
