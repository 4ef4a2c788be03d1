"""What a case is merged from: what its observation file says, what is drawn around its truth, or nothing."""

from __future__ import annotations

import zlib
from math import pi

from algorithms.common.errors import SettingError
from algorithms.files.case_folder import Case
from algorithms.observations.pair_problem import Known
from algorithms.simulator.portable_random import stream, uniform
from algorithms.simulator.rough_priors import Knowledge, met_at, rough_prior


def known_of(case: Case, knowledge: Knowledge) -> tuple[Known, ...]:
    """What a case is merged from.

    knowledge : "sighting": all that its observation file says; "none": nothing; "initial", "turn": a rough
                pose or a rough turn around the truth (σ 2 m and 10°), and nothing else. It depends on the
                case's name alone. Where no truth is known, or the maps share no place, it is drawn around a
                pose that puts robot 2 where it was seen, turned by chance
    raises    : SettingError where there is neither a truth nor a sighting to draw it from
    """
    if knowledge == "sighting":
        return case.known
    if knowledge == "none":
        return ()
    rng = stream(zlib.crc32(case.name.encode()), "knowledge")
    yaw = uniform(rng, -pi, pi)
    T = None if case.truth is None else case.truth.T_ref_mov
    if T is None:
        if not case.observations:
            raise SettingError(
                f"case {case.name} has neither a true transform nor a sighting, so that knowledge "
                f"{knowledge!r} cannot be drawn; add a truth.yaml"
            )
        T = met_at(case.observations[0], yaw)
    return rough_prior(T, knowledge, rng)
