"""Pictures as PNG in letters, for a page that loads nothing."""

from __future__ import annotations

import base64
import io

import cv2
import numpy as np
from PIL import Image

from app.drawing.grid_pixels import Pixels, upright


def data_uri(pixels: Pixels) -> str:
    """(H, W, 4) pixels, row 0 at the bottom, as a PNG in an address; few colours are kept by an index."""
    flat = np.ascontiguousarray(upright(pixels)).view(np.uint32)[..., 0]
    colours, index = np.unique(flat, return_inverse=True)
    packed = io.BytesIO()
    if len(colours) <= 256:
        rgba = colours.view(np.uint8).reshape(-1, 4)
        image = Image.fromarray(index.reshape(flat.shape).astype(np.uint8))
        image.putpalette(rgba[:, :3].tobytes())
        bits = next(bits for bits in (1, 2, 4, 8) if len(colours) <= 2**bits)
        image.save(packed, "PNG", optimize=True, bits=bits, transparency=rgba[:, 3].tobytes())
    else:
        Image.fromarray(upright(pixels)).save(packed, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(packed.getvalue()).decode()


def png_base64(pixels: Pixels) -> str:
    """(H, W, 3 or 4) a picture as a PNG in base64, made in a hurry; row 0 comes first, as it is."""
    return base64.b64encode(png_bytes(pixels)).decode()


def png_bytes(pixels: Pixels) -> bytes:
    """(H, W, 3 or 4) a picture as a PNG; row 0 comes first, as it is."""
    order = cv2.COLOR_RGBA2BGRA if pixels.shape[2] == 4 else cv2.COLOR_RGB2BGR
    done, packed = cv2.imencode(".png", cv2.cvtColor(pixels, order))
    assert done  # only a picture without pixels cannot be packed
    return packed.tobytes()
