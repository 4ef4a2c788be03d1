"""What was found in an image, as HTML: the image with boxes to press, a line per box, the detector's view."""

from __future__ import annotations

import base64
from html import escape

from algorithms.detection.robot_sighting import Sighted, SightedRobots
from algorithms.files.camera_picture import picture_to_jpeg
from app.drawing.palette import Palette
from app.drawing.sighting_picture import STRIP, sighting_picture
from app.model.sighting.sighting_text import box_text, class_name, position_text
from app.model.status_text import typeset
from app.model.verdict_text import likelihood
from app.page.sighting.sighting_look import Look

LETTERS = 32  # pixels of the picture, which is shown at less than half of its size
OTHER = "Press a box, here or in the image, to take that one."
SCAN_SAYS = "The laser scan from above, robot 1 at the bottom."
HOG_SAYS = "The chosen box as the detector sees it, and its histograms of oriented gradients (HOG)."


def picture_html(look: Look, shown: int | None, palette: Palette) -> str:
    """HTML of the picture; its boxes are buttons, of which sighting.js tells.

    shown : number of the box that is looked at, from 0
    """
    sheet = sighting_picture(look.photo, look.seen, look.view, palette, look.width, LETTERS)
    high = look.height + (STRIP * look.width if look.view is not None else 0)
    spots = [_spot(number, one, look, high, number == shown) for number, one in enumerate(look.seen.sighted)]
    # the smaller one lies on top, or it could not be pressed
    order = sorted(range(len(spots)), key=lambda k: -look.seen.sighted[k].detection.width)
    words = "What robot 1's camera saw" + (", and below it the laser's points" if look.view else "")
    picture = f'<img alt="{escape(words)}" src="{_jpeg_uri(picture_to_jpeg(sheet))}">'
    return f'<div class="mm-seen">{picture}{"".join(spots[k] for k in order)}</div>'


def _spot(number: int, one: Sighted, look: Look, high: float, shown: bool) -> str:
    left, top, right, bottom = one.detection.box()
    left, right = max(0.0, left), min(float(look.width), right)
    top, bottom = max(0.0, top), min(float(look.height), bottom)
    places = {
        "left": left / look.width,
        "top": top / high,
        "width": (right - left) / look.width,
        "height": (bottom - top) / high,
    }
    style = ";".join(f"{side}:{100 * share:.2f}%" for side, share in places.items())
    return (
        f'<button type="button" class="mm-spot" data-mm-box="{number}" style="{style}" '
        f'aria-pressed="{str(shown).lower()}" {_named(number, one)}></button>'
    )


def _named(number: int, one: Sighted) -> str:
    words = escape(typeset(box_text(number + 1, one)))
    return f'title="{words}" aria-label="{words}"'


def boxes_html(seen: SightedRobots, shown: int | None, more: int) -> str:
    """HTML of a line per box, to be pressed: what it is, and where the robot is or why it is refused."""
    lines = [f'<p class="mm-aside">{OTHER}</p>'] if len(seen.sighted) > 1 else []
    for number, one in enumerate(seen.sighted):
        state = "chosen" if number == seen.chosen else "possible" if one.position is not None else "refused"
        says = position_text(one.position) if one.position is not None else f"Refused: {one.why_not}."
        lines.append(
            f'<button type="button" class="mm-found" data-mm-box="{number}" data-state="{state}" '
            f'aria-pressed="{str(number == shown).lower()}"><b>{number + 1}</b><span>'
            f"<em>{escape(class_name(one.detection.label))}</em> "
            f"{escape(likelihood(one.detection.probability))}<small>{escape(typeset(says))}</small></span></button>"
        )
    if more:
        lines.append(f'<p class="mm-aside">{more} more are less likely still.</p>')
    return "".join(lines)


def scan_html(svg: str) -> str:
    """HTML of the drawing of a scan."""
    return f'<div class="mm-above">{svg}<p class="mm-aside">{SCAN_SAYS}</p></div>'


def gradients_html(pair: tuple[bytes, bytes]) -> str:
    """HTML of a box as the detector sees it: two JPEGs side by side."""
    names = "The box in the detector's own size", "Its gradients"
    shown = "".join(
        f'<img alt="{escape(name)}" src="{_jpeg_uri(jpeg)}">' for name, jpeg in zip(names, pair, strict=True)
    )
    return f'<div class="mm-hog">{shown}<p class="mm-aside">{HOG_SAYS}</p></div>'


def _jpeg_uri(jpeg: bytes) -> str:
    return "data:image/jpeg;base64," + base64.b64encode(jpeg).decode()
