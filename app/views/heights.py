"""The augmented maps as heights over the floor, as in the paper's Fig. 4."""

from __future__ import annotations

import numpy as np
import viser

from algorithms.augment import AugmentedMap
from algorithms.pose import FloatArray
from algorithms.steps import AugmentDetail
from app.palette import Palette, viridis
from app.stage import Stage, path

TALLEST = 0.22  # of the shown radius: height of a wall with the highest level there is
VISIBLE = 0.01  # of the peak; lower walls are left flat
MOST_BARS = 12_000  # of one map; further ones are thinned out

_CUBE = np.array(
    [[x, y, z] for y in (0, 1) for z in (-0.5, 0.5) for x in (-0.5, 0.5)], dtype=np.float32
)  # stands on the floor
_FACES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ],
    dtype=np.uint32,
)


def bars(augmented: AugmentedMap, most: int = MOST_BARS) -> tuple[FloatArray, FloatArray]:
    """(N, 2) where bars stand, relative to x̂ in metres, and (N,) how high, as a share of the peak."""
    share = augmented.levels / augmented.peak
    keep = np.flatnonzero(share >= VISIBLE)
    keep = keep[:: max(1, -(-len(keep) // most))]
    return augmented.points[keep] - augmented.x_hat, share[keep]


class HeightsView:
    """Both maps side by side, each around its meeting place; y is up here."""

    def __init__(self, client: viser.ClientHandle, stage: Stage) -> None:
        self._scene, self._stage = client.scene, stage
        self._handles: list[viser.SceneNodeHandle] = []
        self._drawn: AugmentDetail | None = None

    def show(self, detail: AugmentDetail | None, palette: Palette, look: bool) -> None:
        """Draw the heights; ``look`` puts the camera before them."""
        if detail is None:
            self.hide()
            return
        radius = self._radius(detail)
        if self._drawn is not detail:
            self.hide()
            self._drawn = detail
            for name, augmented, side in (("1", detail.ref, -1.06), ("2", detail.mov, 1.06)):
                self._bars(name, augmented, np.array([side * radius, 0.0]), radius)
        self._stage.layer(
            "floor", [*self._floor(-1.06, radius, palette, 1), *self._floor(1.06, radius, palette, 2)]
        )
        if look:
            self._stage.look_at("heights", np.array([0.0, 0.1 * radius, 0.0]), 2.2 * radius, 0.95, 0.0)

    def hide(self) -> None:
        """Take everything away."""
        for handle in self._handles:
            handle.remove()
        self._handles.clear()
        self._drawn = None
        self._stage.layer("floor", None)

    @staticmethod
    def _radius(detail: AugmentDetail) -> float:
        reach = [np.abs(bars(side)[0]).max(initial=0.5) for side in (detail.ref, detail.mov)]
        return float(max(reach)) * 1.05

    def _bars(self, name: str, augmented: AugmentedMap, at: FloatArray, radius: float) -> None:
        where, share = bars(augmented)
        if len(share) == 0:
            return
        cell = augmented.grid.resolution
        place = np.column_stack([where[:, 0] + at[0], np.zeros(len(share)), -where[:, 1]])
        size = np.column_stack(
            [np.full(len(share), cell), share * TALLEST * 2 * radius, np.full(len(share), cell)]
        )
        # the page's frame is turned half round y against viser's: see views/maps.py
        self._handles.append(
            self._scene.add_batched_meshes_simple(
                f"/world/heights/{name}",
                _CUBE,
                _FACES,
                batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (len(share), 1)),
                batched_positions=place,
                batched_scales=size,
                batched_colors=viridis(share),
                lod="off",
                flat_shading=True,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
            )
        )

    @staticmethod
    def _floor(side: float, radius: float, palette: Palette, number: int) -> list[dict[str, object]]:
        x = side * radius
        corners = np.array(
            [[x + i * radius, 0.0, j * radius] for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        )
        colour = palette.ref if number == 1 else palette.mov
        front = np.array([x - radius, 0.0, radius])
        high = np.array([[x - radius, 0.0, -radius], [x - radius, TALLEST * 2 * radius, -radius]])
        return [
            path(
                corners,
                palette.margin,
                close=True,
                w=1,
                fill="rgba(255,255,255,.0)",
                tp=front,
                t=f"map {number}, {2 * radius:.0f} m wide",
                tc=f"rgb{colour}",
                size=13,
                dy=16,
                dx=4,
            ),
            path(high, palette.margin, w=1.5, tp=high[1], t="peak level", dx=6, tc=f"rgb{palette.text}"),
        ]
