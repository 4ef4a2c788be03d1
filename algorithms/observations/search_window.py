"""What the sightings leave of the shift: the paper's window, eqs. (6)–(10), and the coupled one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import hypot, inf, sqrt
from typing import Annotated, Literal

import numpy as np

from algorithms.common.pose import FloatArray, Pose2, chord
from algorithms.common.setting_bounds import Bounds, CheckedConfig
from algorithms.maps.grid_map import BoolArray
from algorithms.observations.observation import Encounter
from algorithms.observations.priors import Prior
from algorithms.observations.sighted_ring import SightedRing

LEAST_MARGIN = 1e-3  # metres; a robot on top of the other was seen with no lateral error at all

WindowTerm = Prior | SightedRing
"""What may keep a transform in the window besides sightings whose error is an ellipse."""


@dataclass(frozen=True)
class WindowConfig(CheckedConfig):
    """The window for the shift, eqs. (6)–(10), or the coupled window."""

    kind: Literal["coupled", "encounter", "origin"] = "encounter"
    """Coupled: for every turn only the disc in which the sighting leaves the seen robot. Encounter: the
    paper's window with its shift taken at the seen robot, a square around that disc. Origin: the paper's
    window as printed, for map 2's origin; it grows with the distance between that origin and the seen
    robot, which says nothing about the world."""
    margin: Annotated[float, Bounds(0, 10, 0.05, "m", "σ", "window margin")] = 0.1
    """What the sighting's own deviations do not tell: how well each robot knew where it stood, and how
    well its map fits there. The paper's window is wider by it on every side; in the coupled window it is
    one more standard deviation."""
    deviations: Annotated[float, Bounds(0, 10, 0.5, "σ", "k_σ", "sighting deviations")] = 3.0
    """How many standard deviations of range and bearing the window reaches."""


@dataclass(frozen=True, eq=False)
class Window:
    """Where T may put the pivot, whatever the turn.

    low, high : (2,) x, y; metres, ref frame. With the pivot at the mov frame's origin these are the
                bounds of (Δx, Δy)
    pivot     : (2,) metres, mov frame
    """

    low: FloatArray
    high: FloatArray
    pivot: FloatArray


@dataclass(frozen=True, eq=False)
class CoupledWindow:
    """All transforms that put every seen robot within k standard deviations of where it was seen.

    x̂1 = C(Δθ) x̂2 + Δ ties the shift to the turn: for every Δθ a disc (an ellipse) of shifts remains,
    of the size of the sighting's own error, however far away the origins of the maps lie.

    x_ref, x_mov : (S, 2) where the S robots were seen, in the ref and the mov frame; metres
    covariances  : (S, 2, 2) of x_ref − T x_mov; m²
    k            : how many standard deviations are let pass
    priors       : what else is known
    middles      : (2, 2) of what the ref and the mov map show; metres, each in its own frame. Where nobody
                   was seen they stand for the place where the maps meet
    """

    x_ref: FloatArray
    x_mov: FloatArray
    covariances: FloatArray
    k: float
    priors: tuple[WindowTerm, ...] = ()
    middles: FloatArray = field(default_factory=lambda: np.zeros((2, 2)))

    @property
    def pivot(self) -> FloatArray:
        """(2,) the first seen robot; metres, mov frame. The window is one for where T puts it."""
        return np.asarray(self.x_mov[0] if len(self.x_mov) else self.middles[1], dtype=np.float64)

    @property
    def place(self) -> FloatArray:
        """(2,) where the first robot was seen; metres, ref frame."""
        return np.asarray(self.x_ref[0] if len(self.x_ref) else self.middles[0], dtype=np.float64)

    @property
    def low(self) -> FloatArray:
        """(2,) lower edges of the rectangle around the pivot's disc; metres, ref frame."""
        return np.asarray(self.x_ref[0] - self._reach, dtype=np.float64)

    @property
    def high(self) -> FloatArray:
        """(2,) upper edges of the rectangle around the pivot's disc; metres, ref frame."""
        return np.asarray(self.x_ref[0] + self._reach, dtype=np.float64)

    @property
    def disc(self) -> float:
        """How far the pivot may lie from where it was seen; metres; endless where nobody was seen."""
        if not len(self.x_ref):
            return inf
        return float(self.k * sqrt(float(np.linalg.eigvalsh(self.covariances[0])[-1])))

    @property
    def _reach(self) -> FloatArray:
        return np.asarray(self.k * np.sqrt(np.diag(self.covariances[0])), dtype=np.float64)

    @cached_property
    def whitening(self) -> FloatArray:
        """(S, 2, 2): takes metres off a sighting to standard deviations off it."""
        return np.asarray(np.linalg.inv(np.linalg.cholesky(self.covariances)), dtype=np.float64)

    def deviations(self, poses: FloatArray) -> FloatArray:
        """(P, S + priors) standard deviations from every sighting and what else is known, of (P, 3) x, y,
        theta of T_ref_mov.
        """
        c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
        x, y = self.x_mov.T
        off = np.stack(
            [
                c * x - s * y + poses[:, 0, None] - self.x_ref[:, 0],
                s * x + c * y + poses[:, 1, None] - self.x_ref[:, 1],
            ],
            axis=-1,
        )
        seen = np.linalg.norm(np.einsum("sij,psj->psi", self.whitening, off), axis=-1)
        return np.column_stack([seen, *(prior.deviations(poses) for prior in self.priors)])

    def slack(self, shift: float, turn: float) -> FloatArray:
        """(S + priors,) bound of how far each deviation changes where the pivot moves by up to ``shift``
        metres and a transform turns by up to ``turn`` radians.
        """
        lever = np.linalg.norm(self.x_mov - self.pivot, axis=1)
        sharpest = np.linalg.norm(self.whitening, ord=2, axis=(1, 2))
        others = [prior.slack(shift, turn, self.pivot) for prior in self.priors]
        return np.append((shift + lever * chord(turn)) * sharpest, others)

    def pulled_in(self, T_ref_mov: Pose2) -> Pose2:
        """The transform, shifted straight towards the first sighting until it is in its disc."""
        off = T_ref_mov.apply(self.pivot) - self.x_ref[0]
        deviation = float(np.linalg.norm(self.whitening[0] @ off))
        if deviation <= self.k:
            return T_ref_mov
        x, y = (off * (1 - 0.999 * self.k / deviation)).tolist()
        return Pose2(T_ref_mov.x - x, T_ref_mov.y - y, T_ref_mov.theta)

    def contains(self, poses: FloatArray) -> BoolArray:
        """(P,) whether a transform is near enough to every sighting."""
        return np.asarray((self.deviations(poses) <= self.k).all(axis=1))


