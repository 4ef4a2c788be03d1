"""The settings of the spectra method: a frozen config per stage, and the one that holds them all."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal

from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.map_fusion import ConflictRule
from algorithms.observations.search_window import WindowConfig
from algorithms.optimisation.branch_and_bound import ProofConfig
from algorithms.optimisation.likelihood_field import AgreementConfig
from algorithms.optimisation.objective import Lookup
from algorithms.optimisation.particle_swarm import SwarmConfig
from algorithms.optimisation.search_box import BoxConfig
from algorithms.spectra.augmented_map import AugmentConfig
from algorithms.spectra.candidates import CandidateConfig
from algorithms.spectra.hough_spectra import SpectraConfig
from algorithms.verdict.decision import VerdictConfig


@dataclass(frozen=True)
class RefineConfig(CheckedConfig):
    """Which optimiser refines, and how many of the candidates."""

    optimiser: Literal["pso", "mco", "none"] = "pso"
    """PSO: a swarm that talks. MCO: independent samples. None: the spectra's own answers, as they are."""
    lookup: Lookup = Lookup.BILINEAR
    """Bilinear is smooth between cells; nearest is the paper's raster."""
    candidates: Annotated[int, Bounds(1, 24, 1, "", "", "refined")] = 4
    """How many of the best candidates the optimiser works on."""
    objective: Literal["gamma", "agreement"] = "gamma"
    """Gamma: eq. (17), ink on ink. Agreement: walls that coincide, less walls in the other's free floor."""


@dataclass(frozen=True)
class PipelineConfig:
    """All settings of the method, a group per stage."""

    augment: AugmentConfig = field(default_factory=AugmentConfig)
    spectra: SpectraConfig = field(default_factory=SpectraConfig)
    candidates: CandidateConfig = field(default_factory=CandidateConfig)
    window: WindowConfig = field(default_factory=WindowConfig)
    box: BoxConfig = field(default_factory=BoxConfig)
    swarm: SwarmConfig = field(default_factory=SwarmConfig)
    refine: RefineConfig = field(default_factory=RefineConfig)
    agreement: AgreementConfig = field(default_factory=AgreementConfig)
    proof: ProofConfig = field(default_factory=ProofConfig)
    verdict: VerdictConfig = field(default_factory=VerdictConfig)
    whole_maps: bool = False
    """Hold the best few answers against the walls of the whole maps, and name the likeliest: what lies around
    the encounter looks like many other places, and bent maps fit there alone."""
    conflict: ConflictRule = ConflictRule.OCCUPIED_WINS
    """Which map is believed where one says wall and the other says free."""
