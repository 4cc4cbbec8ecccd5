"""Tolerances and their reasons.

Both libraries evaluate the same sums of products in different order.  A scaled error has four
causes: the constants (placements differ by some eps, since trigonometry of rpy is rounded), the
recursion (each of `depth` bodies multiplies by a rotation, adding some eps), what cancels on the way
(see `extent`), and, where a linear system is solved, the condition of the inertia matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..model.robot import Robot
from .extent import ORDINARY, Extent
from .tally import size

EPS = float(np.finfo(float).eps)
CEILING = 1e-12
"""Of terms without a linear solve: what is beyond it is decided by 50 digits, whatever cancels there.  Then an
error is one only beyond the rounding of what cancels (`Tolerance.rounding`)."""
PER_BODY = 64
"""Roundings of one step of a recursion, out and back: each way a 3x3 product of three terms a row
and a cross product, 8 roundings deep, in both libraries; and twice that, since summands may be
larger than their sum (velocities reach 2 pi, positions the length of the robot).  An example is
the local Jacobian of a floating body, whose rate is zero: 50 digits and dualpin say 0, Pinocchio
leaves 1.5e-14 (bluevolta, 5000 samples, seed 11)."""


@dataclass(frozen=True)
class Tolerance:
    """Bounds on the scaled error, one for each sample, and the reason.

    Attributes
    ----------
    unlimited : ndarray, optional
        The same without the ceiling.
    """

    value: np.ndarray
    reason: str
    unlimited: np.ndarray | None = None

    @property
    def rounding(self) -> np.ndarray:
        """What rounding explains, however large that is."""
        return self.value if self.unlimited is None else self.unlimited

    @property
    def empty(self) -> np.ndarray:
        """Where rounding may change an answer by as much as its size, or nobody knows: nothing can be compared."""
        return np.asarray(~(self.value < 1.0))


def _limited(value: np.ndarray, reason: str) -> Tolerance:
    return Tolerance(np.minimum(CEILING, value), f"{reason}, at most {CEILING:g}", value)


def depth(robot: Robot) -> int:
    """The number of bodies on the longest path."""
    return max((sum(1 for _ in b.chain) for b in robot), default=1)


def rounding(robot: Robot) -> float:
    """PER_BODY roundings a body along the longest path, at most the ceiling."""
    return min(CEILING, PER_BODY * EPS * (depth(robot) + 1))


def recursion(robot: Robot, n: int, sizes: np.ndarray | None = None, reference: np.ndarray | None = None) -> Tolerance:
    """The rounding, times what adds up over what is left of it (see `extent`), at most the ceiling.

    sizes: (n,) how large what adds up is.  reference: (n, ...) the oracle's values.
    """
    reason = f"eps x {PER_BODY} roundings a body x {depth(robot)} bodies and the base"
    value = np.full(n, rounding(robot))
    if sizes is not None and reference is not None:
        value = value * np.maximum(1.0, sizes / size(reference.reshape(n, -1)))
        reason += ", x what adds up / the largest entry (m r^2 beside I, r beside 1)"
    return _limited(value, reason)


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
    """Of a sum of weights times heights that may cancel: the rounding, of sum |m| |g| |p| instead of the sum.

    positions: (n, njoints, 3) of the bodies' frames.
    """
    g = float(np.linalg.norm(robot.gravity.array))
    mass = np.array([float(b.inertia.mass) for b in robot])
    moment = np.array([np.linalg.norm(b.inertia.moment.array) for b in robot])
    weights = g * (np.linalg.norm(positions, axis=-1) @ mass + moment.sum())
    cancelled = np.maximum(1.0, weights / np.maximum(1.0, np.abs(energy)))
    reason = "the rounding of a recursion x sum |m g p| / |sum m g p|, since heights of both signs cancel"
    return _limited(rounding(robot) * cancelled, reason)


SINGULAR = 1 / (64 * EPS)
"""A scaled condition number from which M is singular to working precision: nothing is left to compare."""


@dataclass(frozen=True)
class Reference:
    """Quantities that bounds depend on, of the reference only: a wrong M of the other side would widen its own bound.

    Attributes
    ----------
    ask : callable
        term -> the reference's values of it in these states.
    """

    robot: Robot
    states: Mapping[str, np.ndarray]
    extent: Extent
    ask: Callable[[str], np.ndarray]

    @cached_property
    def mass(self) -> MassMatrices:
        return MassMatrices(self.ask("crba"))

    @cached_property
    def forces(self) -> np.ndarray:
        """What cancels in  tau - bias."""
        return np.abs(self.states["tau"]) + np.abs(self.ask("bias"))


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


def inverse(robot: Robot, mass: MassMatrices, extent: Extent) -> Tolerance:
    """Of M^-1: the rounding of M, times its condition number, or |M^-1| |dM| |M^-1| with |dM_ij| = D_i D_j.

    Not the smaller condition number of M scaled to a unit diagonal, which our sparse factors follow:
    Pinocchio inverts the blocks of a floating base as they are, metres beside radians (50 digits show it).
    """
    value = rounding(robot) * np.maximum(
        mass.condition, _response(mass, extent) ** 2 / ORDINARY / _largest(mass.inverse)
    )
    return Tolerance(value, "the rounding of a recursion x the larger of cond(M) and (|M^-1| D)^2 / |M^-1|")


def solution(robot: Robot, mass: MassMatrices, forces: np.ndarray, a: np.ndarray, extent: Extent) -> Tolerance:
    """Of a = M^-1 f, entry by entry:  |da| <= |M^-1| (|dM| |a| + |df|)  (Skeel 1979), or as `inverse`.

    |dM| and |df| are the rounding of M and of what adds up in the forces, D_i times the accelerations
    that D weighs, or of the forces that cancel in f.
    """
    with np.errstate(all="ignore"):
        load = forces + (np.abs(mass.M) @ np.abs(a)[..., None])[..., 0]
        load = load + extent.weights * ((extent.push(a) + extent.swing + extent.fall) / ORDINARY)[:, None]
        error = (mass.inverse @ load[..., None])[..., 0].max(axis=-1, initial=0.0)
    value = rounding(robot) * np.maximum(mass.condition, error / _largest(a))
    return Tolerance(value, "the rounding of a recursion x the larger of cond(M) and |M^-1| (|M| |a| + |forces|) / |a|")


def derivatives(
    robot: Robot, mass: MassMatrices, forces: np.ndarray, a: np.ndarray, X: np.ndarray, extent: Extent
) -> Tolerance:
    """Of X = M^-1 D, with D = d tau / d(q, v) at the acceleration a that was itself solved for.

    Two errors come through M^-1: the rounding, of M and D, as in `inverse`; and that of D where a
    is off by da.  M da is no more than the rounding of the forces, and dM/dq is scaled as M
    is, so that M^-1 (dM/dq) da is of the size of da.
    """
    of_a = solution(robot, mass, forces, a, extent).value * _largest(a)
    with np.errstate(all="ignore"):
        swing = extent.push(a) + extent.swing + extent.fall + extent.heaviest * (1 + extent.speed)
        carried = np.linalg.norm(np.abs(X) * extent.weights[:, None, :, None], axis=-2).max(axis=(-2, -1), initial=0.0)
        of_D = _response(mass, extent) * (swing + carried) / ORDINARY
    value = rounding(robot) * (mass.condition + of_D / _largest(X)) + of_a / _largest(X)
    return Tolerance(value, "the rounding of a recursion x cond(M), + the error of the acceleration it is taken at")


def _response(mass: MassMatrices, extent: Extent) -> np.ndarray:
    """The largest entry of |M^-1| D: what a relative rounding of what adds up in M or forces moves."""
    with np.errstate(all="ignore"):
        return (mass.inverse @ extent.weights[..., None])[..., 0].max(axis=-1, initial=0.0)


def _largest(x: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        return size(x.reshape(len(x), -1))


def condition(M: np.ndarray) -> np.ndarray:
    """The condition number of symmetric M, by its eigenvalues; infinite where that is not finite."""
    if M.shape[-1] == 0:
        return np.ones(len(M))
    good = np.isfinite(M).all(axis=(-2, -1))
    with np.errstate(all="ignore"):
        sizes = np.abs(np.linalg.eigvalsh(np.where(good[:, None, None], M, 0.0)))
        least, most = sizes.min(axis=-1), sizes.max(axis=-1)
        return np.where(good & (least > 0), most / least, np.inf)
