"""How large an error may be, and why.

Both libraries evaluate the same sums of products in different order.  A scaled error has three
causes: the constants (placements differ by some eps, since trigonometry of rpy is rounded), the
recursion (each of `depth` bodies multiplies by a rotation, adding some eps), and, where a linear
system is solved, the condition of the inertia matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..model.robot import Robot

EPS = float(np.finfo(float).eps)
CEILING = 1e-12  # of terms without a linear solve
PER_BODY = 32
"""Roundings of one step of a recursion, out and back: each way a 3x3 product of three terms a row
and a cross product, 8 roundings deep, in both libraries."""


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
    return Tolerance(np.full(n, value), f"eps x {PER_BODY} roundings a body x {bodies} bodies and the base, at most {CEILING:g}")


def inverse(robot: Robot, M: np.ndarray) -> Tolerance:
    """Of M^-1: the recursion's error of M, times the condition number.

    M is scaled to a unit diagonal first: a factorisation does not notice the units of a joint, and
    its error follows the scaled condition (van der Sluis 1969; Demmel 1989).
    """
    value = recursion(robot, len(M)).value * scaled_condition(M)
    return Tolerance(value, "the recursion's x cond(M), M scaled to a unit diagonal")


def solution(robot: Robot, M: np.ndarray, forces: np.ndarray, a: np.ndarray) -> Tolerance:
    """Of a = M^-1 f, entry by entry:  |da| <= |M^-1| (|dM| |a| + |df|)  (Skeel 1979).

    |dM| and |df| are the recursion's relative error of M and of the forces that cancel in f.
    """
    with np.errstate(all="ignore"):
        good = scaled_condition(M) < SINGULAR
        M_inverse = np.linalg.inv(np.where(good[:, None, None], M, np.eye(M.shape[-1])))
        load = forces + np.einsum("nij,nj->ni", np.abs(M), np.abs(a))
        error = np.einsum("nij,nj->ni", np.abs(M_inverse), load).max(axis=-1, initial=0.0)
        relative = error / np.maximum(1.0, np.abs(a).max(axis=-1, initial=0.0))
    value = recursion(robot, len(M)).value * np.maximum(1.0, relative)
    return Tolerance(value, "the recursion's x |M^-1| (|M| |a| + |forces|) / |a|")


def scaled_condition(M: np.ndarray) -> np.ndarray:
    """The condition number of D^-1/2 M D^-1/2, D = diag M; infinite where that is not finite."""
    if M.shape[-1] == 0:
        return np.ones(len(M))
    with np.errstate(all="ignore"):
        d = np.sqrt(np.diagonal(M, axis1=-2, axis2=-1))
        S = M / (d[..., :, None] * d[..., None, :])
        good = np.isfinite(S).all(axis=(-2, -1))
        values = np.linalg.svd(np.where(good[:, None, None], S, 0.0), compute_uv=False)
        return np.where(good, values[:, 0] / values[:, -1], np.inf)


SINGULAR = 1 / (64 * EPS)
"""A scaled condition number from which M is singular to working precision: nothing is left to compare."""
