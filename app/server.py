"""The web server: one page per tab."""

from __future__ import annotations

from math import radians

import viser

from algorithms.casefiles import Case
from app.page import Page


def make_server(host: str = "127.0.0.1", port: int = 8080, initial: Case | None = None) -> viser.ViserServer:
    server = viser.ViserServer(host=host, port=port, verbose=False)
    server.scene.set_up_direction("+y")
    server.scene.configure_environment_map(hdri=None)
    camera = server.initial_camera
    camera.position, camera.look_at, camera.up = (0.0, 0.0, 600.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    camera.fov, camera.near, camera.far = radians(4), 10.0, 5000.0
    pages: dict[int, Page] = {}

    @server.on_client_connect
    def _(client: viser.ClientHandle) -> None:
        pages[client.client_id] = Page(client, initial)

    @server.on_client_disconnect
    def _(client: viser.ClientHandle) -> None:
        page = pages.pop(client.client_id, None)
        if page:
            page.close()

    return server
