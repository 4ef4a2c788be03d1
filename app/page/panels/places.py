"""The list of places where the maps contradict each other; a press on one goes there (map_comparison.js)."""

from __future__ import annotations

from algorithms.verdict.contradictions import Contradiction, Contradictions

MOST_PLACES = 12  # that are listed, and ringed on the map; the smaller ones are told in sum


def places_html(found: Contradictions, faded: bool = False) -> str:
    """HTML of the list, most wall first; faded and without effect where it is out of date."""
    dim = ' style="opacity:.4"' if faded else ""
    if not found.places:
        return f'<div class="mm-places"{dim}><p>{summary(found)}</p></div>'
    off = " disabled" if faded else ""
    rows = [
        f'<button type="button" data-mm-place="{n}" aria-pressed="false"{off} '
        f'title="Go there; press again for everything.">'
        f"<i>{n}</i><span>{place.wall:.1f} m</span><small>{whose(place)}</small>"
        f"<small>x {signed(place.x)}, y {signed(place.y)}</small></button>"
        for n, place in enumerate(found.places[:MOST_PLACES], 1)
    ]
    return f'<div class="mm-places"{dim}><p>{summary(found)}</p>{"".join(rows)}</div>'


def summary(found: Contradictions) -> str:
    """How many places there are, how much wall, and what is not listed."""
    many = len(found.places)
    if found.wall == 0:
        return "No wall of one map lies in the other's free floor."
    if not found.places:
        return f"{found.wall:.1f} m of wall contradict, in specks here and there."
    many = "one place" if len(found.places) == 1 else f"{len(found.places)} places"
    rest = sum(place.wall for place in found.places[MOST_PLACES:]) + found.specks
    further = f", and {rest:.1f} m in smaller patches" if rest >= 0.05 else ""
    return f"{found.wall:.1f} m of wall contradict: {many}{further}. Where, in metres of map 1's frame:"


def whose(place: Contradiction) -> str:
    """Whose wall it is that the other map denies."""
    if min(place.ref_wall, place.mov_wall) >= 0.2 * place.wall:
        return "both maps' wall"
    return "map 1's wall" if place.ref_wall > place.mov_wall else "map 2's wall"


def signed(metres: float) -> str:
    """A coordinate to a decimetre."""
    return f"{metres:.1f}".replace("-", "−")
