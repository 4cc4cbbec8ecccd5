"""Forces and accelerations."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..call.public import ask, public
from ..model.robot import Robot
from ..terms import (
    ABA,
    ABA_F_EXT,
    BIAS,
    GRAVITY,
    JOINT_WRENCHES,
    JOINT_WRENCHES_F_EXT,
    RNEA,
    RNEA_F_EXT,
)


@public
def rnea(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Inverse dynamics, tau = M(q) a + C(q, v) v + g(q) - J^T f_ext.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    f_ext : array_like, shape (..., njoints, 6), optional
        External wrench [n; f] on each joint's body, about and in that joint's moving frame.
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., nv)
        Joint torques [N m] and forces [N].

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Luh, Walker & Paul (1980); Featherstone (2008), 5.3.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import dualpin as dp
    >>> robot = dp.load("panda")
    >>> q, v, a = robot.sample(1000, seed=0)
    >>> dp.rnea(robot, q, v, a).shape
    (1000, 9)
    """
    if f_ext is None:
        return ask(RNEA, q, v, a)
    return ask(RNEA_F_EXT, q, v, a, f_ext)


@public
def joint_wrenches(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """The wrench on each body from its parent through its joint: bearing reactions, and the actuator's torque.

        F_b = I_b A_b + V_b x I_b V_b - f_ext_b + sum of F over the children of b

    Its component along the joint's screws is the torque of `rnea` without that of the rotors.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
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
    ndarray, shape (..., njoints, 6)
        Wrenches [n; f] (moment [N m], force [N]) that the parent exerts on the body, about the origin
        and in the axes of the joint's moving frame, in the order of ``robot.joint_names``.  A sensor
        on the parent's side reads the opposite.

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Luh, Walker & Paul (1980); Featherstone (2008), 5.3, where it is f_i.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> f = dp.joint_wrenches(robot, np.zeros(6), np.zeros(6), np.zeros(6))
    >>> f.shape, bool(np.isclose(f[0, 5], 9.81 * robot.mass))  # the first joint carries the weight
    ((6, 6), True)
    """
    if f_ext is None:
        return ask(JOINT_WRENCHES, q, v, a)
    return ask(JOINT_WRENCHES_F_EXT, q, v, a, f_ext)


@public
def bias(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Nonlinear effects h = C(q, v) v + g(q), shape (..., nv).

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v : array_like, shape (..., nv)
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., nv)
        [N m] and [N].

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Featherstone (2008), 3.1 and 5.3: inverse dynamics with a = 0.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.bias(dp.load("ur5"), np.zeros(6), np.ones(6)).shape
    (6,)
    """
    return ask(BIAS, q, v)


@public
def gravity(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, dtype: DTypeLike = "float64", engine: str = "auto"
) -> np.ndarray:
    """Generalised gravity g(q) = dU/dq, the torques that hold the robot at rest, shape (..., nv).

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., nv)
        [N m] and [N].

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Featherstone (2008), 5.3: inverse dynamics with v = a = 0.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.gravity(dp.load("ur5"), np.zeros(6)).shape
    (6,)
    """
    return ask(GRAVITY, q)


@public
def aba(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    f_ext: ArrayLike | None = None,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Forward dynamics, a = M^-1 (tau - C v - g + J^T f_ext), shape (..., nv).

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v : array_like, shape (..., nv)
    tau : array_like, shape (..., nv)
        Joint torques [N m] and forces [N].
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
        Accelerations of the joints [rad/s^2, m/s^2].

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    Notes
    -----
    By the articulated-body algorithm; where joints share a coordinate (mimic), by the factorised
    inertia matrix.  Not finite where M is singular (a joint that moves no mass).

    References
    ----------
    Featherstone (1983); Featherstone (2008), 7.3 (Table 7.1) and 6.5.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, a = robot.sample(seed=0)
    >>> bool(np.allclose(dp.aba(robot, q, v, dp.rnea(robot, q, v, a)), a))
    True
    """
    if f_ext is None:
        return ask(ABA, q, v, tau)
    return ask(ABA_F_EXT, q, v, tau, f_ext)
