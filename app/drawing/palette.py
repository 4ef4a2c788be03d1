"""The colours of the page, after Okabe and Ito: safe for colour-blind eyes, light and dark."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

Rgb = tuple[int, int, int]


@dataclass(frozen=True)
class Palette:
    """What is drawn in which colour; sRGB, 0 … 255."""

    dark: bool
    maps: tuple[Rgb, ...]  # walls of each map
    agreed: Rgb  # wall on wall
    conflict: Rgb  # wall on free
    particle: Rgb
    best: Rgb
    answer: Rgb  # the place the search ended on
    rim: Rgb  # around it: yellow is faint on white
    rival: Rgb  # another place that fits
    margin: Rgb  # windows and boxes
    free: Rgb
    unknown: Rgb
    text: Rgb

    @property
    def ref(self) -> Rgb:
        """Walls of map 1."""
        return self.maps[0]

    @property
    def mov(self) -> Rgb:
        """Walls of map 2."""
        return self.maps[1]


LIGHT = Palette(
    dark=False,
    maps=((0x00, 0x72, 0xB2), (0x00, 0x9E, 0x73)),
    agreed=(0x11, 0x18, 0x27),
    conflict=(0xD5, 0x5E, 0x00),
    particle=(0xE6, 0x9F, 0x00),
    best=(0xCC, 0x79, 0xA7),
    answer=(0xF0, 0xE4, 0x42),
    rim=(0x37, 0x41, 0x51),
    rival=(0xCC, 0x79, 0xA7),
    margin=(0x6B, 0x72, 0x80),
    free=(0xFF, 0xFF, 0xFF),
    unknown=(0xE5, 0xE7, 0xEB),
    text=(0x11, 0x18, 0x27),
)
DARK = replace(
    LIGHT,
    dark=True,
    agreed=(0xF9, 0xFA, 0xFB),
    margin=(0x9C, 0xA3, 0xAF),
    free=(0x1F, 0x29, 0x37),
    unknown=(0x11, 0x18, 0x27),
    text=(0xF9, 0xFA, 0xFB),
)

ROBOTS: tuple[Rgb, ...] = (
    (0x00, 0x72, 0xB2),
    (0x00, 0x9E, 0x73),
    (0xE6, 0x9F, 0x00),
    (0xCC, 0x79, 0xA7),
    (0x56, 0xB4, 0xE9),
    (0xD5, 0x5E, 0x00),
    (0x6B, 0x4C, 0x9A),
    (0x8C, 0x6D, 0x31),
)
"""Walls of each robot of a fleet, in turn: eight that colour-blind eyes tell apart."""

QUIET: Rgb = (226, 232, 240)  # buttons that are not the point of the page
STOP: Rgb = (71, 85, 105)  # buttons that stop something

# (256, 3) uint8: even steps of level look like even steps, also in grey
VIRIDIS: NDArray[np.uint8] = np.ascontiguousarray(
    cv2.applyColorMap(np.arange(256, dtype=np.uint8)[:, None], cv2.COLORMAP_VIRIDIS)[:, 0, ::-1]
)

LEAST_SEEN = (0.5, 0.42)  # where in viridis a wall of no level lies, on a light and on a dark page: 3 to 1


def robot_colour(number: int) -> Rgb:
    """Of the walls of a fleet's robot, by its place in the list from 0."""
    return ROBOTS[number % len(ROBOTS)]


def css(colour: Rgb, alpha: float = 1.0) -> str:
    red, green, blue = colour
    return f"rgba({red},{green},{blue},{alpha:g})" if alpha < 1 else f"#{red:02x}{green:02x}{blue:02x}"


def level_colours(share: NDArray[np.floating], dark: bool) -> NDArray[np.uint8]:
    """Colours (…, 3) of walls by their levels in 0 … 1: the half of viridis that stands out from the floor,
    the more so the higher the level.
    """
    level = np.clip(np.nan_to_num(share), 0, 1)
    return viridis(LEAST_SEEN[dark] + (dark - LEAST_SEEN[dark]) * level)


def viridis(share: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Colours (…, 3) of numbers in 0 … 1."""
    index = np.clip(np.nan_to_num(share) * 255, 0, 255).astype(np.uint8)
    return np.asarray(VIRIDIS[index], dtype=np.uint8)
