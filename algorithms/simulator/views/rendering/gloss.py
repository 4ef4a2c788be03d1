"""The dim mirror image in a polished floor."""

from __future__ import annotations

import numpy as np

from algorithms.common.pose import FloatArray
from algorithms.simulator.views.rendering.eye import DIRECT, Eye, Traced
from algorithms.simulator.views.rendering.lens import blurred
from algorithms.simulator.views.rendering.ray_casting import FLOOR
from algorithms.simulator.views.surfaces.noise import Tones

STEP = 2  # pixels between those that are looked at: what a floor reflects is blurred
BLUR = 1.1  # steps
STRAIGHT_DOWN = 0.05  # of the light that a floor would reflect at a glancing angle


def with_gloss(eye: Eye, a: FloatArray, b: FloatArray, traced: Traced, light: Tones) -> Tones:
    """The (H, W, 3) light of an image, with what its floor reflects.

    a, b   : (H, W) rays
    traced : what they end at, in one row
    """
    floor = ((traced.hits.surface == FLOOR) & (traced.mirror == DIRECT)).reshape(a.shape)
    if not eye.floor.gloss or not floor.any():
        return light
    few = np.s_[::STEP, ::STEP]
    seen = floor[few]
    reflected = np.zeros((*seen.shape, 4), dtype=np.float32)
    reflected[seen, :3] = np.minimum(eye.on_floor(a[few][seen], b[few][seen]), 1.5)
    reflected[seen, 3] = 1
    reflected = blurred(reflected, BLUR)
    reflected = reflected.repeat(STEP, axis=0).repeat(STEP, axis=1)[: a.shape[0], : a.shape[1]]
    shown = reflected[..., :3] / np.maximum(reflected[..., 3:], 1e-3)
    steep = (b / np.sqrt(1 + a * a + b * b)).astype(np.float32)
    flat = (1 - steep) * (1 - steep)
    share = np.where(floor, eye.floor.gloss * (STRAIGHT_DOWN + (1 - STRAIGHT_DOWN) * flat * flat), 0)
    return np.asarray(light + (shown - light) * share[..., None].astype(np.float32))
