"""The physically consistent parameters nearest to the estimate.

    minimise   |R (G p - b)|^2 + |N^T D^-1 (p - p0)|^2 / 1000      P(p_b) >= 0 for every body b

G p are the base parameters, b their least-squares estimate and R^T R its information, so the first term is in squared
standard deviations.  Parameters without an effect on torques (the null space N of G) stay near the description p0; a
relative change of 1 there weighs 0.03 standard deviations.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...errors import DualpinError
from ...extras import extra
from .bodies import pseudo_inertias

PRIOR = 1e-3
"""Weight of the description, in squared standard deviations a relative change."""
LENGTH = 0.1
"""[m] Of a body of which the description knows no size."""


def nearest_bodies(
    G: np.ndarray, R: np.ndarray, b: np.ndarray, p0: np.ndarray, bodies: int, nonnegative: Sequence[int] = ()
) -> np.ndarray:
    """The p of the problem above.

    Parameters
    ----------
    G : ndarray, shape (k, n)
        What is seen of the parameters.
    R, b : ndarray, shapes (k, k), (k,)
    p0 : ndarray, shape (n,)
        Ten parameters for each of `bodies` bodies, then others.
    nonnegative : sequence of int
        Which of the others cannot be negative.

    References
    ----------
    Wensing, Kim & Slotine (2018), linear matrix inequalities for physically consistent inertial
    parameter identification; Sousa & Cortesao (2014).
    """
    cp = extra("cvxpy", "identify", "identify: physical=True")
    scale = _scales(p0, bodies)
    # p = scale x;  x of what is seen, and of what is not, in steps that cost alike: the solver sees both
    _, singular, Vh = np.linalg.svd(G * scale)
    k = int((singular > 1e-10 * singular.max(initial=0.0)).sum())
    seen, unseen = Vh[:k].T, Vh[k:].T
    Q, T = np.linalg.qr(R @ (G * scale) @ seen)
    start = seen @ np.linalg.solve(T, Q.T @ (R @ b)) + unseen @ (unseen.T @ (p0 / scale))
    y = cp.Variable(len(p0))
    x = start + np.hstack([seen @ np.linalg.inv(T), unseen / np.sqrt(PRIOR)]) @ y
    cost = cp.sum_squares(y)
    constraints = [x[i] >= 0 for i in nonnegative]
    E = pseudo_inertias()
    for k in range(bodies):
        own = scale[10 * k : 10 * k + 10]
        half = np.diag([*np.full(3, 1 / np.sqrt(own[4])), 1 / np.sqrt(own[0])])  # P scaled to the size of one
        scaled = np.einsum("i,ab,ibc,cd->iad", own, half, E, half).reshape(10, 16)
        P = cp.reshape(scaled.T @ x[10 * k : 10 * k + 10], (4, 4), order="C")
        constraints.append((P + P.T) / 2 >> 0)
    problem = cp.Problem(cp.Minimize(cost), constraints)
    try:
        problem.solve(solver=cp.CLARABEL)
    except cp.error.SolverError as e:
        raise DualpinError(f"identify: the conic solver found no physical parameters ({e}); physical=False") from None
    if y.value is None:
        raise DualpinError(f"identify: the conic solver says {problem.status!r}; physical=False does without it")
    return _inside(np.asarray(x.value) * scale, bodies, nonnegative)


def _scales(p0: np.ndarray, bodies: int) -> np.ndarray:
    """Scales of the parameters: m, m r, m r^2 of the body, with r its radius of gyration."""
    scale = np.ones(len(p0))
    mean = max(float(np.mean(p0[: 10 * bodies : 10])), 1e-3) if bodies else 1.0
    for k in range(bodies):
        m, J = p0[10 * k], p0[10 * k + 4 : 10 * k + 10]
        m = m if m > 0.01 * mean else mean
        r = np.clip(np.sqrt(max(J[0] + J[2] + J[5], 0.0) / (2 * m)), LENGTH / 10, LENGTH * 100) if J.any() else LENGTH
        scale[10 * k : 10 * k + 10] = [m, *np.full(3, m * r), *np.full(6, m * r * r)]
    return scale


def _inside(p: np.ndarray, bodies: int, nonnegative: Sequence[int]) -> np.ndarray:
    """Remove negative eigenvalues that the solver's tolerance (1e-8) leaves."""
    E = pseudo_inertias()
    p = p.copy()
    for k in range(bodies):
        P = np.einsum("i,ijk->jk", p[10 * k : 10 * k + 10], E)
        w, U = np.linalg.eigh(P)
        if w[0] < 0:
            P = (U * np.maximum(w, 0)) @ U.T
            S, h, m = P[:3, :3], P[:3, 3], P[3, 3]
            J = np.trace(S) * np.eye(3) - S
            p[10 * k : 10 * k + 10] = [m, *h, J[0, 0], J[0, 1], J[1, 1], J[0, 2], J[1, 2], J[2, 2]]
    p[list(nonnegative)] = np.maximum(p[list(nonnegative)], 0.0)
    return p
