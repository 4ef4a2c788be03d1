"""Lines, signs and particles as data: what the page's scripts draw over the map (map_drawing.js)."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.common.pose import FloatArray
from app.drawing.palette import Rgb, css

Item = dict[str, Any]


def path(
    points: FloatArray, colour: Rgb | None, frame: str = "scene", alpha: float = 1.0, **more: Any
) -> Item:
    """A line through (N, 2) or (N, 3) points; d dashes, w width, fill, close, t text, halo."""
    return {"k": "path", "f": frame, "p": points, "c": css(colour, alpha) if colour else None, **more}


def mark(
    shape: str, point: FloatArray, colour: Rgb, frame: str = "scene", alpha: float = 1.0, **more: Any
) -> Item:
    """A sign of constant size: robot, cross, ring, dot, diamond or star; a angle, r size, t text.

    alpha : opacity of the sign; its text is never faint
    """
    ink = {"c": css(colour, alpha), "tc": css(colour)}
    return {"k": "mark", "s": shape, "f": frame, "p": point, **ink, **more}


def cloud(points: FloatArray, colour: Rgb, **more: Any) -> Item:
    """Particles: (N, 3) x, y, heading, or with n3=True x, y, z. They glide to their next place."""
    flat = np.round(points, 3).ravel()
    return {"k": "cloud", "f": "scene", "n": points.shape[1], "p": flat, "c": css(colour), **more}


def rectangle(low: FloatArray, high: FloatArray) -> FloatArray:
    """(4, 2) corners of an upright rectangle."""
    return np.array([low, [high[0], low[1]], high, [low[0], high[1]]])


def ellipse(centre: FloatArray, covariance: FloatArray, deviations: float) -> FloatArray:
    """(64, 2) points at so many standard deviations of a (2, 2) covariance."""
    turn = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1) * deviations
    return np.asarray(centre + ring @ np.linalg.cholesky(covariance).T, dtype=np.float64)
