"""Second derivatives of inverse dynamics: tensors, and their products with vectors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..call.public import ask, several
from ..model.robot import Robot
from ..terms import (
    RNEA_HESSIAN,
    RNEA_HESSIAN_F_EXT,
    RNEA_HVP,
    RNEA_HVP_F_EXT,
    RNEA_SECOND_DERIVATIVES,
    RNEA_SECOND_DERIVATIVES_F_EXT,
)


@several(2)
def rnea_hvp(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    w: ArrayLike,
    dq: ArrayLike,
    dv: ArrayLike,
    da: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The Hessian of w . tau times a direction, by q, v and a, each (..., nv).

    It is the gradient of ``w @ rnea_jvp(robot, q, v, a, dq, dv, da)``.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a, w : array_like, shape (..., nv)
    dq, dv, da : array_like, shape (..., nv)
        The direction, as in `rnea_jvp`.
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
    Griewank & Walther (2008), 5.1, second-order adjoints.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> w, zero = np.ones(6), np.zeros(6)
    >>> by_q, by_v, by_a = dp.rnea_hvp(robot, q, v, a, w, zero, v, zero)
    >>> qq, qv, vv, aq = dp.rnea_hessian(robot, q, v, a, w)
    >>> bool(np.allclose(by_q, qv @ v) and np.allclose(by_v, vv @ v))
    True
    """
    if f_ext is None:
        return ask(RNEA_HVP, q, v, a, w, dq, dv, da)
    return ask(RNEA_HVP_F_EXT, q, v, a, w, dq, dv, da, f_ext)


@several(3)
def rnea_hessian(
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
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The second derivatives of w . tau: by q q, q v, v v and a q, each (..., nv, nv).

    The product of `rnea_second_derivatives` with a vector, without the tensors.  Differential dynamic
    programming adds it to the second derivatives of the cost, with w the costate.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    w : array_like, shape (..., nv)
        The weights of the torques.
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.
    out : ndarray, shape (..., 4, nv, nv), optional
        An array for all four results; those returned are its parts.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    qq, qv, vv, aq : ndarray, shape (..., nv, nv)

    Raises
    ------
    ShapeError, ArgumentError

    Notes
    -----
    The rows are those of the variable named first.  Displacements as in `rnea_second_derivatives`: within
    a floating, planar or spherical joint the first matrix is not symmetric.

    References
    ----------
    Nganga & Wensing (2021), Accelerating second-order differential dynamic programming for rigid-body systems.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> w = np.arange(6.0)
    >>> tensors = dp.rnea_second_derivatives(robot, q, v, a)
    >>> matrices = dp.rnea_hessian(robot, q, v, a, w)
    >>> all(np.allclose(np.einsum("i,ijk->jk", w, T), H) for T, H in zip(tensors, matrices))
    True
    """
    if f_ext is None:
        return ask(RNEA_HESSIAN, q, v, a, w)
    return ask(RNEA_HESSIAN_F_EXT, q, v, a, w, f_ext)


@several(4)
def rnea_second_derivatives(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The second derivatives of inverse dynamics: d2 tau / dq dq, / dq dv, / dv dv and dM / dq, (..., nv, nv, nv).

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`: wrenches that turn with their bodies.
    out : ndarray, shape (..., 4, nv, nv, nv), optional
        An array for all four results; those returned are its parts.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    qq : ndarray
        [i, j, k] is the derivative along q_k of d tau_i / dq_j.
    qv : ndarray
        [i, j, k] = d2 tau_i / dq_j dv_k.
    vv : ndarray
        [i, j, k] = d2 tau_i / dv_j dv_k.
    aq : ndarray
        [i, j, k] = dM_ij / dq_k.

    Raises
    ------
    ShapeError, ArgumentError

    Notes
    -----
    By q means by displacements of the joints, as in `rnea_derivatives`.  Where they do not commute (within
    a floating, planar or spherical joint) the order counts, qq[i, j, k] - qq[i, k, j] = d tau_i / dq . [s_k, s_j],
    and the second derivative of x -> rnea(integrate(q, x), v, a) at x = 0 is (qq + qq^T) / 2.

    References
    ----------
    Singh, Russell & Wensing (2022), On second-order derivatives of rigid-body dynamics: theory and implementation.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> qq, qv, vv, aq = dp.rnea_second_derivatives(robot, q, v, a)
    >>> step = 1e-6
    >>> up, down = (dp.crba(robot, q + s * v) for s in (step, -step))
    >>> bool(abs(aq @ v - (up - down) / (2 * step)).max() < 1e-6)
    True
    """
    if f_ext is None:
        return ask(RNEA_SECOND_DERIVATIVES, q, v, a)
    return ask(RNEA_SECOND_DERIVATIVES_F_EXT, q, v, a, f_ext)
