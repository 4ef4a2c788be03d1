"""Folder "Observation": its numbers, as they were loaded."""

from __future__ import annotations

from math import degrees

import viser

from app.inputs import Inputs
from app.panels.tables import box, table


class ObservationPanel:
    """Shows where the robots were and what one saw of the other."""

    def __init__(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Observation", order=20.0, expand_by_default=False):
            self._html = gui.add_html("")

    def show(self, inputs: Inputs) -> None:
        """Show the numbers of these inputs."""
        o, at = inputs.observation, inputs.at
        if o is None or at is None:
            self._html.content = box("No observation yet.", "plain")
            return
        rows = [
            (
                "robot 1 in map 1",
                f"{o.observer.x:.2f}, {o.observer.y:.2f} m, {degrees(o.observer.theta):.1f}°",
            ),
            ("robot 2 in map 2", f"{o.observed_x:.2f}, {o.observed_y:.2f} m"),
            ("range r", f"{o.range:.3f} ± {o.sigma_range:.3f} m"),
            ("bearing β", f"{degrees(o.bearing):.1f} ± {degrees(o.sigma_bearing):.1f}°"),
            ("x̂₁, seen here", f"{at.x_ref[0]:.2f}, {at.x_ref[1]:.2f} m"),
        ]
        if o.bearing_back is not None:
            rows.append(("bearing back", f"{degrees(o.bearing_back):.1f}°"))
        doubt = inputs.doubt()
        self._html.content = (box(doubt, "refused") if doubt else "") + table(rows)
