"""Finite Fourier series as motions of joints, and their extremes over the whole period.

    q(t) = q0 + sum_l  a_l / (w l) sin(w l t) - b_l / (w l) cos(w l t)        w = 2 pi / period

(Swevers et al. 1997).  The extremes of such a sum are where its derivative, a polynomial of degree 2 N in
z = exp(i w t), has roots on the unit circle; so they are computed, not sampled.  A quick bound is that
of Ehlich and Zeller (1964): on M > 2 N equidistant points a trigonometric polynomial of degree N
reaches at least cos(pi N / M) of its greatest size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FINE = 16
"""Points of a bound for each harmonic: it exceeds the extreme by at most 2 %, 1 / cos(pi / 16)."""
ON_CIRCLE = 1e-4
"""Roots this near to the unit circle are candidates; a double root deviates by the square root of rounding."""


@dataclass(frozen=True, eq=False)
class Fourier:
    """A periodic motion of several coordinates.

    Attributes
    ----------
    period : float
        [s]
    offset : ndarray, shape (n,)
        q0.
    a, b : ndarray, shape (n, N)
        Coefficients of the velocity's cosines and sines.
    """

    period: float
    offset: np.ndarray
    a: np.ndarray
    b: np.ndarray

    @property
    def harmonics(self) -> np.ndarray:
        """The frequencies w l [rad/s], (N,)."""
        return np.asarray(2 * np.pi / self.period * np.arange(1, self.a.shape[1] + 1))

    def coefficients(self, order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(constant, of cosines, of sines) of the derivative of that order, each coordinate a row."""
        w = self.harmonics
        constant = self.offset if order == 0 else np.zeros_like(self.offset)
        cosine, sine = [(-self.b / w, self.a / w), (self.a, self.b), (self.b * w, -self.a * w)][order]
        return constant, cosine, sine

    def at(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """q, v, a at times (m,), each (m, n)."""
        angle = np.outer(t, self.harmonics)
        c, s = np.cos(angle), np.sin(angle)
        q, v, a = (k + c @ x.T + s @ y.T for k, x, y in map(self.coefficients, range(3)))
        return q, v, a

    def range(self, order: int) -> tuple[np.ndarray, np.ndarray]:
        """Least and greatest values of q (0), v (1) or a (2) over the period, (n,) each."""
        ends = [extremes(*row) for row in zip(*self.coefficients(order), strict=True)]
        low, high = np.array(ends).reshape(-1, 2).T
        return low, high

    def bound(self, order: int) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of `range` that take no roots, (n,) each."""
        constant, cosine, sine = self.coefficients(order)
        N = cosine.shape[1]
        x = np.outer(2 * np.pi * np.arange(FINE * N) / (FINE * N), np.arange(1, N + 1))
        values = np.cos(x) @ cosine.T + np.sin(x) @ sine.T
        beyond = np.abs(values).max(axis=0) * (1 / np.cos(np.pi / FINE) - 1)
        return constant + values.min(axis=0) - beyond, constant + values.max(axis=0) + beyond


def extremes(constant: float, cosine: np.ndarray, sine: np.ndarray) -> tuple[float, float]:
    """The least and greatest value of  constant + sum c_l cos(l x) + s_l sin(l x).

    Examples
    --------
    >>> import numpy as np
    >>> from dualpin.analysis.identification.fourier import extremes
    >>> low, high = extremes(1.0, np.array([3.0, 0.0]), np.array([4.0, 0.0]))
    >>> round(low, 12), round(high, 12)
    (-4.0, 6.0)
    """
    n = np.arange(1, len(cosine) + 1)
    size = float(np.abs(cosine).max(initial=0.0) + np.abs(sine).max(initial=0.0))
    if size == 0.0:
        return float(constant), float(constant)
    half = n * (sine + 1j * cosine) / (2 * size)  # the derivative is  sum half_l z^l + conjugate
    roots = np.roots(np.concatenate([half[::-1], [0.0], half.conj()]))
    coarse = 2 * np.pi * np.arange(4 * len(n)) / (4 * len(n))
    x = np.concatenate([np.angle(roots[np.abs(np.abs(roots) - 1) < ON_CIRCLE]), coarse])
    values = constant + np.cos(np.outer(x, n)) @ cosine + np.sin(np.outer(x, n)) @ sine
    return float(values.min()), float(values.max())
