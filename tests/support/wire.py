"""A tab without a browser: it speaks viser's wire protocol, knows its controls by their words, and is cheap.

For tests of many tabs at a time; what a person sees, the tests in browser/ look at.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from threading import Event, Thread
from time import monotonic, sleep
from typing import Any, Protocol

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

PATIENCE = 120.0  # seconds until a wait is given up; a slow machine is no failure
CAMERA = {
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [0.0, 0.0, 600.0],
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 1.0, 0.0],
    "fov": 0.07,
    "near": 10.0,
    "far": 5000.0,
    "image_height": 700,
    "image_width": 1000,
}
_HUD = re.compile(r"^window\.mapmeld && window\.mapmeld\.apply\((.*)\)$", re.DOTALL)


def until(check: Callable[[], Any], what: str, patience: float = PATIENCE) -> Any:
    """Poll until ``check`` gives something true, and return it."""
    end = monotonic() + patience
    while monotonic() < end:
        if found := check():
            return found
        sleep(0.01)
    raise AssertionError(f"waited {patience:.0f} s for {what}")


class WireTab:
    """A connection; what it was told is in ``words`` (above the map) and ``props`` (of its controls)."""

    def __init__(
        self, port: int, cookie: str = "", key: str = "", again: bool = False, patience: float = PATIENCE
    ) -> None:
        self.props: dict[str, dict[str, Any]] = {}
        self.words: dict[str, Any] = {}
        self.key = key
        self.bytes = 0
        self._notices: list[str] = []
        self.files: dict[str, bytes] = {}  # that were sent whole
        self._coming: dict[str, tuple[str, int, dict[int, bytes]]] = {}
        self._said = 0
        self._reads = Event()
        self._reads.set()
        self.port = port
        self.socket = connect(
            f"ws://127.0.0.1:{port}/",
            subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
            origin=f"http://127.0.0.1:{port}",  # type: ignore[arg-type]
            additional_headers={"Cookie": cookie} if cookie else {},
            compression=None,
            max_size=None,
            max_queue=4,
            open_timeout=PATIENCE,
            ping_interval=None,
        )
        Thread(target=self._read, daemon=True).start()
        self.send("ViewerCameraMessage", **CAMERA)
        until(lambda: self.words.get("channel"), "the channel", patience)
        self.tell("hello", key=key, again=again, mode="Research")
        until(lambda: self.words.get("state"), "the page")

    def _read(self) -> None:
        try:
            for frame in self.socket:
                self._reads.wait()
                assert isinstance(frame, bytes)
                self.bytes += len(frame)
                self._take(frame)
        except ConnectionClosed:
            pass

    def _take(self, frame: bytes) -> None:
        packed = int.from_bytes(frame[8:16], "little")
        inner = zstandard.ZstdDecompressor().decompress(
            frame[16 : 16 + packed], max_output_size=int.from_bytes(frame[:8], "little")
        )
        for message in msgspec.msgpack.decode(inner)["messages"]:
            kind = message["type"]
            if "container_uuid" in message:
                self.props[message["uuid"]] = {
                    **message["props"],
                    "value": message.get("value"),
                    "kind": kind,
                }
            elif kind == "GuiUpdateMessage":
                self.props.setdefault(message["uuid"], {}).update(message["updates"])
            elif kind == "GuiRemoveMessage":
                self.props.pop(message["uuid"], None)
            elif kind == "NotificationShowMessage":
                self._notices.append(message["props"]["title"])
            elif kind == "FileTransferStartDownload":
                self._coming[message["transfer_uuid"]] = (message["filename"], message["part_count"], {})
            elif kind == "FileTransferPart":
                self._take_part(message, frame, packed)
            elif kind == "RunJavascriptMessage" and (told := _HUD.match(message["source"])):
                said = json.loads(told[1])
                self.words.update(said.get("hud", {}))
                for name in ("channel", "key", "maps"):
                    if name in said:
                        self.words[name] = said[name]

    def _take_part(self, message: dict[str, Any], frame: bytes, packed: int) -> None:
        name, count, parts = self._coming[message["transfer_uuid"]]
        parts[message["part_index"]] = message["content"]
        if len(parts) == count:
            self.files[name] = b"".join(parts[k] for k in range(count))

    def notices(self, title: str) -> int:
        """How often a notice of this title has been shown."""
        return self._notices.count(title)

    def stop_reading(self) -> None:
        """From now on nothing is taken any more, as of a tab that hangs."""
        self._reads.clear()

    @property
    def state(self) -> str:
        return str(self.words.get("state"))

    @property
    def mood(self) -> str:
        return str(self.words.get("mood"))

    def send(self, kind: str, **fields: Any) -> None:
        self.socket.send(msgspec.msgpack.encode({"type": kind, **fields}))

    def find(self, label: str, kind: str = "") -> str:
        """The id of the control of this label."""
        (found,) = (
            uuid
            for uuid, props in list(self.props.items())
            if props.get("label") == label and kind in props.get("kind", "")
        )
        return found

    def write(self, label: str, value: Any, kind: str = "") -> None:
        uuid = self.find(label, kind)
        self.props[uuid]["value"] = value  # whoever writes is not told of it
        self.send("GuiUpdateMessage", uuid=uuid, updates={"value": value})

    def press(self, label: str) -> None:
        self.write(label, True, "GuiButtonMessage")

    def choose(self, option: str) -> None:
        """Press one of a row of buttons."""
        (row,) = (
            uuid
            for uuid, props in list(self.props.items())
            if props.get("kind") == "GuiButtonGroupMessage" and option in props["options"]
        )
        self.send("GuiUpdateMessage", uuid=row, updates={"value": option})

    def tell(self, event: str, **fields: Any) -> None:
        """Tell of something that the page does by itself."""
        self._said += 1
        text = json.dumps([self._said, event, fields])
        self.send("GuiUpdateMessage", uuid=self.words["channel"], updates={"value": text})

    def close(self) -> None:
        self._reads.set()
        self.socket.close()


class Sender(Protocol):
    """Who sends a file."""

    @property
    def port(self) -> int: ...

    def find(self, label: str) -> str:
        """The id of the button of this label."""


class WireFile:
    """A file on its way, sent as by the page's script."""

    def __init__(self, tab: Sender, label: str, name: str, content: bytes, **other: Any) -> None:
        """other : fields of the first word in place of the right ones"""
        self.content, self.sent = content, 0
        self.socket = connect(
            f"ws://127.0.0.1:{tab.port}/upload",
            origin=f"http://127.0.0.1:{tab.port}",  # type: ignore[arg-type]
            compression=None,
            open_timeout=PATIENCE,
        )
        first = {"button": tab.find(label), "name": name, "kind": "", "size": len(content), **other}
        self.socket.send(json.dumps(first))

    def hear(self) -> dict[str, Any]:
        """The next word; {} where the connection has ended."""
        try:
            return dict(json.loads(self.socket.recv(timeout=PATIENCE)))
        except ConnectionClosed:
            return {}

    def part(self, size: int) -> None:
        """Send so much more of it, and wait until that has arrived."""
        self.socket.send(self.content[self.sent : self.sent + size])
        self.sent = min(self.sent + size, len(self.content))
        until(lambda: self.hear().get("arrived") == self.sent, "the part to arrive")

    def over(self) -> str:
        """What has become of it; "" where the connection ended without a word."""
        while heard := self.hear():
            if "over" in heard:
                return str(heard["over"])
        return ""
