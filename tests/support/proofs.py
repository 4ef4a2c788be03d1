"""Proofs made up in code: how one may have ended, for the tests of what is told and drawn of it."""

from __future__ import annotations

from dataclasses import replace
from math import inf, radians
from typing import Any

import numpy as np

from algorithms.optimisation.branch_and_bound import ProofState


def proof_state(**changes: Any) -> ProofState:
    """A proof that has come to its end: one answer of 20 m, one rival of 15 m."""
    state = ProofState(
        rival_sought=True,
        nodes=12_300,
        best=np.array([1.0, 2.0, 0.5]),
        best_value=20.0,
        ceiling=10.0,
        rivals=np.array([[1.0, 2.0, 0.5 - radians(178)]]),
        rival_values=np.array([15.0]),
        floor=10.0,
        turns=np.array([-2.0, 0.0, 2.0]),
        ceilings=np.array([20.0, 10.0, 9.0]),
        found=np.array([20.0, -inf, 8.0]),
        stopped="proven: 12,300 blocks bounded",
        proven=True,
    )
    return replace(state, **changes)


NO_ROBOTS: dict[str, Any] = {  # what a proof without an optimum changes of it
    "best": None,
    "best_value": -inf,
    "proven": False,
    "rivals": np.zeros((0, 3)),
    "rival_values": np.zeros(0),
}
