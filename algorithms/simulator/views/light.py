"""The light in which a picture is taken, and what the camera makes of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.simulator.portable_random import TURN, chance, uniform, whole


@dataclass(frozen=True)
class Light:
    """Light indoors and the faults of a camera.

    brightness : 1 is well exposed, 0.05 is night
    direction  : from where more of it comes; ticks, world frame
    side       : how much more, 0 … 1
    warmth     : colour temperature, from −1, bluish, to 1, like a bulb's
    outside    : brightness behind the windows
    uneven     : how much brighter it is under lamps than between them, 0 … 1
    contrast   : 1 leaves it
    vignetting : share of light that the corners of a picture lose
    blur       : standard deviation; pixels
    noise      : standard deviation; grey levels of 255
    """

    brightness: float = 1.0
    direction: int = 0
    side: float = 0.3
    warmth: float = 0.0
    outside: float = 1.6
    uneven: float = 0.2
    contrast: float = 1.0
    vignetting: float = 0.15
    blur: float = 0.6
    noise: float = 2.0


def draw_light(rng: np.random.Generator, night: bool = False) -> Light:
    """Light as robots meet it: day, lamps, dusk; or night."""
    dusk = chance(rng, 0.15)
    low, high = (0.03, 0.09) if night else ((0.25, 0.5) if dusk else (0.6, 1.35))
    return Light(
        brightness=uniform(rng, low, high),
        direction=whole(rng, 0, TURN - 1),
        side=uniform(rng, 0.1, 0.6),
        warmth=uniform(rng, -0.5, 1.0),
        outside=0.02 if night else uniform(rng, 0.2, 2.2),
        uneven=uniform(rng, 0.1, 0.5),
        contrast=uniform(rng, 0.85, 1.2),
        vignetting=uniform(rng, 0.0, 0.35),
        blur=uniform(rng, 0.45, 1.1),
        noise=uniform(rng, 4.0, 9.0) if night else uniform(rng, 1.0, 5.0),
    )
