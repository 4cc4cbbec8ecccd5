"""How large an error may be, and why.

Both libraries evaluate the same sums of products in different order.  A scaled error has three
causes: the constants (placements differ by some eps, since trigonometry of rpy is rounded), the
recursion (each of `depth` bodies multiplies by a rotation, adding some eps), and, where a linear
system is solved, the condition of the inertia matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..model.robot import Robot

EPS = float(np.finfo(float).eps)
CEILING = 1e-12  # of terms without a linear solve
PER_BODY = 64
"""Roundings of one step of a recursion, out and back: each way a 3x3 product of three terms a row
and a cross product, 8 roundings deep, in both libraries; and twice that, since what cancels may be
larger than what is left (velocities reach 2 pi, positions the length of the robot).  So it is for
the local Jacobian of a floating body, whose rate is zero: 50 digits and dualpin say 0, Pinocchio
leaves 1.5e-14 (bluevolta, 5000 samples, seed 11)."""


@dataclass(frozen=True)
class Tolerance:
    """Bounds on the scaled error, one for each sample, and the reason."""

    value: np.ndarray
    reason: str


def depth(robot: Robot) -> int:
    """The number of bodies on the longest path."""
    return max((sum(1 for _ in b.chain) for b in robot), default=1)


def recursion(robot: Robot, n: int) -> Tolerance:
    """PER_BODY roundings a body along the longest path, at most the ceiling."""
    bodies = depth(robot)
    value = min(CEILING, PER_BODY * EPS * (bodies + 1))
    return Tolerance(
        np.full(n, value), f"eps x {PER_BODY} roundings a body x {bodies} bodies and the base, at most {CEILING:g}"
    )


def logarithm(robot: Robot, turn: np.ndarray) -> Tolerance:
    """Of differences of configurations: the recursion's, and what cancels at planar joints.

    Pinocchio multiplies their translations by t sin t / (2 (1 - cos t)) for a turn t: the two roundings
    of cos t from products of (cos, sin) pairs are 4 eps / t^2 of 1 - cos t (50 digits show it).
    `turn` holds the planar joints' turns, shape (n, joints).
    """
    plain = recursion(robot, len(turn))
    if not turn.shape[1]:
        return plain
    lost = 4 * EPS / np.square(turn).min(axis=1)
    return Tolerance(plain.value + lost, plain.reason + ", + 4 eps / (planar turn)^2 of Pinocchio's 1 - cos")


def weighing(robot: Robot, positions: np.ndarray, energy: np.ndarray) -> Tolerance:
    """Of a sum of weights times heights that may cancel: the recursion's, of sum |m| |g| |p| instead of the sum.

    positions: (n, njoints, 3) of the bodies' frames.
    """
    g = float(np.linalg.norm([float(x) for x in robot.gravity]))
    mass = np.array([float(b.inertia.mass) for b in robot])
    moment = np.array([np.linalg.norm([float(x) for x in b.inertia.moment]) for b in robot])
    weights = g * (np.linalg.norm(positions, axis=-1) @ mass + moment.sum())
    cancelled = np.maximum(1.0, weights / np.maximum(1.0, np.abs(energy)))
    value = np.minimum(CEILING, recursion(robot, len(energy)).value * cancelled)
    reason = "the recursion's x sum |m g p| / |sum m g p|, since heights of both signs cancel"
    return Tolerance(value, f"{reason}, at most {CEILING:g}")


SINGULAR = 1 / (64 * EPS)
"""A scaled condition number from which M is singular to working precision: nothing is left to compare."""


class MassMatrices:
    """M of a batch, and how well it can be solved with: each found once, when a term asks for it."""

    def __init__(self, M: np.ndarray) -> None:
        self.M = M

    @cached_property
    def condition(self) -> np.ndarray:
        return condition(self.M)

    @cached_property
    def inverse(self) -> np.ndarray:
        """|M^-1|; no numbers where elimination finds M singular."""
        good = np.isfinite(self.M).all(axis=(-2, -1))
        with np.errstate(all="ignore"):
            try:
                return np.abs(np.linalg.inv(np.where(good[:, None, None], self.M, np.nan)))
            except np.linalg.LinAlgError:  # some are: they are found by their eigenvalues
                good &= condition(self._scaled) < SINGULAR
                inverse = np.linalg.inv(np.where(good[:, None, None], self.M, np.eye(self.M.shape[-1])))
                return np.where(good[:, None, None], np.abs(inverse), np.nan)

    @cached_property
    def hopeless(self) -> np.ndarray:
        """Where M is singular to working precision, whatever its units.

        The condition number of D^-1/2 M D^-1/2, D = diag M, is what remains when units do not matter.
        It is at most the product of the row-sum norms of that matrix and its inverse; where this
        does not settle it, eigenvalues do.
        """
        with np.errstate(all="ignore"):
            most = _row_sums(np.abs(self._scaled)) * _row_sums(self.inverse * self._units)
        hopeless = ~(most < SINGULAR)
        hopeless[hopeless] = ~(condition(self._scaled[hopeless]) < SINGULAR)
        return hopeless

    @cached_property
    def _units(self) -> np.ndarray:
        with np.errstate(all="ignore"):
            d = np.sqrt(np.diagonal(self.M, axis1=-2, axis2=-1))
        return d[:, :, None] * d[:, None, :]

    @cached_property
    def _scaled(self) -> np.ndarray:
        with np.errstate(all="ignore"):
            return self.M / self._units


def _row_sums(A: np.ndarray) -> np.ndarray:
    return A.sum(axis=-1).max(axis=-1, initial=0.0)


def inverse(robot: Robot, mass: MassMatrices) -> Tolerance:
    """Of M^-1: the recursion's error of M, times its condition number.

    Not the smaller one of M scaled to a unit diagonal, which our sparse factors follow: Pinocchio
    inverts the blocks of a floating base as they are, metres beside radians (50 digits show it).
    """
    value = recursion(robot, len(mass.M)).value * mass.condition
    return Tolerance(value, "the recursion's x cond(M)")


def solution(robot: Robot, mass: MassMatrices, forces: np.ndarray, a: np.ndarray) -> Tolerance:
    """Of a = M^-1 f, entry by entry:  |da| <= |M^-1| (|dM| |a| + |df|)  (Skeel 1979), or as `inverse`.

    |dM| and |df| are the recursion's relative error of M and of the forces that cancel in f.
    """
    with np.errstate(all="ignore"):
        load = forces + (np.abs(mass.M) @ np.abs(a)[..., None])[..., 0]
        error = (mass.inverse @ load[..., None])[..., 0].max(axis=-1, initial=0.0)
        relative = error / np.maximum(1.0, np.abs(a).max(axis=-1, initial=0.0))
    value = recursion(robot, len(mass.M)).value * np.maximum(mass.condition, relative)
    return Tolerance(value, "the recursion's x the larger of cond(M) and |M^-1| (|M| |a| + |forces|) / |a|")


def derivatives(robot: Robot, mass: MassMatrices, forces: np.ndarray, a: np.ndarray, X: np.ndarray) -> Tolerance:
    """Of X = M^-1 D, with D = d tau / d(q, v) at the acceleration a that was itself solved for.

    Two errors come through M^-1: the recursion's, of M and D, as in `inverse`; and that of D where a
    is off by da.  M da is no more than the recursion's error of the forces, and dM/dq is scaled as M
    is, so that M^-1 (dM/dq) da is of the size of da.
    """
    of_a = solution(robot, mass, forces, a).value * np.maximum(1.0, np.abs(a).max(axis=-1, initial=0.0))
    scale = np.maximum(1.0, np.abs(X).reshape(len(X), -1).max(axis=-1, initial=0.0))
    value = recursion(robot, len(X)).value * mass.condition + of_a / scale
    return Tolerance(value, "the recursion's x cond(M) + the error of the acceleration it is taken at")


def condition(M: np.ndarray) -> np.ndarray:
    """The condition number of symmetric M, by its eigenvalues; infinite where that is not finite."""
    if M.shape[-1] == 0:
        return np.ones(len(M))
    good = np.isfinite(M).all(axis=(-2, -1))
    with np.errstate(all="ignore"):
        sizes = np.abs(np.linalg.eigvalsh(np.where(good[:, None, None], M, 0.0)))
        least, most = sizes.min(axis=-1), sizes.max(axis=-1)
        return np.where(good & (least > 0), most / least, np.inf)
