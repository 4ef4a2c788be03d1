"""What a person may know of how two maps lie: which kind of it is used, and its numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from algorithms.common.pose import Pose2, wrap_angle
from algorithms.observations.observation import Observation
from algorithms.observations.pair_problem import Known
from algorithms.observations.priors import InitialPose, NearPlace, Prior, TurnPrior

Choice = Literal["sighting", "initial", "turn", "near", "all", "nothing"]
"""Which kind of knowledge is used; all: whatever is there, together."""

KINDS: dict[Choice, type] = {
    "sighting": Observation,
    "initial": InitialPose,
    "turn": TurnPrior,
    "near": NearPlace,
}

PRIORS: tuple[Choice, ...] = ("initial", "turn", "near")
CHOICES: dict[Choice, str] = {
    "sighting": "a sighting",
    "initial": "a rough initial pose",
    "turn": "roughly the turn",
    "near": "a place in both maps",
    "all": "all of it together",
    "nothing": "nothing",
}
"""How each is called."""


def kind_of(known: Known) -> Choice:
    """Which kind one thing is of."""
    return next(choice for choice, kind in KINDS.items() if isinstance(known, kind))


def choice_of(known: Sequence[Known]) -> Choice:
    """The choice that uses all of that."""
    kinds = {kind_of(one) for one in known}
    return "all" if len(kinds) > 1 else kinds.pop() if kinds else "nothing"


def used(known: Sequence[Known], choice: Choice) -> tuple[Known, ...]:
    """Those that a choice uses."""
    if choice == "all":
        return tuple(known)
    return tuple(one for one in known if kind_of(one) == choice)


def counted(known: Sequence[Known]) -> str:
    """What is known, in words: "2 sightings, roughly the turn"."""
    kinds = Counter(kind_of(one) for one in known)
    parts = [
        f"{count} sightings" if kind == "sighting" and count > 1 else CHOICES[kind]
        for kind, count in kinds.items()
    ]
    return ", ".join(parts) or CHOICES["nothing"]


def numbers_of(prior: Prior) -> dict[str, float]:
    """Its numbers, as a person types them; metres, radians."""
    if isinstance(prior, InitialPose):
        pose = prior.pose
        sigma_xy = max(prior.sigma_x, prior.sigma_y)
        return {"x": pose.x, "y": pose.y, "yaw": pose.theta, "s_xy": sigma_xy, "s_yaw": prior.sigma_yaw}
    if isinstance(prior, TurnPrior):
        return {"yaw": prior.yaw, "s_yaw": prior.sigma}
    return {
        "x1": prior.ref_x,
        "y1": prior.ref_y,
        "x2": prior.mov_x,
        "y2": prior.mov_y,
        "radius": prior.radius,
    }


def with_number(prior: Prior, name: str, value: float) -> Prior:
    """The prior with one of ``numbers_of`` changed; raises SettingError where it cannot be that."""
    if isinstance(prior, InitialPose):
        if name == "s_xy":
            return replace(prior, sigma_x=value, sigma_y=value)
        if name == "s_yaw":
            return replace(prior, sigma_yaw=value)
        part = "theta" if name == "yaw" else name
        return replace(
            prior, pose=replace(prior.pose, **{part: wrap_angle(value) if name == "yaw" else value})
        )
    if isinstance(prior, TurnPrior):
        return replace(prior, sigma=value) if name == "s_yaw" else replace(prior, yaw=wrap_angle(value))
    names = {"x1": "ref_x", "y1": "ref_y", "x2": "mov_x", "y2": "mov_y", "radius": "radius"}
    return replace(prior, **{names[name]: value})


def laid(prior: Prior, T_ref_mov: Pose2) -> Prior:
    """The prior as it is once map 2 was laid so by hand."""
    if isinstance(prior, InitialPose):
        return replace(prior, pose=T_ref_mov)
    if isinstance(prior, TurnPrior):
        return replace(prior, yaw=T_ref_mov.theta)
    return prior
