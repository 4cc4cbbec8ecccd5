"""How near a prediction comes to an answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Score:
    """How near a prediction comes: worst scaled error, share of entries that are right, root mean square.

    `right` says whether the error is no more than rounding leaves, `numberless` that neither tells any number.
    """

    error: float
    share: float
    rms: float
    right: bool = False
    numberless: bool = False


FAR = Score(float("inf"), 0.0, float("inf"))


HUGE = 1e12
"""An entry of an inverse beyond which the matrix is singular but for rounding."""
ROUNDINGS = 64 * float(np.finfo(float).eps)
"""What a step of a recursion may leave, see `crosscheck.tolerance.PER_BODY`."""


def limits(Ms: Sequence[np.ndarray | None], joints: int, tolerance: float) -> np.ndarray:
    """How far right answers may be off: more where matrices (n, nv, nv) that must be inverted are ill-conditioned."""
    out = np.full(len(Ms), tolerance)
    alike: dict[tuple[int, ...], dict[int, np.ndarray]] = {}
    for k, M in enumerate(Ms):
        if M is not None and M.ndim == 3 and M.shape[1] == M.shape[2] and np.isfinite(M).all():
            alike.setdefault(M.shape, {})[k] = M
    for some in alike.values():
        stacked = np.stack(list(some.values()))
        sizes = np.abs(np.linalg.eigvalsh((stacked + np.swapaxes(stacked, -1, -2)) / 2))
        least, most = sizes.min(axis=-1), sizes.max(axis=-1)
        condition = np.divide(most, least, out=np.full_like(most, np.inf), where=least > 0).max(axis=-1)
        out[list(some)] = np.maximum(tolerance, np.minimum(1e-3, ROUNDINGS * (joints + 1) * condition))
    return out


def in_forces(errors: np.ndarray, x: np.ndarray, P: np.ndarray, load: np.ndarray, tolerance: float) -> list[Score]:
    """Forces (runs, n, nv) that accelerations need against those that they had; `load` is what adds up in them."""
    have = np.isfinite(x).all(axis=2)
    apart, scale = np.abs(x - P), np.maximum(1.0, load.max(axis=2, keepdims=True))
    found = []
    for error, rows, off, most in zip(errors.tolist(), have, apart, scale, strict=True):
        if not rows.any():
            found.append(FAR)
            continue
        share = float((off[rows] <= tolerance * most[rows]).mean())
        found.append(Score(error, share, float(np.sqrt(np.mean(off[rows] ** 2))), share == 1.0))
    return found


def scored(x: np.ndarray, predictions: Sequence[np.ndarray | None], tolerances: np.ndarray) -> list[Score]:
    """How near each of many predictions comes to one answer."""
    out = [FAR] * len(predictions)
    alike = [k for k, p in enumerate(predictions) if p is not None and p.shape == x.shape]
    if not alike:
        return out
    P = np.stack([p for p in (predictions[k] for k in alike) if p is not None])
    finite = np.isfinite(P.reshape(len(P), -1)).all(axis=1)
    if _numberless(x[None], np.fmax)[0]:  # as the inverse of a singular matrix; of some frames there may be no answer
        for k in np.array(alike)[_numberless(P, np.maximum)]:
            out[k] = Score(0.0, 1.0, 0.0, True, True)
        return out
    if not finite.all():
        P, alike = P[finite], [k for k, good in zip(alike, finite, strict=True) if good]
    if not alike:
        return out
    at = tolerances[alike]
    found = errors(x, P), *_near(x, P, np.minimum(at, 1e-7)), at
    for k, error, share, rms, most in zip(alike, *(values.tolist() for values in found), strict=True):
        out[k] = Score(error, share, rms, error <= most)
    return out


def _numberless(P: np.ndarray, largest: np.ufunc) -> np.ndarray:
    """Whether the largest number of every sample is none that is finite, or is `HUGE`, of each of many predictions."""
    with np.errstate(invalid="ignore"):
        found = largest.reduce(np.abs(P.reshape(*P.shape[:2], -1)), axis=2)
        return np.asarray((~(found < HUGE)).all(axis=1))


def scaled(x: np.ndarray, reference: np.ndarray) -> float:
    """The largest over the samples (and frames) of max|x - ref| / max(1, max|ref|); unanswered ones are left out."""
    return float(errors(x, reference[None])[0])


def errors(x: np.ndarray, references: np.ndarray) -> np.ndarray:
    """The error `scaled` of x against each of many references (runs, ...)."""
    rows = int(np.prod(x.shape[: x.ndim - _tail(x)]))
    a, b = x.reshape(rows, -1), references.reshape(len(references), rows, -1)
    have = ~np.isnan(a).all(axis=1)
    if not have.any():
        return np.full(len(references), np.nan)
    a, b = a[have], b[:, have]
    with np.errstate(all="ignore"):
        apart = np.where(np.isnan(a), 0.0, np.abs(a - b))  # of some frames there may be no answer
        e = apart.max(axis=2, initial=0.0) / np.maximum(1.0, np.abs(b).max(axis=2, initial=0.0))
    return np.asarray(np.where(np.isfinite(e), e, np.inf).max(axis=1))


def _tail(x: np.ndarray) -> int:
    """How many axes one answer has: of (n, ...), or (n, frames, a, b)."""
    return x.ndim - 2 if x.ndim == 4 else x.ndim - 1


def _near(x: np.ndarray, references: np.ndarray, tolerances: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The share of right entries, and the root mean square, against each of many references."""
    rows = int(np.prod(x.shape[: x.ndim - _tail(x)]))
    a, b = x.reshape(rows, -1), references.reshape(len(references), rows, -1)
    have = ~np.isnan(a)
    if not have.any():
        return np.zeros(len(b)), np.full(len(b), np.inf)
    with np.errstate(all="ignore"):
        # of the smaller one: a prediction that is far too large must not make everything look near
        scale = np.maximum(1.0, np.fmin(np.abs(a), np.abs(b)).max(axis=2, keepdims=True))
        apart = np.abs(a - b)
        right = (apart <= tolerances[:, None, None] * scale)[:, have]
        return right.mean(axis=1), np.sqrt(np.mean(apart[:, have] ** 2, axis=1))
