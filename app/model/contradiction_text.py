"""Where two maps contradict each other, in words."""

from __future__ import annotations

from algorithms.verdict.contradictions import Contradiction, Contradictions

MOST_PLACES = 12  # that are listed, and ringed on the map; of the smaller ones the sum is given


def summary(found: Contradictions) -> str:
    """How many places there are, how much wall, and what is not listed."""
    if found.wall == 0:
        return "No wall of one map lies in the other's free floor."
    if not found.places:
        return f"{found.wall:.1f} m of wall contradict, in specks here and there."
    many = "one place" if len(found.places) == 1 else f"{len(found.places)} places"
    rest = sum(place.wall for place in found.places[MOST_PLACES:]) + found.small_parts
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
