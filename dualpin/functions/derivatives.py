"""How inverse and forward dynamics change with the state."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..call import evaluator
from ..model.robot import Robot
from ..terms import ABA_DERIVATIVES, RNEA_DERIVATIVES


def rnea_derivatives(
    robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, engine: str = "auto"
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How inverse dynamics changes: d tau / dq, d tau / dv, d tau / da = M, each (..., nv, nv).

    d tau / dq is by displacements of the joints: of a floating or planar joint in its moving frame
    (the tangent space in which `integrate` steps), of all others the derivative by the coordinate.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)

    References
    ----------
    Singh, Russell & Wensing (2022), Efficient analytical derivatives of rigid-body dynamics.

    Examples
    --------
    >>> import dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> dq, dv, da = dp.rnea_derivatives(robot, q, v, a)
    >>> step = 1e-6
    >>> slope = (dp.rnea(robot, q + step * v, v, a) - dp.rnea(robot, q - step * v, v, a)) / (2 * step)
    >>> bool(abs(dq @ v - slope).max() < 1e-6)
    True
    """
    dq, dv, da = np.moveaxis(evaluator(robot, RNEA_DERIVATIVES, engine)(q, v, a, None), -3, 0)
    return dq, dv, da


def aba_derivatives(
    robot: Robot, q: ArrayLike, v: ArrayLike, tau: ArrayLike, *, engine: str = "auto"
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How forward dynamics changes: d a / dq, d a / dv, d a / d tau = M^-1, each (..., nv, nv).

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, tau : array_like, shape (..., nv)

    Notes
    -----
    d a / dq = -M^-1 d tau / dq at a = aba(q, v, tau); displacements as in `rnea_derivatives`.

    References
    ----------
    Carpentier & Mansard (2018), Analytical derivatives of rigid body dynamics algorithms.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, tau = robot.sample(seed=0)
    >>> dq, dv, dtau = dp.aba_derivatives(robot, q, v, tau)
    >>> bool(np.allclose(dtau, dp.minv(robot, q)))
    True
    """
    dq, dv, dtau = np.moveaxis(evaluator(robot, ABA_DERIVATIVES, engine)(q, v, tau, None), -3, 0)
    return dq, dv, dtau
