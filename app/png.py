"""Pictures as PNG inside of an address, for a page that loads nothing."""

from __future__ import annotations

import base64
import io

import numpy as np
from PIL import Image

from app.render import Pixels, upright


def data_uri(pixels: Pixels) -> str:
    """A picture as a PNG inside an address; its colours are few, so an index is kept for each pixel.

    pixels : (H, W, 4) uint8, row 0 at the bottom
    """
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
