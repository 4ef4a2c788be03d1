"""A small rosbridge server: it passes messages of one client on to the others, and latches the last."""

from __future__ import annotations

import json
from contextlib import contextmanager, suppress
from threading import Lock, Thread
from typing import Any

from websockets.sync.server import ServerConnection, serve


class RosbridgeServer:
    """asked : operations that clients have sent; sent : what was published, by topic
    topics : by name the type, as rosapi tells; None: there is no rosapi
    """

    def __init__(self) -> None:
        self.asked: list[dict[str, Any]] = []
        self.topics: dict[str, str] | None = None
        self.sent: dict[str, list[Any]] = {}
        self._listening: dict[str, list[ServerConnection]] = {}
        self._lock = Lock()
        self.connections: list[ServerConnection] = []

    def handle(self, client: ServerConnection) -> None:
        self.connections.append(client)
        for text in client:
            operation = json.loads(text)
            with self._lock:
                self.asked.append(operation)
                topic = operation.get("topic")
                if operation["op"] == "subscribe":
                    self._listening.setdefault(topic, []).append(client)
                    for message in self.sent.get(topic, [])[-1:]:
                        self._tell(client, topic, message)
                elif operation["op"] == "publish":
                    self._publish(topic, operation["msg"])
                elif operation["op"] == "call_service":
                    self._answer(client, operation)

    def publish(self, topic: str, message: Any) -> None:
        """A message of a robot."""
        with self._lock:
            self._publish(topic, message)

    def operations(self, kind: str) -> list[dict[str, Any]]:
        return [each for each in self.asked if each["op"] == kind]

    def _publish(self, topic: str, message: Any) -> None:
        self.sent.setdefault(topic, []).append(message)
        for client in self._listening.get(topic, []):
            self._tell(client, topic, message)

    def _answer(self, client: ServerConnection, operation: dict[str, Any]) -> None:
        topics = self.topics
        values = "no such service" if topics is None else {"topics": [*topics], "types": [*topics.values()]}
        answer = {"op": "service_response", "service": operation["service"], "id": operation["id"]}
        with suppress(OSError):
            client.send(json.dumps({**answer, "values": values, "result": topics is not None}))

    @staticmethod
    def _tell(client: ServerConnection, topic: str, message: Any) -> None:
        with suppress(OSError):
            client.send(json.dumps({"op": "publish", "topic": topic, "msg": message}))


@contextmanager
def rosbridge():
    """A server on this machine, and its address."""
    made = RosbridgeServer()
    with serve(made.handle, "127.0.0.1", 0, max_size=None) as server:
        thread = Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield made, f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