def paper_window(at: Encounter, config: WindowConfig) -> Window:
    """Shift window of eqs. (6)–(10): around x̂1, half as wide as x̂2 lies from the pivot, plus σ.

    ‖·‖ in (6) is the Euclidean norm: the turned vector's component can reach it, so the
    component-wise absolute value the print may be read as would cut the truth off.
    """
    pivot = np.zeros(2) if config.kind == "origin" else at.x_mov
    sigma = config.margin + config.deviations * np.sqrt(np.diag(at.covariance))
    reach = hypot(*(at.x_mov - pivot).tolist()) + sigma  # eqs. (6), (9), (10)
    return Window(at.x_ref - reach, at.x_ref + reach, pivot)  # eqs. (7), (8)


def coupled_window(
    encounters: Sequence[Encounter],
    config: WindowConfig,
    priors: tuple[WindowTerm, ...] = (),
    middles: FloatArray | None = None,
) -> CoupledWindow:
    """The window of all sightings; each counts with its own covariance and the margin's.

    priors, middles : as in CoupledWindow
    """
    margin = np.eye(2) * max(config.margin, LEAST_MARGIN) ** 2
    return CoupledWindow(
        x_ref=np.array([at.x_ref for at in encounters]).reshape(-1, 2),
        x_mov=np.array([at.x_mov for at in encounters]).reshape(-1, 2),
        covariances=np.array([at.covariance + margin for at in encounters]).reshape(-1, 2, 2),
        k=config.deviations,
        priors=priors,
        middles=np.zeros((2, 2)) if middles is None else middles,
    )


def shift_window(
    encounters: Sequence[Encounter], coupled: CoupledWindow, config: WindowConfig
) -> Window | CoupledWindow:
    """The window that the settings ask for; the paper's knows the first sighting only."""
    return coupled if config.kind == "coupled" else paper_window(encounters[0], config)
