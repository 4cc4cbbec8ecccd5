"""First derivatives of inverse and forward dynamics."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..call.public import ask, public, several
from ..model.robot import Robot
from ..terms import (
    ABA_DERIVATIVES,
    ABA_DERIVATIVES_F_EXT,
    RNEA_DERIVATIVES,
    RNEA_DERIVATIVES_F_EXT,
    RNEA_JVP,
    RNEA_JVP_F_EXT,
    RNEA_VJP,
    RNEA_VJP_F_EXT,
)


@several(3)
def rnea_derivatives(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Derivatives of inverse dynamics: d tau / dq, d tau / dv, d tau / da = M, each (..., nv, nv).

    d tau / dq is by displacements of the joints: of a floating, planar or spherical joint in its moving
    frame (the tangent space in which `integrate` steps), of all others the derivative by the coordinate.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`: wrenches that turn with their bodies.
    out : ndarray, shape (..., 3, nv, nv), optional
        An array for all three results; those returned are its parts.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    dq, dv, da : ndarray, shape (..., nv, nv)
        d tau / dq, d tau / dv and M.

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Singh, Russell & Wensing (2022), Efficient analytical derivatives of rigid-body dynamics.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

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
    if f_ext is None:
        return ask(RNEA_DERIVATIVES, q, v, a)
    return ask(RNEA_DERIVATIVES_F_EXT, q, v, a, f_ext)


@several(3)
def aba_derivatives(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Derivatives of forward dynamics: d a / dq, d a / dv, d a / d tau = M^-1, each (..., nv, nv).

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, tau : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`: wrenches that turn with their bodies.
    out : ndarray, shape (..., 3, nv, nv), optional
        An array for all three results; those returned are its parts.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    dq, dv, dtau : ndarray, shape (..., nv, nv)
        d a / dq, d a / dv and M^-1.

    Raises
    ------
    ShapeError, ArgumentError

    Notes
    -----
    d a / dq = -M^-1 d tau / dq at a = aba(q, v, tau); displacements as in `rnea_derivatives`.

    References
    ----------
    Carpentier & Mansard (2018), Analytical derivatives of rigid body dynamics algorithms.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, tau = robot.sample(seed=0)
    >>> dq, dv, dtau = dp.aba_derivatives(robot, q, v, tau)
    >>> bool(np.allclose(dtau, dp.minv(robot, q)))
    True
    """
    if f_ext is None:
        return ask(ABA_DERIVATIVES, q, v, tau)
    return ask(ABA_DERIVATIVES_F_EXT, q, v, tau, f_ext)


@public
def rnea_jvp(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    dq: ArrayLike,
    dv: ArrayLike,
    da: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Directional derivative of inverse dynamics, d tau / dq dq + d tau / dv dv + M da, shape (..., nv).

    It needs about three times the operations of `rnea`; the matrices of `rnea_derivatives` grow with nv^2.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    dq, dv, da : array_like, shape (..., nv)
        The direction; dq is a displacement of the joints, as `integrate` takes it.
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., nv)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Griewank & Walther (2008), 3.1, the tangent mode, of the recursion of `rnea`.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> by_q, by_v, M = dp.rnea_derivatives(robot, q, v, a)
    >>> bool(np.allclose(dp.rnea_jvp(robot, q, v, a, v, a, v), by_q @ v + by_v @ a + M @ v))
    True
    """
    if f_ext is None:
        return ask(RNEA_JVP, q, v, a, dq, dv, da)
    return ask(RNEA_JVP_F_EXT, q, v, a, dq, dv, da, f_ext)


@several(2)
def rnea_vjp(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    w: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The gradient of w . tau: w^T d tau / dq, w^T d tau / dv and M w, each (..., nv).

    The product that backpropagation needs, in about three times the operations of `rnea`.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    w : array_like, shape (..., nv)
        The weights of the torques.
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.
    out : ndarray, shape (..., 3, nv), optional
        An array for all three results; those returned are its parts.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    by_q, by_v, by_a : ndarray, shape (..., nv)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Griewank & Walther (2008), 3.2, the adjoint mode, of the recursion of `rnea`.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> by_q, by_v, by_a = dp.rnea_vjp(robot, q, v, a, v)
    >>> bool(np.allclose(by_q, v @ dp.rnea_derivatives(robot, q, v, a)[0]))
    True
    """
    if f_ext is None:
        return ask(RNEA_VJP, q, v, a, w)
    return ask(RNEA_VJP_F_EXT, q, v, a, w, f_ext)
