"""Folder "Observation": its numbers, as they were loaded."""

from __future__ import annotations

from math import degrees

import viser

from algorithms.observation import Encounter, Observation
from app.inputs import Inputs
from app.panels.tables import box, table


class ObservationPanel:
    """Shows where the robots were and what one saw of the other."""

    def __init__(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Observation", order=20.0, expand_by_default=False):
            self._html = gui.add_html("")

    def show(self, inputs: Inputs) -> None:
        """Show the numbers of these inputs."""
        self._html.content = observations_html(inputs)


def observations_html(inputs: Inputs) -> str:
    """HTML of a table per sighting, each under what is odd about it."""
    parts = []
    total = len(inputs.observations)
    told = zip(inputs.observations, inputs.encounters, inputs.doubts(), strict=True)
    for number, (o, at, doubt) in enumerate(told, 1):
        head = (f"Observation {number} of {total}", "") if total > 1 else ()
        parts.append((box(doubt, "refused") if doubt else "") + table(numbers(o, at), head))
    return "".join(parts) or box("No observation yet.", "plain")


def numbers(o: Observation, at: Encounter) -> list[tuple[str, ...]]:
    """Where the robots were, and what the one measured of the other."""
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
    return rows
