"""What a map's YAML file would say, filled in by hand for an image that came without one.

The form makes that YAML file; from there on the map is one like any other.
"""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from math import degrees, radians
from pathlib import PurePath
from threading import RLock
from typing import Any

import numpy as np
import viser

from algorithms.common.errors import SettingError
from algorithms.common.pose import Pose2
from algorithms.files.images.grey_levels import MOST_WALL
from algorithms.files.images.thresholds import MODES, Shading
from algorithms.files.map_file import GreyImage, MapMeta, grey_image, meta_to_bytes, parse_meta
from algorithms.maps.grid_map import COARSEST, FARTHEST, FINEST, OCCUPIED_FROM, CellArray
from app.drawing import grid_pixels as render
from app.drawing.palette import LIGHT, QUIET, Rgb, css
from app.drawing.png import data_uri
from app.model.merge_inputs import Upload
from app.page.panels.html_widgets import box, on_press, put

RESOLUTION = 0.05  # metres per cell: what most robots' maps have
PREVIEW = 280  # pixels of a side at most: as wide as the panel, so that every pixel is a square of its own
LEAST_FREE = 0.02  # a share that no map of a building has

Shares = tuple[float, float, float]  # wall, free, neither

WHAT_IT_MEANS = {
    "trinary": "Wall, free or unknown, by the two limits. What most maps are.",
    "scale": "Between the limits a cell is so much a wall; the method takes such a cell for unknown.",
    "raw": "The grey is the occupancy, 0 to 100; above it is unknown.",
}

# every pixel a square with hard edges, however wide the panel is
_FRAME = (
    'style="display:block;width:calc(100% - 20px);max-height:240px;object-fit:contain;margin:4px 10px;'
    f"image-rendering:pixelated;background:{css(LIGHT.unknown)};border:1px solid rgba(107,114,128,.4);"
    'border-radius:4px"'
)
_SWATCH = "display:inline-block;width:10px;height:10px;margin-right:4px;border:1px solid rgba(107,114,128,.6)"


