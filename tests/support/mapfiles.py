"""Map files drawn in code: a YAML file and images of every kind, right unless told otherwise."""

from __future__ import annotations

import io
from pathlib import PurePath

import numpy as np
import yaml
from PIL import Image

from algorithms.common.pose import Pose2
from algorithms.files.images.thresholds import Shading
from algorithms.files.map_file import grey_image, map_from_bytes
from algorithms.maps.grid_map import GridMap

HEADER = {
    "image": "m.pgm",
    "resolution": 0.05,
    "origin": [1.0, -2.0, 0.5],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def header(**changes: object) -> bytes:
    """A map's YAML file; a value of None leaves its key out."""
    values = {**HEADER, **changes}
    return yaml.safe_dump({k: v for k, v in values.items() if v is not None}).encode()


def pgm(pixels: object, kind: bytes = b"P5", maxval: int = 255) -> bytes:
    grey = np.asarray(pixels, dtype=np.uint8)
    head = b"%s\n%d %d\n%d\n" % (kind, grey.shape[1], grey.shape[0], maxval)
    if kind == b"P2":
        return head + b" ".join(b"%d" % value for value in grey.ravel().tolist()) + b"\n"
    return head + grey.tobytes()


def encoded(image: Image.Image, kind: str, **options: object) -> bytes:
    stream = io.BytesIO()
    image.save(stream, kind, **options)
    return stream.getvalue()


def load(data: bytes, **changes: object) -> GridMap:
    return map_from_bytes("m.yaml", header(**changes), "m.pgm", data)


def cells(data: bytes, **changes: object) -> list[list[int]]:
    return load(data, **changes).cells.tolist()


def image_map_from_bytes(
    name: str, data: bytes, resolution: float, origin: Pose2 | None = None, shading: Shading | None = None
) -> GridMap:
    """What the image of an upload shows, with what a YAML file would say given by the test."""
    cells, told = grey_image(name, data).read(shading or Shading())
    return GridMap(cells, resolution, origin or Pose2(), PurePath(name).stem, told)
