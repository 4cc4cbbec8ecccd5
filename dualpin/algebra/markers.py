"""The screw of a motion from measured marker points: least squares in dual numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import numbers
from ..dual import Dual
from ..errors import ArgumentError, ShapeError
from ..spatial import ScrewParameters, compose, exp, screw_parameters, transform_points
from .linear import solve

FLAT = 1e-9  # of the largest spread: markers nearer than this to one line do not determine a motion


@dataclass(frozen=True)
class MarkerMotion:
    """A motion estimated from markers, with residuals and standard deviations.

    Attributes
    ----------
    dual_quaternion : ndarray, shape (..., 8)
        The motion from before to after, w x y z | w x y z.
    screw : ScrewParameters
        Angle, distance, axis, point, pitch.
    residuals : ndarray, shape (..., k)
        Distance of each marker from the position predicted by the motion [m].
    noise : ndarray, shape (...)
        Standard deviation of a residual coordinate, with 3 k - 6 degrees of freedom [m].  It contains the noise of
        both measurements; that of one is 1 / sqrt(2) of it.
    deviations : dict of ndarray
        Standard deviations of angle [rad], distance [m], axis (3) and point (3) [m] of the screw, to first order.
    """

    dual_quaternion: np.ndarray
    screw: ScrewParameters
    residuals: np.ndarray
    noise: np.ndarray
    deviations: dict[str, np.ndarray]


def screw_from_markers(before: ArrayLike, after: ArrayLike) -> MarkerMotion:
    """The screw of a rigid motion from three or more markers, measured before and after.

    With the lines l_i = d_i + eps (c x d_i) from the markers' centre c to each of them, and l'_i after the motion,
    the unit dual quaternion q that makes the sum of (q l_i q*) . l'_i largest is the eigenvector of Horn's symmetric
    4 x 4 matrix N, linear in the sum of l'_i l_i^T, over dual numbers:

        N v = w v,    [N - w, -v; v^T, 0] (v'; w') = (-N' v; 0)

    By transference its real part is the best rotation, and its dual part the translation that maps centre to
    centre: the least squares motion of the points.

    Parameters
    ----------
    before, after : array_like, shape (..., k, 3)
        The same k >= 3 markers, not all on one line [m].

    Returns
    -------
    MarkerMotion

    Raises
    ------
    ShapeError, ArgumentError
        For fewer than three markers, or markers on one line.

    References
    ----------
    Horn (1987), Closed-form solution of absolute orientation using unit quaternions; Teu & Kim (2006), Estimation of
    the axis of a screw motion from noisy data; Page et al. (2007) on the errors.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> before = np.array([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0.1, 0.1, 0.4]])
    >>> x = dp.spatial.exp([0, 0, 0.5, 0, -0.5, 0.1])  # half a radian about a vertical line through (1, 0, 0)
    >>> found = dp.algebra.screw_from_markers(before, dp.spatial.transform_points(x, before))
    >>> round(float(found.screw.angle), 12), (found.screw.point.round(12) + 0.0).tolist()
    (0.5, [1.0, 0.0, 0.0])
    """
    p, r = (numbers(f"screw_from_markers: {what}", x) for what, x in (("before", before), ("after", after)))
    if p.shape != r.shape or p.ndim < 2 or p.shape[-1] != 3 or p.shape[-2] < 3:
        raise ShapeError(
            f"screw_from_markers: before and after of one shape (..., k, 3), k >= 3, expected, got {p.shape}, {r.shape}"
        )
    if not (np.isfinite(p).all() and np.isfinite(r).all()):
        raise ArgumentError("screw_from_markers: finite positions expected; leave out markers that were not seen")
    for what, x in (("before", p), ("after", r)):
        spread = np.linalg.svd(x - x.mean(axis=-2, keepdims=True), compute_uv=False)
        if np.any(spread[..., 1] <= FLAT * spread[..., 0]):
            raise ArgumentError(f"screw_from_markers: {what}: the markers lie on one line, which may turn about itself")
    v = _largest(_horn(_lines(r).swapaxes(-1, -2) @ _lines(p)))
    v = v * np.where(v.real[..., :1] < 0, -1.0, 1.0)
    x = np.concatenate((v.real, v.dual), axis=-1)
    error = r - transform_points(x, p)
    noise = np.sqrt((error**2).sum(axis=(-2, -1)) / max(3 * p.shape[-2] - 6, 1))
    return MarkerMotion(x, screw_parameters(x), np.linalg.norm(error, axis=-1), noise, _deviations(x, r, noise))


def _lines(p: np.ndarray) -> Dual:
    """From the centre to each marker: rows d_i + eps c x d_i, shape (..., k, 3)."""
    c = p.mean(axis=-2, keepdims=True)
    return Dual(p - c, np.cross(c, p - c))


def _horn(B: Dual) -> Dual:
    """Horn's matrix of B = sum of l' l^T: v^T N v = sum of l' . (v l v*), symmetric, shape (..., 4, 4)."""
    parts = []
    for b in B.arrays:
        N = np.empty((*b.shape[:-2], 4, 4))
        trace = np.trace(b, axis1=-2, axis2=-1)
        skew = np.stack(
            [b[..., 2, 1] - b[..., 1, 2], b[..., 0, 2] - b[..., 2, 0], b[..., 1, 0] - b[..., 0, 1]], axis=-1
        )
        N[..., 0, 0] = trace
        N[..., 0, 1:] = N[..., 1:, 0] = skew
        N[..., 1:, 1:] = b + b.swapaxes(-1, -2) - trace[..., None, None] * np.eye(3)
        parts.append(N)
    return Dual(*parts)


