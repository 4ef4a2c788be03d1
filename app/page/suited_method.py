"""Which method suits what is known of two maps."""

from __future__ import annotations

from algorithms.common.errors import MapMergeError
from algorithms.methods.registry import DEFAULT_METHOD, METHODS, PLANE_METHOD, default_method
from algorithms.observations.pair_problem import PairProblem
from app.model.merge_inputs import MergeInputs


def suited_method(inputs: MergeInputs) -> str:
    """The method to begin with."""
    if inputs.ref is None or inputs.mov is None or not inputs.complete:
        return DEFAULT_METHOD
    try:
        return default_method(PairProblem.of(inputs.ref, inputs.mov, inputs.known))
    except MapMergeError:  # whoever merges is told what is wrong
        return DEFAULT_METHOD if inputs.observations else PLANE_METHOD


def following_method(method: str, before: MergeInputs, after: MergeInputs) -> str:
    """The method once the inputs were changed: the one that suits them, where the old one did suit those
    before, or cannot work with these; else it stays, since a person has chosen it.
    """
    helpless = METHODS[method].needs_sighting and after.complete and not after.observations
    return suited_method(after) if helpless or method == suited_method(before) else method
