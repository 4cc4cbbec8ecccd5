"""How inverse and forward dynamics change with the state."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..call import evaluator
from ..model.robot import Robot
from ..terms import (
    ABA_DERIVATIVES,
    ABA_DERIVATIVES_F_EXT,
    RNEA_DERIVATIVES,
    RNEA_DERIVATIVES_F_EXT,
    RNEA_HESSIAN,
    RNEA_HESSIAN_F_EXT,
    RNEA_HVP,
    RNEA_HVP_F_EXT,
    RNEA_JVP,
    RNEA_JVP_F_EXT,
    RNEA_SECOND_DERIVATIVES,
    RNEA_SECOND_DERIVATIVES_F_EXT,
    RNEA_VJP,
    RNEA_VJP_F_EXT,
)


def rnea_derivatives(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How inverse dynamics changes: d tau / dq, d tau / dv, d tau / da = M, each (..., nv, nv).

    d tau / dq is by displacements of the joints: of a floating, planar or spherical joint in its moving
    frame (the tangent space in which `integrate` steps), of all others the derivative by the coordinate.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`: wrenches that turn with their bodies.
    out : ndarray, shape (..., 3, nv, nv), optional
        Where all three are written; what is returned are its parts.

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
    if f_ext is None:
        return _parts(evaluator(robot, RNEA_DERIVATIVES, engine)(q, v, a, out), 3)
    return _parts(evaluator(robot, RNEA_DERIVATIVES_F_EXT, engine)(q, v, a, f_ext, out), 3)


def aba_derivatives(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How forward dynamics changes: d a / dq, d a / dv, d a / d tau = M^-1, each (..., nv, nv).

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, tau : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`: wrenches that turn with their bodies.
    out : ndarray, shape (..., 3, nv, nv), optional
        Where all three are written; what is returned are its parts.

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
    if f_ext is None:
        return _parts(evaluator(robot, ABA_DERIVATIVES, engine)(q, v, tau, out), 3)
    return _parts(evaluator(robot, ABA_DERIVATIVES_F_EXT, engine)(q, v, tau, f_ext, out), 3)


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
    engine: str = "auto",
) -> np.ndarray:
    """How inverse dynamics changes along a direction, d tau / dq dq + d tau / dv dv + M da, shape (..., nv).

    Some three times the work of `rnea`, where the matrices of `rnea_derivatives` grow with nv^2.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    dq, dv, da : array_like, shape (..., nv)
        The direction; dq is a displacement of the joints, as `integrate` takes it.
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.

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
        return evaluator(robot, RNEA_JVP, engine)(q, v, a, dq, dv, da, out)
    return evaluator(robot, RNEA_JVP_F_EXT, engine)(q, v, a, dq, dv, da, f_ext, out)


def rnea_vjp(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    w: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The gradient of w . tau: w^T d tau / dq, w^T d tau / dv and M w, each (..., nv).

    What backpropagation asks for, in some three times the work of `rnea`.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    w : array_like, shape (..., nv)
        The weights of the torques.
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.
    out : ndarray, shape (..., 3, nv), optional
        Where all three are written; what is returned are its parts.

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
        return _parts(evaluator(robot, RNEA_VJP, engine)(q, v, a, w, out), 2)
    return _parts(evaluator(robot, RNEA_VJP_F_EXT, engine)(q, v, a, w, f_ext, out), 2)


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
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The Hessian of w . tau times a direction, by q, v and a, each (..., nv).

    It is the gradient of ``w @ rnea_jvp(robot, q, v, a, dq, dv, da)``.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a, w : array_like, shape (..., nv)
    dq, dv, da : array_like, shape (..., nv)
        The direction, as in `rnea_jvp`.
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.
    out : ndarray, shape (..., 3, nv), optional
        Where all three are written; what is returned are its parts.

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
        return _parts(evaluator(robot, RNEA_HVP, engine)(q, v, a, w, dq, dv, da, out), 2)
    return _parts(evaluator(robot, RNEA_HVP_F_EXT, engine)(q, v, a, w, dq, dv, da, f_ext, out), 2)


def rnea_hessian(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    w: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The second derivatives of w . tau: by q q, q v, v v and a q, each (..., nv, nv).

    The product of `rnea_second_derivatives` with a vector, without the tensors: what differential
    dynamic programming adds to the second derivatives of the cost, with w the costate.

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    w : array_like, shape (..., nv)
        The weights of the torques.
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`.
    out : ndarray, shape (..., 4, nv, nv), optional
        Where all four are written; what is returned are its parts.

    Notes
    -----
    The rows are those of the variable named first.  Displacements as in `rnea_second_derivatives`: within
    a floating, planar or spherical joint the first matrix is not symmetric.

    References
    ----------
    Nganga & Wensing (2021), Accelerating second-order differential dynamic programming for rigid-body systems.

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
        return _parts(evaluator(robot, RNEA_HESSIAN, engine)(q, v, a, w, out), 3)
    return _parts(evaluator(robot, RNEA_HESSIAN_F_EXT, engine)(q, v, a, w, f_ext, out), 3)


def rnea_second_derivatives(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    engine: str = "auto",
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The second derivatives of inverse dynamics: d2 tau / dq dq, / dq dv, / dv dv and dM / dq, (..., nv, nv, nv).

    Parameters
    ----------
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        As in `rnea`: wrenches that turn with their bodies.
    out : ndarray, shape (..., 4, nv, nv, nv), optional
        Where all four are written; what is returned are its parts.

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

    Notes
    -----
    By q means by displacements of the joints, as in `rnea_derivatives`.  Where they do not commute (within
    a floating, planar or spherical joint) the order counts, qq[i, j, k] - qq[i, k, j] = d tau_i / dq . [s_k, s_j],
    and the second derivative of x -> rnea(integrate(q, x), v, a) at x = 0 is (qq + qq^T) / 2.

    References
    ----------
    Singh, Russell & Wensing (2022), On second-order derivatives of rigid-body dynamics: theory and implementation.

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
        return _parts(evaluator(robot, RNEA_SECOND_DERIVATIVES, engine)(q, v, a, out), 4)
    return _parts(evaluator(robot, RNEA_SECOND_DERIVATIVES_F_EXT, engine)(q, v, a, f_ext, out), 4)


def _parts(whole: np.ndarray, rank: int) -> tuple[Any, ...]:
    """The parts of the first of the last `rank` axes."""
    return tuple(np.moveaxis(whole, -rank, 0))