def _largest(N: Dual) -> Dual:
    """The unit eigenvector of the largest eigenvalue; the other eigenvalues may be repeated."""
    w, V = np.linalg.eigh(N.real)
    v = V[..., -1]
    bordered = np.zeros((*v.shape[:-1], 5, 5))
    bordered[..., :4, :4] = N.real - w[..., -1:, None] * np.eye(4)
    bordered[..., :4, 4], bordered[..., 4, :4] = -v, v
    right = np.zeros((*v.shape[:-1], 5, 1))
    right[..., :4, :] = -N.dual @ v[..., None]
    return Dual(v, solve(bordered, right).real[..., :4, 0])


def _deviations(x: np.ndarray, after: np.ndarray, noise: np.ndarray) -> dict[str, np.ndarray]:
    """Deviations of the screw, from the covariance noise^2 (J^T J)^-1 of a small twist, J = [-[p], 1]."""
    J = np.zeros((*after.shape[:-1], 3, 6))
    J[..., :3] = np.cross(after[..., None, :], np.eye(3)[None]).swapaxes(-1, -2) * -1
    J[..., 3:] = np.eye(3)
    J = J.reshape(*after.shape[:-2], -1, 6)
    covariance = np.linalg.pinv(J.swapaxes(-1, -2) @ J) * (noise**2)[..., None, None]
    h = 1e-6  # step of central differences: their errors h^2 and rounding / h are far below the deviations
    steps = [[screw_parameters(compose(exp(s * h * e), x)) for s in (1, -1)] for e in np.eye(6)]

    def deviation(what: str) -> np.ndarray:
        columns: Any = [(getattr(a, what) - getattr(b, what)) / (2 * h) for a, b in steps]
        D = np.stack(columns, axis=-1)
        D = D[..., None, :] if what in ("angle", "distance") else D
        spread = np.sqrt(np.maximum(np.einsum("...ij,...jk,...ik->...i", D, covariance, D), 0.0))
        return spread[..., 0] if what in ("angle", "distance") else spread

    return {what: deviation(what) for what in ("angle", "distance", "axis", "point")}