class ImageForm:
    """The form of one map. ``use`` gets the YAML file it makes, ``save`` the same to be downloaded."""

    def __init__(
        self,
        gui: viser.GuiApi,
        number: int,
        turn: RLock,
        use: Callable[[Upload], None],
        save: Callable[[str, bytes], None],
    ) -> None:
        self._turn, self._use, self._save = turn, use, save
        self._colour: Rgb = (LIGHT.ref, LIGHT.mov)[number - 1]
        self._image: Upload | None = None
        self._grey: GreyImage | None = None
        self._used: bytes | None = None  # the file that the map on the page was made with
        self._folder = gui.add_folder(f"Map {number}: what the image means", visible=False)
        with self._folder:
            self._about = gui.add_html("")
            self._picture = gui.add_html("")
            self._says = gui.add_html("")
            hint = "Metres per pixel. 0.05 m is usual; a wrong one makes a wrong merge."
            wide: Any = {"min": FINEST, "max": COARSEST, "step": 0.0001}
            self._resolution = gui.add_number("resolution (m)", RESOLUTION, hint=hint, **wide)
            corner = "of the image's lower left corner, in this robot's own frame. 0 where nobody knows."
            wide = {"min": -FARTHEST, "max": FARTHEST, "step": 0.0001}
            self._x = gui.add_number("origin x (m)", 0.0, hint=f"x {corner}", **wide)
            self._y = gui.add_number("origin y (m)", 0.0, hint=f"y {corner}", **wide)
            hint = f"Turn {corner} Counter-clockwise."
            self._yaw = gui.add_number("yaw (°)", 0.0, min=-180.0, max=180.0, step=0.001, hint=hint)
            self._mode = gui.add_dropdown("mode", MODES, hint="How the grey of a pixel is read.")
            usual = Shading()
            share: Any = {"min": 0.0, "max": 1.0, "step": 0.001}
            hint = "occupied_thresh: a pixel at least so dark is wall; 0 is white, 1 is black."
            start = usual.occupied_thresh
            self._occupied = gui.add_slider("wall from", initial_value=start, hint=hint, **share)
            hint = "free_thresh: a pixel at most so dark is free floor. Between the two: unknown."
            self._free = gui.add_slider("free up to", initial_value=usual.free_thresh, hint=hint, **share)
            self._negate = gui.add_checkbox("negate", False, hint="White is wall and black is free.")
            self._go = gui.add_button("Use this map", color=LIGHT.ref)
            hint = "The file that belongs to this image, for map_server, Nav2 and mapmeld."
            icon = viser.Icon.DOWNLOAD
            self._file = gui.add_button("Download YAML", icon=icon, color=QUIET, hint=hint)
        limits = self._mode, self._occupied, self._free, self._negate
        self._widgets: tuple[Any, ...] = (self._resolution, self._x, self._y, self._yaw, *limits)
        for widget in self._widgets:
            widget.on_update(lambda _: self._changed())
        on_press((self._go, self._taken), (self._file, self._download))

    # --- what it is asked ---------------------------------------------------------------------------

    def show(self, image: Upload | None, text: Upload | None, decoded: GreyImage | None) -> None:
        """Offer the form for an image whose YAML file is missing or was made here; else put it away.

        decoded : the image, where it has just been; raises MapMergeError where it was not, and cannot be
        """
        if image is None or (text is not None and not text.by_form):
            self._image = self._grey = self._used = None
            self._folder.visible = False
            return
        grey = decoded or (self._grey if image == self._image else None)
        if grey is None:
            grey = grey_image(image.name, image.content)
        self._image, self._grey, self._used = image, grey, None
        if text is not None:
            self._used = text.content
            self._write(parse_meta(text.name, text.content))
        self._folder.visible = True
        self._draw()

    @property
    def meta(self) -> MapMeta:
        """What is filled in; raises SettingError where that cannot be."""
        assert self._image is not None
        numbers = self._resolution, self._x, self._y, self._yaw, self._occupied, self._free
        resolution, x, y, yaw, occupied, free = (round(float(number.value), 6) for number in numbers)
        shading = Shading(bool(self._negate.value), occupied, free, self._mode.value)
        if resolution <= 0:
            raise SettingError(f"resolution is {resolution:g} m/cell; give a positive number, e.g. 0.05")
        return MapMeta(self._image.name, resolution, Pose2(x, y, radians(yaw)), shading)

    # --- what a person does -------------------------------------------------------------------------

    def _changed(self) -> None:
        with self._turn:
            if self._image is not None:
                self._draw()

    def _taken(self) -> None:
        with self._turn:
            made = self._made()
            if made is not None:
                self._use(made)

    def _download(self) -> None:
        with self._turn:
            made = self._made()
        if made is not None:
            self._save(made.name, made.content)

    def _made(self) -> Upload | None:
        """The YAML file, where what is filled in makes one."""
        if self._image is None:
            return None
        try:
            return Upload(f"{PurePath(self._image.name).stem}.yaml", meta_to_bytes(self.meta), by_form=True)
        except SettingError:
            return None  # it is said below the picture

    # --- drawing ------------------------------------------------------------------------------------

    def _write(self, meta: MapMeta) -> None:
        """Fill in what a file of this form says; the angle is kept in radians there."""
        o, shading = meta.origin, meta.shading
        values = (meta.resolution, o.x, o.y, round(degrees(o.theta), 6), shading.mode)
        wanted = (*values, shading.occupied_thresh, shading.free_thresh, shading.negate)
        for widget, value in zip(self._widgets, wanted, strict=True):
            put(widget, value=value)

    def _draw(self) -> None:
        raw = self._mode.value == "raw"
        for widget in (self._occupied, self._free, self._negate):
            put(widget, visible=not raw)
        about = f"{self._image.name} came without a YAML file. Give its values here, or load that file."
        self._about.content = _small(f"{about} {WHAT_IT_MEANS[self._mode.value]}")
        try:
            meta = self.meta
        except SettingError as error:
            self._says.content = box(str(error), "refused")
            self._go.disabled = self._file.disabled = True
            return
        cells, remarks = self._grey.read(meta.shading)
        picture = render.sheet(cells, self._colour, LIGHT, PREVIEW)
        self._picture.content = f'<img alt="what each pixel means" src="{data_uri(picture.pixels)}" {_FRAME}>'
        used = self._used == meta_to_bytes(meta)
        note = "In use." if used else "Not in use yet." if self._used is None else "Changed: not in use yet."
        share = shares(cells)
        noticed = " ".join(f"{say[:1].upper()}{say[1:]}." for say in remarks)
        doubt = doubt_about(share, meta.shading) or noticed
        counted = _counted(share, cells.shape, meta.resolution, self._colour)
        self._says.content = counted + _small(note) + (box(doubt, "refused") if doubt else "")
        self._file.disabled = False
        self._go.disabled = used


def shares(cells: CellArray) -> Shares:
    """How much of a map is wall, free, and neither; they sum to 1."""
    wall, free = float(np.mean(cells >= OCCUPIED_FROM)), float(np.mean(render.is_free(cells)))
    return wall, free, 1.0 - wall - free


def doubt_about(share: Shares, shading: Shading) -> str:
    """What is odd about a reading of an image, as a sentence; empty where nothing is."""
    wall, free, _ = share
    if wall > MOST_WALL:
        odd, remedy = "More than half of it is wall.", "Is white the wall here? Then tick negate."
        if shading.negate:
            remedy = "Is black the wall here? Then take negate away."
    elif wall == 0:
        odd = "There is no wall in it: nothing could be merged."
        remedy = "Move “wall from” to the left."
    elif free < LEAST_FREE:
        odd, remedy = "Hardly anything of it is free floor.", "Move “free up to” to the right."
    else:
        return ""
    return f"{odd} {'Try another mode.' if shading.mode == 'raw' else remedy}"


def _counted(share: Shares, shape: tuple[int, ...], resolution: float, colour: Rgb) -> str:
    height, width = shape
    kinds = zip(("wall", "free", "unknown"), (colour, LIGHT.free, LIGHT.unknown), share, strict=True)
    chips = ""
    for name, tint, part in kinds:
        swatch = f'<i style="{_SWATCH};background:{css(tint)}"></i>'
        chips += f'<span style="white-space:nowrap;margin-right:10px">{swatch}{name} {part:.1%}</span>'
    size = f"{width} × {height} cells: {width * resolution:.1f} m × {height * resolution:.1f} m"
    return f'<div style="margin:2px 10px;font-size:12.5px;line-height:1.6">{chips}<br>{size}</div>'


def _small(text: str) -> str:
    return f'<div style="margin:4px 10px;font-size:12px;line-height:1.4;opacity:.8">{escape(text)}</div>'
