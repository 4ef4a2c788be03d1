"""Features of a picture: where it is like no other place nearby, and what it looks like there.

The settings are the best of those tried on 28 pairs of real maps and 16 simulated ones. As they stand, so
many come out right: Harris 18 and 13, Shi–Tomasi 16 and 13, SURF 8 and 9, SIFT 16 and 12, ORB 17 and 14.
When they were chosen, each alone, so many did:
  SIFT  of the distance to the next wall, up to 0.3 m 18 and 13, 0.5 m 16 and 13, 1 m 13 and 11; of the
        map's three values 14 and 4, smoothed 16 and 6; of blurred walls 15 and 6; at twice the resolution
        11 and 12.
  ORB   of the distance up to 0.4 m 14 and 12, up to 1 m 17 and 14; of the map's three values 13 and 5.
  Shi–Tomasi  of the distance up to 0.4 m 13 and 10, up to 1 m 17 and 13; of the three values 13 and 5.
  SURF  as mahotas gives it 4 and 5. Of half of the pairs turned upright first 5 and 5, or matched in 24
        turned copies of the whole map 6 and 6, at twenty times the cost.
Lowe's ratio between 0.8 and 1, RANSAC's tolerance between 0.2 and 0.5 m, and thresholds of the detectors
make a difference of one to three pairs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.methods.baselines.distance_image import DistanceImage, Turn

Described = tuple[FloatArray, NDArray[Any]]
"""(N, 2) column and row of the features, and (N, D) what they look like: bool, or real numbers."""

SIFT_REACH = 6.0  # a SIFT descriptor's window is so many times as wide as half its key point's size
WEAKEST = 0.01  # corner that counts, of the strongest
UPRIGHT_STEPS = 24  # turned copies of a picture, in one of which a feature stands upright to 7.5°

Most = Annotated[int, Bounds(50, 5000, 50, "", "", "features")]


@dataclass(frozen=True)
class SiftConfig(CheckedConfig):
    """Blobs at all scales, each with its gradients (Lowe 2004), compared by the root of them (RootSIFT)."""

    most: Most = 2000
    """Features per map at most, the strongest first."""
    contrast: Annotated[float, Bounds(0.001, 0.2, 0.001, "", "", "least contrast")] = 0.02
    """Weaker blobs are left out."""


@dataclass(frozen=True)
class OrbConfig(CheckedConfig):
    """Fast corners at several scales, each with 256 comparisons of pixels, turned upright."""

    most: Most = 1500
    """Features per map at most, the strongest first."""
    contrast: Annotated[int, Bounds(1, 100, 1, "", "", "least contrast")] = 5
    """Grey levels by which a corner's circle must differ from its middle."""


@dataclass(frozen=True)
class SurfConfig(CheckedConfig):
    """Blobs at all scales, each with its Haar wavelets (Bay et al. 2008)."""

    most: Most = 1000
    """Features per map at most, the strongest first."""
    radius: Annotated[float, Bounds(0.3, 5, 0.1, "m", "", "around a feature")] = 1.0
    """What lies so near says which way the feature points."""


@dataclass(frozen=True)
class CornerConfig(CheckedConfig):
    """Corners, each with the gradients around it (a SIFT descriptor of one size)."""

    most: Most = 600
    """Corners per map at most, the strongest first."""
    spacing: Annotated[float, Bounds(0.05, 2, 0.05, "m", "", "apart")] = 0.2
    """Two corners are at least so far apart."""
    window: Annotated[float, Bounds(0.1, 2, 0.05, "m", "", "corner window")] = 0.25
    """Side of the window in which the gradients must point both ways."""
    radius: Annotated[float, Bounds(0.3, 5, 0.1, "m", "", "around a corner")] = 1.5
    """What lies so near to a corner describes it, and says which way it points."""


@dataclass(frozen=True)
class ShiTomasiConfig(CornerConfig):
    """Corners by the smaller eigenvalue of the gradients (Shi and Tomasi 1994), with SIFT descriptors."""


@dataclass(frozen=True)
class HarrisConfig(CornerConfig):
    """Corners by determinant and trace of the gradients (Harris and Stephens 1988), with SIFT descriptors."""

    k: Annotated[float, Bounds(0.01, 0.24, 0.01, "", "k", "sensitivity")] = 0.04
    """Weight of the squared trace: higher leaves out what is nearly an edge."""


DetectorConfig = SiftConfig | OrbConfig | SurfConfig | ShiTomasiConfig | HarrisConfig


def describe(picture: DistanceImage, config: DetectorConfig) -> Described:
    """The features of a picture, of the kind that the config is of."""
    return _KINDS[type(config)](picture, config)


