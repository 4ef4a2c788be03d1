"""What a face is made of, and the points of it that a picture shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.simulator.views.surfaces.noise import Tones

Colour = tuple[float, float, float]  # red, green, blue as a screen shows them, 0 … 1
Picture = NDArray[np.uint8]  # (H, W, 3) red, green, blue; row 0 at the top


@dataclass(frozen=True, eq=False)
class Material:
    """How one kind of face looks.

    pattern : a key of ``patterns.PATTERNS``, or MIRROR
    colour, accent : what the pattern makes of them, as a rule ground and lines
    size    : of what repeats; metres along and up
    seed    : tells faces of one pattern apart
    picture : that the pattern "picture" shows over the whole face
    glow    : of the light that leaves the face, how much it gives itself, 0 … 1: lamps and windows
    gloss   : of a floor, how much it reflects at a glancing angle, 0 … 1
    fine    : its detail is finer than a pixel, and each pixel is looked at in several places
    """

    pattern: str
    colour: Colour = (0.8, 0.8, 0.8)
    accent: Colour = (0.2, 0.2, 0.2)
    size: tuple[float, float] = (1.0, 1.0)
    seed: int = 0
    picture: Picture | None = None
    glow: float = 0.0
    gloss: float = 0.0
    fine: bool = False


MIRROR = Material("mirror")


@dataclass(frozen=True, eq=False)
class FacePoints:
    """Points of faces of one material; (n,) arrays, metres.

    u, v          : from the left edge and from the bottom, as one sees who looks at the face; of floors and
                    ceilings world x and y
    width, height : of the faces
    grain         : how much of the face one pixel shows
    """

    u: Tones
    v: Tones
    width: Tones
    height: Tones
    grain: Tones

    def sharpness(self, feature: float) -> Tones:
        """1 where a feature of so many metres is wider than a pixel, less and less where it is not."""
        return np.asarray(np.minimum(1.0, feature / np.maximum(self.grain, 1e-6)), dtype=np.float32)


def painted(colour: Colour, tone: Tones) -> Tones:
    """(n, 3) a colour, brighter and darker by (n,) tones around 1."""
    return np.asarray(np.array(colour, dtype=np.float32) * tone[:, None], dtype=np.float32)


def mixed(ground: Tones, over: Tones | Colour, share: Tones) -> Tones:
    """(n, 3) one colour over another one, by (n,) shares in [0, 1]."""
    top = np.asarray(over, dtype=np.float32)
    return np.asarray(ground + (top - ground) * share[:, None], dtype=np.float32)
