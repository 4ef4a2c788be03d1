"""The augmented maps as heights over the floor, as in the paper's Fig. 4."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from algorithms.common.pose import FloatArray
from algorithms.methods.steps import AugmentDetail
from algorithms.spectra.augmented_map import AugmentedMap
from app.drawing.browser_messages import BrowserMessages
from app.drawing.draw_items import Item, path
from app.drawing.palette import Palette, css, level_colours

TALLEST = 0.3  # of the shown radius: height of a wall with the highest level there is
VISIBLE = 0.01  # of the peak; lower walls are left out, or flat
FEW = 20  # walls that stand out; where there are no more, the flat ones are drawn, too
APART = 1.12  # of the shown radius: how far each map's middle lies from the scene's
MOST_BARS = 12_000  # of one map; further ones are thinned out


def bars(augmented: AugmentedMap, most: int = MOST_BARS) -> tuple[FloatArray, FloatArray]:
    """(N, 2) where bars stand, relative to x̂ in metres, and (N,) how high, as a share of the peak."""
    share = augmented.levels / augmented.peak
    keep = np.flatnonzero(share >= VISIBLE)
    keep = keep if len(keep) > FEW else np.arange(len(share))
    keep = keep[:: max(1, -(-len(keep) // most))]
    return augmented.points[keep] - augmented.x_hat, share[keep]


def linear(colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """sRGB colours as the renderer wants them at a line's ends: it brightens what it is given."""
    return np.asarray(np.round(255 * (colours / 255.0) ** 2.2), dtype=np.uint8)


class HeightsView:
    """Both maps, one behind the other, each around its meeting place; y is up here."""

    def __init__(self, client: viser.ClientHandle, messages: BrowserMessages) -> None:
        self._scene, self._messages = client.scene, messages
        self._handles: list[viser.SceneNodeHandle] = []
        self._drawn: tuple[AugmentDetail, Palette] | None = None
        self._looked = False  # whether the camera was put before these maps

    def show(self, detail: AugmentDetail | None, palette: Palette, look: bool) -> None:
        """Draw the heights; ``look`` puts the camera before them, and so do the first ones of these maps."""
        if detail is None:
            self._clear()
            return
        reach = [np.abs(bars(side)[0]).max(initial=0.5) for side in (detail.ref, detail.mov)]
        radius = float(max(reach)) * 1.05
        if self._drawn != (detail, palette):
            self._clear()
            self._drawn = detail, palette
            for name, augmented, side in (("1", detail.ref, -1.0), ("2", detail.mov, 1.0)):
                self._bars(name, augmented, side * APART * radius, radius, palette)
        self._messages.layer("floor", _floor(-1, radius, palette, 1) + _floor(1, radius, palette, 2))
        if look or not self._looked:
            self._looked = True
            self._messages.look_at("heights", np.array([0.0, 0.12 * radius, 0.0]), 1.62 * radius, 0.92, 0.0)

    def hide(self) -> None:
        """Another view is shown, or there are other maps."""
        self._clear()
        self._looked = False

    def _clear(self) -> None:
        for handle in self._handles:
            handle.remove()
        self._handles.clear()
        self._drawn = None
        self._messages.layer("floor", None)

    def _bars(self, name: str, augmented: AugmentedMap, away: float, radius: float, palette: Palette) -> None:
        """Unlit stems: a lit colour would no longer be the one of the scale."""
        where, share = bars(augmented)
        if len(share) == 0:
            return
        foot = np.column_stack([where[:, 0], np.zeros(len(share)), away - where[:, 1]])
        top = foot.copy()
        top[:, 1] = np.maximum(share, VISIBLE) * TALLEST * 2 * radius
        colours = linear(level_colours(np.stack([0.55 * share, share], axis=1), palette.dark))
        ends = np.stack([foot, top], axis=1).astype(np.float32)
        how: Any = {"thickness": augmented.grid.resolution, "thickness_units": "world"}
        self._handles.append(self._scene.add_line_segments(f"/world/heights/{name}", ends, colours, **how))


def _floor(side: int, radius: float, palette: Palette, number: int) -> list[Item]:
    z = side * APART * radius
    unit = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], dtype=float)
    corners = unit * radius + (0, 0, z)
    post = np.array([[-radius, 0, z - radius], [-radius, TALLEST * 2 * radius, z - radius]])
    name = {"t": f"map {number}: {2 * radius:.0f} m around robot 2", "tp": corners[3], "size": 13}
    return [
        path(corners, palette.margin, close=True, w=1, dy=14, dx=4, tc=css(palette.text), **name),
        path(post, palette.margin, w=1.5, tp=post[1], t="peak level", dx=6, tc=css(palette.text)),
    ]