def _sift(picture: DistanceImage, config: SiftConfig) -> Described:
    sift = cv2.SIFT.create(config.most, contrastThreshold=config.contrast)
    found, looks = sift.detectAndCompute(picture.grey, None)
    return _places(found), _root(looks)


def _orb(picture: DistanceImage, config: OrbConfig) -> Described:
    orb = cv2.ORB.create(config.most, nlevels=6, fastThreshold=config.contrast)
    found, looks = orb.detectAndCompute(picture.grey, None)
    if looks is None:
        return np.empty((0, 2)), np.empty((0, 256), dtype=np.bool_)
    return _places(found), np.unpackbits(np.asarray(looks, dtype=np.uint8), axis=1).astype(np.bool_)


def _corners(picture: DistanceImage, config: ShiTomasiConfig | HarrisConfig) -> Described:
    cell = picture.cell
    found = cv2.goodFeaturesToTrack(
        picture.grey,
        config.most,
        WEAKEST,
        config.spacing / cell,
        blockSize=max(3, round(config.window / cell)) | 1,
        useHarrisDetector=isinstance(config, HarrisConfig),
        k=config.k if isinstance(config, HarrisConfig) else 0.0,
    )
    at = np.empty((0, 2)) if found is None else found.reshape(-1, 2).astype(np.float64)
    size = 2 * config.radius / cell / SIFT_REACH
    points = [
        cv2.KeyPoint(x, y, size, angle)
        for (x, y), angle in zip(at.tolist(), _orientations(picture, at, config.radius), strict=True)
    ]
    described, looks = cv2.SIFT.create().compute(picture.grey, points)
    return _places(described), _root(looks)


def _surf(picture: DistanceImage, config: SurfConfig) -> Described:
    """SURF of mahotas, each feature in a copy of the picture that is turned until it points along x.

    mahotas 1.4 itself finds the direction of a feature only to within a turn of its own: in a picture that
    is turned by 90° half of the features are not known again. Its detector and its descriptor are sound.
    """
    surf = _mahotas_surf()
    points = surf.interest_points(picture.grey.astype(np.float64), max_points=config.most)
    at = np.asarray(points[:, [1, 0]], dtype=np.float64).reshape(-1, 2)
    steps = np.rint(np.array(_orientations(picture, at, config.radius)) / 360 * UPRIGHT_STEPS).astype(int)
    steps %= UPRIGHT_STEPS
    places, looks = [np.empty((0, 2))], [np.empty((0, 64))]
    for step in np.unique(steps).tolist():
        upright = Turn.of(picture.grey.shape, -2 * np.pi * step / UPRIGHT_STEPS)
        mine = points[steps == step]
        mine[:, [1, 0]] = upright.there(at[steps == step])
        described = surf.descriptors(upright(picture.grey, 255).astype(np.float64), mine)
        places.append(upright.back(described[:, [1, 0]]))
        looks.append(described[:, 6:])
    return np.concatenate(places), np.concatenate(looks)


@cache
def _mahotas_surf() -> Any:
    try:
        from mahotas.features import surf
    except ImportError as error:
        raise SettingError(
            "SURF comes from mahotas, which is not installed; pip install 'mapmeld[surf]', "
            "or take another method: SIFT is its nearest relative"
        ) from error
    return surf


_KINDS: dict[type, Callable[..., Described]] = {
    SiftConfig: _sift,
    OrbConfig: _orb,
    SurfConfig: _surf,
    ShiTomasiConfig: _corners,
    HarrisConfig: _corners,
}


def _orientations(picture: DistanceImage, at: FloatArray, radius: float) -> list[float]:
    """Which way each place points: to where it is brighter; degrees from the columns to the rows."""
    from skimage.feature import corner_orientations  # slow to load, and no other method needs it

    if len(at) == 0:
        return []
    reach = max(1, round(radius / picture.cell))
    rows, cols = np.indices((2 * reach + 1, 2 * reach + 1)) - reach
    disc = (rows**2 + cols**2 <= reach**2).astype(np.uint8)
    where = np.rint(at[:, ::-1]).astype(np.intp)
    angles = corner_orientations(picture.grey, where, disc)
    return [float(angle) % 360 for angle in np.degrees(angles)]


def _places(points: Any) -> FloatArray:
    return np.array([point.pt for point in points], dtype=np.float64).reshape(-1, 2)


def _root(looks: NDArray[Any] | None) -> FloatArray:
    """RootSIFT (Arandjelović and Zisserman 2012): distances of the roots tell histograms better apart."""
    if looks is None:
        return np.empty((0, 128))
    share = looks / np.maximum(looks.sum(axis=1, keepdims=True), 1e-9)
    return np.asarray(np.sqrt(share), dtype=np.float64)
