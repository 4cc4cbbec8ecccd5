"""How near a prediction comes to an answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Score:
    """How near a prediction comes: worst scaled error, share of entries that are right, root mean square.

    `right` says whether the error is no more than rounding leaves.
    """

    error: float
    share: float
    rms: float
    right: bool = False


FAR = Score(float("inf"), 0.0, float("inf"))


ROUNDINGS = 64 * float(np.finfo(float).eps)
"""What a step of a recursion may leave, see `crosscheck.tolerance.PER_BODY`."""


def limit(M: np.ndarray | None, joints: int, tolerance: float) -> float:
    """How far a right answer may be off: more where a matrix that must be inverted is ill-conditioned."""
    if M is None or not np.isfinite(M).all():
        return tolerance
    sizes = np.abs(np.linalg.eigvalsh((M + np.swapaxes(M, -1, -2)) / 2))
    least, most = sizes.min(axis=-1), sizes.max(axis=-1)
    condition = float((most / least).max()) if least.all() else float("inf")
    return max(tolerance, min(1e-3, ROUNDINGS * (joints + 1) * condition))


def in_forces(error: float, x: np.ndarray, reference: np.ndarray, load: np.ndarray, tolerance: float) -> Score:
    """Forces that accelerations need against those that they had; `load` is what adds up in them."""
    have = np.isfinite(x).all(axis=1)
    if not have.any():
        return FAR
    apart, scale = np.abs(x - reference)[have], np.maximum(1.0, load[have].max(axis=1, keepdims=True))
    share = float((apart <= tolerance * scale).mean())
    return Score(error, share, float(np.sqrt(np.mean(apart**2))), share == 1.0)


def scored(x: np.ndarray, p: np.ndarray, y: np.ndarray, z: np.ndarray, tolerance: float) -> Score:
    """The error of x against p, and share and rms of y against z."""
    if x.shape != p.shape or not np.isfinite(p).all():
        return FAR
    error = scaled(x, p)
    return Score(error, *_near(y, z, min(tolerance, 1e-7)), error <= tolerance)


def scaled(x: np.ndarray, reference: np.ndarray) -> float:
    """The largest over the samples (and frames) of max|x - ref| / max(1, max|ref|); unanswered ones are left out."""
    lead = x.ndim - _tail(x)
    a, b = x.reshape(int(np.prod(x.shape[:lead])), -1), reference.reshape(int(np.prod(x.shape[:lead])), -1)
    have = ~np.isnan(a).all(axis=1)
    if not have.any():
        return float("nan")
    with np.errstate(all="ignore"):
        apart = np.where(np.isnan(a), 0.0, np.abs(a - b))  # of some frames there may be no answer
        e = apart[have].max(axis=1, initial=0.0) / np.maximum(1.0, np.abs(b)[have].max(axis=1, initial=0.0))
    return float(np.where(np.isfinite(e), e, np.inf).max())


def _tail(x: np.ndarray) -> int:
    """How many axes one answer has: of (n, ...), or (n, frames, a, b)."""
    return x.ndim - 2 if x.ndim == 4 else x.ndim - 1


def _near(x: np.ndarray, reference: np.ndarray, tolerance: float) -> tuple[float, float]:
    axes = tuple(range(x.ndim - _tail(x), x.ndim))
    have = ~np.isnan(x)
    if not have.any():
        return 0.0, float("inf")
    with np.errstate(all="ignore"):
        # of the smaller one: a prediction that is far too large must not make everything look near
        size = np.fmin(np.abs(x), np.abs(reference))
        scale = np.maximum(1.0, size.max(axis=axes, keepdims=True) if axes else size)
        apart = np.abs(x - reference)
        return float((apart <= tolerance * scale)[have].mean()), float(np.sqrt(np.mean(apart[have] ** 2)))
