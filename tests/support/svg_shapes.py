"""What is drawn in an SVG, by its colour: pixels of the sheet, y down."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np

from app.drawing.palette import Rgb, css

SVG = "{http://www.w3.org/2000/svg}"


def words(drawn: str) -> list[str]:
    """All text of a picture."""
    return [each.text or "" for each in ElementTree.fromstring(drawn).iter(f"{SVG}text")]


def lines(drawn: str, colour: Rgb) -> list[np.ndarray]:
    """(N, 2) points of each path that is drawn in a colour, filled or not."""
    paths = ElementTree.fromstring(drawn).iter(f"{SVG}path")
    mine = [path.get("d") for path in paths if css(colour) in (path.get("stroke"), path.get("fill"))]
    return [np.array(re.findall(r"-?[\d.]+", way), dtype=float).reshape(-1, 2) for way in mine]


def dots(drawn: str, colour: Rgb) -> np.ndarray:
    """(N, 2) middles of the dots and rings of a colour."""
    circles = ElementTree.fromstring(drawn).iter(f"{SVG}circle")
    mine = [each for each in circles if css(colour) in (each.get("fill"), each.get("stroke"))]
    return np.array([(float(each.get("cx")), float(each.get("cy"))) for each in mine]).reshape(-1, 2)
