"""The pictures of a tab, all of them."""

from __future__ import annotations

import viser

from app.drawing.browser_messages import BrowserMessages
from app.drawing.scene.fleet_view import FleetView
from app.drawing.scene.height_view import HeightsView
from app.drawing.scene.map_comparison import MapComparison
from app.drawing.scene.map_view import MapView
from app.drawing.scene.run_view import RunView
from app.drawing.scene.swarm_view import SwarmView


class Views:
    """The pictures of a tab."""

    def __init__(self, client: viser.ClientHandle, messages: BrowserMessages) -> None:
        self.map = MapView(client, messages)
        self.run = RunView(self.map, messages)
        self.heights = HeightsView(client, messages)
        self.swarm = SwarmView(messages)
        self.comparison = MapComparison(messages, self.map)
        self.fleet = FleetView(client.scene, messages)
