"""A suggestion in words: what speaks for it, and what against."""

from __future__ import annotations

from math import degrees

from algorithms.methods.suggestions import Suggestion
from algorithms.verdict.probability_model import OTHERS, QUANTITIES
from app.model import verdict_text

NAMED = 2  # of what speaks against a suggestion


def place(suggestion: Suggestion) -> str:
    """Where it puts map 2."""
    T = suggestion.T_ref_mov
    return f"x {T.x:.2f} m, y {T.y:.2f} m, {degrees(T.theta):.1f}°"


def likely(suggestion: Suggestion) -> str:
    return verdict_text.likelihood(suggestion.probability)


def speaks_for(suggestion: Suggestion) -> str:
    """How much wall and floor agree."""
    seen = suggestion.weighed.evidence
    return f"{1 - seen.contradiction:.0%} of {seen.shared_wall:.0f} m of wall, {seen.floor:.0f} m² of floor"


def speaks_against(suggestion: Suggestion) -> str:
    """What weighs most against it; "nothing much" where nothing does."""
    names = [_called(name) for name in suggestion.against[:NAMED]]
    return ", ".join(names) or "nothing much"


def _called(name: str) -> str:
    return "other places fit, too" if name == OTHERS else TITLES[name]


TITLES = {name: quantity.title for name, quantity in QUANTITIES.items()} | {
    "across": "little wall across the others",
    "searched": "so many places were searched",
}
"""What speaks against, as a clause of few words."""
