"""From light to a picture: vignetting, colour temperature, blur, contrast, noise, 8 bit."""

from __future__ import annotations

import numpy as np

from algorithms.simulator.portable_random import normals
from algorithms.simulator.views.light import Light
from algorithms.simulator.views.surfaces.materials import Picture
from algorithms.simulator.views.surfaces.noise import Tones

WHITE_POINT = 0.82  # above it a picture grows white more and more slowly
MIDDLE = 0.45  # grey that contrast leaves


def developed(light_in: Tones, light: Light, rng: np.random.Generator) -> Picture:
    """The picture that a camera makes of (H, W, 3) light, 1 where it is white in good light."""
    height, width, _ = light_in.shape
    x = (np.arange(width, dtype=np.float32) - (width - 1) / 2) * (2 / width)
    y = (np.arange(height, dtype=np.float32) - (height - 1) / 2) * (2 / width)
    lost = np.float32(light.vignetting) * (x[None, :] ** 2 + y[:, None] ** 2) / np.float32(1.56)
    warm = np.array([1 + 0.12 * light.warmth, 1 + 0.01 * light.warmth, 1 - 0.2 * light.warmth])
    arrived = light_in * (1 - lost)[..., None] * warm.astype(np.float32)
    shown = np.sqrt(np.maximum(blurred(arrived, light.blur), 0))  # the usual gamma of 2.2, or nearly
    shown = MIDDLE + (shown - np.float32(MIDDLE)) * np.float32(light.contrast)
    over = np.maximum(0, shown - np.float32(WHITE_POINT))
    shown = np.minimum(shown, np.float32(WHITE_POINT)) + over / (1 + over / np.float32(1.02 - WHITE_POINT))
    grey = shown * 255 + noise(rng, height, width) * np.float32(light.noise)
    return np.asarray(np.clip(np.floor(grey + np.float32(0.5)), 0, 255), dtype=np.uint8)


def noise(rng: np.random.Generator, height: int, width: int) -> Tones:
    """(H, W, 3) normal draws, mostly alike in the three colours; one field serves all, shifted."""
    field = normals(rng, height * width).astype(np.float32)
    common = np.float32(0.8) * field
    colours = [common + np.float32(0.6) * np.roll(field, 4099 * n) for n in (1, 2, 3)]
    return np.stack(colours, axis=1).reshape(height, width, 3)


def blurred(picture: Tones, sigma: float) -> Tones:
    """A picture blurred by a kernel of three taps, as often as it takes; sigma in pixels."""
    if sigma <= 0:
        return picture
    variance = sigma * sigma
    rounds = max(1, int(np.ceil(variance / 0.5)))
    side = np.float32(variance / (2 * rounds))
    for _ in range(rounds):
        for axis in (0, 1):
            padded = np.pad(picture, [(1, 1) if n == axis else (0, 0) for n in range(3)], mode="edge")
            before, after = (
                padded[:-2] if axis == 0 else padded[:, :-2],
                padded[2:] if axis == 0 else padded[:, 2:],
            )
            picture = picture + side * (before + after - 2 * picture)
    return picture
