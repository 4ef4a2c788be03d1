"""Linear support vector machines on HOG windows, slid over an image pyramid: section III-A's detector."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from algorithms.common.errors import SettingError
from algorithms.common.pose import FloatArray
from algorithms.detection.detection import Detection, Picture, strongest
from algorithms.detection.hog_grid import Features, WindowShape, grey, hog_grid, scores, window_features
from algorithms.detection.mirrored_tags import tags_read_backwards
from algorithms.sensors.camera import Camera, check_image_size

WIDEST = 640  # pixels; larger images are made smaller first: time, and a robot at 5 m is as large in the view
STEP = 1.2  # from one size of the pyramid to the next
LEAST_PROBABILITY = 0.5
AROUND = 2  # cells added on every side: a robot that fills the image, or stands at its edge
MOST_FOUND = 128  # windows of one size that are looked at further


@dataclass(frozen=True, eq=False)
class DetectorModel:
    """A trained detector, as plain numbers.

    shape       : of the window
    labels      : names of the classes
    weights     : (classes, shape.length) of one machine per class, against everything that is no robot
    biases      : (classes,)
    calibration : (classes, 2) a, b of P = 1 / (1 + exp(−(a s + b))), s the machine's value (Platt)
    class_weights, class_biases : likewise, of the machines that tell the classes of robots apart
    raises      : SettingError
    """

    shape: WindowShape
    labels: tuple[str, ...]
    weights: Features
    biases: Features
    calibration: Features
    class_weights: Features
    class_biases: Features

    def __post_init__(self) -> None:
        classes = len(self.labels)
        wanted = {
            "weights": (self.weights, (classes, self.shape.length)),
            "biases": (self.biases, (classes,)),
            "calibration": (self.calibration, (classes, 2)),
            "class_weights": (self.class_weights, (classes, self.shape.length)),
            "class_biases": (self.class_biases, (classes,)),
        }
        for name, (array, size) in wanted.items():
            if array.shape != size or not np.isfinite(array).all():
                raise SettingError(f"the detector's {name} must be {size} finite numbers, not {array.shape}")
        if not classes:
            raise SettingError("the detector has no classes")


class SvmDetector:
    """Finds what a model was trained on."""

    def __init__(self, model: DetectorModel, least_probability: float = LEAST_PROBABILITY) -> None:
        if not 0 < least_probability < 1:
            raise SettingError(f"the least probability is {least_probability:g}; it must lie between 0 and 1")
        self.model = model
        self.least_probability = least_probability

    def detect(self, picture: Picture, camera: Camera | None = None) -> tuple[Detection, ...]:
        """Robots of at least the least probability, the likeliest first; one box each."""
        likely = [one for one in self.windows(picture) if one.probability >= self.least_probability]
        image = grey(picture)
        return tuple(
            replace(
                one,
                label=self._class_of(image, np.array(one.box())),
                is_mirrored=tags_read_backwards(picture, one.box()),
            )
            for one in strongest(likely)
        )

    def windows(self, picture: Picture) -> list[Detection]:
        """The likeliest windows of each size, also those that are no robot: before suppression."""
        height, width = picture.shape[:2]
        check_image_size(width, height, "the image")
        image, shape = grey(picture), self.model.shape
        scale = min(1.0, WIDEST / width)
        found: list[Detection] = []
        while True:
            size = max(1, round(width * scale)), max(1, round(height * scale))
            if size[0] < (shape.cols - AROUND) * shape.cell or size[1] < (shape.rows - AROUND) * shape.cell:
                return found
            smaller = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
            found += self._of_size(
                np.asarray(smaller, np.float32), np.array([width / size[0], height / size[1]] * 2)
            )
            scale /= STEP

    def _of_size(self, image: Features, stretch: FloatArray) -> list[Detection]:
        """Windows of one size; stretch: (4,) pixels of the picture per pixel of this image."""
        model, shape = self.model, self.model.shape
        pad = AROUND * shape.cell
        wider = np.asarray(cv2.copyMakeBorder(image, pad, pad, pad, pad, cv2.BORDER_REPLICATE), np.float32)
        values = scores(hog_grid(wider, shape.cell), shape, model.weights) + model.biases
        chances = 1 / (1 + np.exp(-(values * model.calibration[:, 0] + model.calibration[:, 1])))
        high, wide = shape.body
        edge = shape.border * shape.cell - pad
        likeliest = chances.max(axis=2)
        kinds = chances.argmax(axis=2)
        count = min(MOST_FOUND, likeliest.size)
        best = np.sort(np.argpartition(-likeliest, count - 1, axis=None)[:count])
        rows, cols = np.unravel_index(best, likeliest.shape)
        tops, lefts = rows * shape.cell + edge, cols * shape.cell + edge
        boxes = np.stack([lefts, tops, lefts + wide, tops + high], axis=1) * stretch - 0.5
        labels = [model.labels[kind] for kind in kinds[rows, cols]]
        return [
            Detection(left, top, right, bottom, chance, label)
            for (left, top, right, bottom), chance, label in zip(
                boxes.tolist(), likeliest[rows, cols].tolist(), labels, strict=True
            )
        ]

    def _class_of(self, image: Features, box: FloatArray) -> str:
        """What a robot in a (4,) box is; every machine against the background is nearly certain of it."""
        model = self.model
        values = model.class_weights @ window_features(image, box, model.shape) + model.class_biases
        return model.labels[int(np.argmax(values))]
