"""Poses, velocities and accelerations of frames and joints."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..arguments import choice
from ..call.public import ask, public
from ..model.robot import Frame, Robot
from ..terms import (
    FK,
    FK_QUATERNION,
    FRAME_ACCELERATION,
    FRAME_POSE,
    FRAME_QUATERNION,
    FRAME_VELOCITY,
    JACOBIAN,
    JACOBIAN_DOT,
)

FrameLike = str | int | Frame


@public
def fk(
    robot: Robot,
    q: ArrayLike,
    frame: FrameLike | None = None,
    *,
    as_: str = "matrix",
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Forward kinematics: poses in the world.

        X_b = X_parent placement motion(q)

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    frame : str, int or Frame, optional
        A link or joint name; without it, all joint frames in the order of ``robot.joint_names``.
    as_ : "matrix" or "dual_quaternion"
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray
        Homogeneous matrices frame -> world, shape (..., 4, 4), or (..., njoints, 4, 4) of all
        joints; as dual quaternions (..., 8): w x y z of the real part, then of the dual part, w >= 0.

    Raises
    ------
    FrameNotFoundError, ShapeError, ArgumentError

    References
    ----------
    Study (1903) for dual quaternions; Featherstone (2008), 4.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> dp.fk(robot, np.zeros(6), frame="tool0")[:3, 3].round(5).tolist()
    [0.81725, 0.19145, -0.00549]
    """
    if as_ == "matrix":
        return ask(FK if frame is None else (FRAME_POSE, frame), q)
    choice("fk: as_", as_, ("matrix", "dual_quaternion"))
    return ask(FK_QUATERNION if frame is None else (FRAME_QUATERNION, frame), q)


@public
def jacobian(
    robot: Robot,
    q: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Geometric Jacobian of a frame, twist = J v.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    frame : str, int or Frame
    reference : "world", "local" or "local_world_aligned"
        Twist about the world's origin; about the frame's origin in its own axes; about the frame's
        origin in world axes.
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., 6, nv)
        Rows [w; v], angular first.

    Raises
    ------
    FrameNotFoundError, ShapeError, ArgumentError
        If there is no such frame (the message lists the nearest names), or an array or option is not as above.

    References
    ----------
    Lynch & Park (2017), 5.1; Featherstone (2008), 4.4.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.jacobian(dp.load("ur5"), np.zeros(6), "tool0").shape
    (6, 6)
    """
    return ask((JACOBIAN, frame, reference), q)


@public
def jacobian_dot(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Time derivative of the Jacobian, dJ/dt = X_f^-1 ((V_k - V_f) x s_k) by columns.

    V_f is the twist of the reference: zero for "world", the frame's twist for "local", the translation
    with the frame's origin for "local_world_aligned".

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v : array_like, shape (..., nv)
    frame : str, int or Frame
        A link or joint name, its index, or the frame itself.
    reference : "world", "local" or "local_world_aligned"
        Where the observer is, see `jacobian`.
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., 6, nv), rows [w; v].

    Raises
    ------
    FrameNotFoundError, ShapeError, ArgumentError
        If there is no such frame (the message lists the nearest names), or an array or option is not as above.

    References
    ----------
    Featherstone (2008), 2.11 and 4.4; Lynch & Park (2017), 5.1.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> float(abs(dp.jacobian_dot(robot, np.zeros(6), np.zeros(6), "tool0")).max())
    0.0
    """
    return ask((JACOBIAN_DOT, frame, reference), q, v)


@public
def frame_velocity(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Twist of a frame, J v.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v : array_like, shape (..., nv)
    frame : str, int or Frame
        A link or joint name, its index, or the frame itself.
    reference : "world", "local" or "local_world_aligned"
        Where the observer is, see `jacobian`.
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., 6)
        [w; v] in rad/s and m/s, about the origin and in the axes of the reference (see `jacobian`).

    Raises
    ------
    FrameNotFoundError, ShapeError, ArgumentError
        If there is no such frame (the message lists the nearest names), or an array or option is not as above.

    References
    ----------
    Lynch & Park (2017), 5.1; Featherstone (2008), 4.4.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.frame_velocity(dp.load("ur5"), np.zeros(6), np.zeros(6), "tool0").tolist()
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    return ask((FRAME_VELOCITY, frame, reference), q, v)


@public
def frame_acceleration(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    frame: FrameLike,
    reference: str = "world",
    *,
    classical: bool = False,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Spatial acceleration of a frame, without gravity.

        J a + dJ/dt v     the spatial one with "world" and "local", the classical one with
                          "local_world_aligned", whose observer moves along with the origin

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v, a : array_like, shape (..., nv)
    frame : str, int or Frame
        A link or joint name, its index, or the frame itself.
    reference : "world", "local" or "local_world_aligned"
        Where the observer is, see `jacobian`.
    classical : bool
        Add w x v to the linear part: with "local" or "local_world_aligned" this gives the acceleration of
        the frame's origin as a point, which an accelerometer there would measure without gravity.
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., 6)
        [angular; linear].

    Raises
    ------
    FrameNotFoundError, ShapeError, ArgumentError
        If there is no such frame (the message lists the nearest names), or an array or option is not as above.

    References
    ----------
    Featherstone (2008), 2.11.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.frame_acceleration(dp.load("ur5"), np.zeros(6), np.zeros(6), np.zeros(6), "tool0").shape
    (6,)
    """
    return ask((FRAME_ACCELERATION, frame, reference, classical), q, v, a)
