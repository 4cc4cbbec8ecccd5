"""Steps between configurations, on their group."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..call.public import ask, public
from ..model.robot import Robot
from ..terms import DIFFERENCE, INTEGRATE


@public
def integrate(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """The configuration reached from q by moving with v for one unit of time, shape (..., nq).

    On the group: a floating base moves along the screw of its twist, q * exp(v).

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
    ndarray, shape (..., nq)

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Munthe-Kaas (1998); Lynch & Park (2017), 3.3.3, the exponential of a twist.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import dualpin as dp
    >>> robot = dp.load("ur5", floating=True)
    >>> q, v, _ = robot.sample(seed=0)
    >>> bool(abs(dp.difference(robot, q, dp.integrate(robot, q, 0.1 * v)) - 0.1 * v).max() < 1e-14)
    True
    """
    return ask(INTEGRATE, q, v)


@public
def difference(
    robot: Robot,
    q0: ArrayLike,
    q1: ArrayLike,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """The v with integrate(q0, v) = q1, shape (..., nv).

    Parameters
    ----------
    robot : Robot
    q0, q1 : array_like, shape (..., nq)
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
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Lynch & Park (2017), 3.3.3, the logarithm of a rigid motion.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.difference(dp.load("ur5"), np.zeros(6), np.ones(6)).tolist()
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    return ask(DIFFERENCE, q0, q1)
