"""What a method maximises, as a person reads it: Γ of eq. (17), metres of wall that agree, or its own."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

from algorithms.methods.baselines.carpin_spectra import CarpinConfig
from algorithms.methods.baselines.feature_matching import FeatureConfig
from algorithms.methods.baselines.mse_registration import MseConfig
from algorithms.methods.baselines.phase_correlation import PhaseCorrelationConfig
from algorithms.methods.plane_method import PlaneMethodConfig


@dataclass(frozen=True)
class ObjectiveLabel:
    """Words for the value of a transform.

    name : in a sentence, and above a chart
    row  : beside a number in a table, its unit included
    unit : behind a number in a sentence; empty where there is none
    """

    name: str
    row: str
    unit: str

    def number(self, value: float) -> str:
        """The value without its unit; a dash where no transform in the window was met (−inf)."""
        if not isfinite(value):
            return "–"
        return (f"{value:.1f}" if self.unit else f"{value:.4g}").replace("-", "−")

    def text(self, value: float) -> str:
        number = self.number(value)
        return f"{number} {self.unit}" if self.unit and number != "–" else number


GAMMA = ObjectiveLabel("Γ", "Γ, eq. (17)", "")
AGREEMENT = ObjectiveLabel("agreement", "agreement (m of wall)", "m")


_SIMILARITY = ObjectiveLabel("similarity", "similarity (1 − MSE)", "")
_OWN = {
    FeatureConfig: ObjectiveLabel("agreeing matches", "matches that agree", ""),
    MseConfig: _SIMILARITY,
    PhaseCorrelationConfig: _SIMILARITY,
    PlaneMethodConfig: AGREEMENT,
    CarpinConfig: ObjectiveLabel("acceptance index", "acceptance index of the search", ""),
}


def measure_of(config: Any) -> ObjectiveLabel:
    """What the method with this config maximises; one without an objective says nothing of it."""
    for kind, measure in _OWN.items():
        if isinstance(config, kind):
            return measure
    objective = getattr(getattr(config, "refine", None), "objective", "gamma")
    return AGREEMENT if objective == "agreement" else GAMMA
