"""Inertia matrix, its inverse, and Coriolis matrix."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..arguments import flag
from ..call.public import ask, public
from ..model.robot import Robot
from ..terms import CORIOLIS, CRBA, CRBA_TRIANGLE, MINV


@public
def crba(
    robot: Robot,
    q: ArrayLike,
    *,
    triangle: bool = False,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Joint-space inertia matrix M(q), full and symmetric, shape (..., nv, nv), or its lower triangle.

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    triangle : bool
        Only the lower triangle, row by row: the entries ``M[np.tril_indices(nv)]``, half the memory.
    out : ndarray, optional
        An array for the result, of its shape and of type `dtype`.
    dtype : float64 or float32
        Type of the computation and of the result; arrays of another type are converted.
    engine : "auto", "compiled", "tiered", "numpy" or "cuda"
        How it is computed, see docs/engine.md.

    Returns
    -------
    ndarray, shape (..., nv, nv), or (..., nv (nv + 1) / 2) as a triangle

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Walker & Orin (1982); Featherstone (2008), 6.2.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot, q = dp.load("ur5"), np.zeros(6)
    >>> M = dp.crba(robot, q)
    >>> bool((M == M.T).all())
    True
    >>> bool((dp.crba(robot, q, triangle=True) == M[np.tril_indices(6)]).all())
    True
    """
    return ask(CRBA_TRIANGLE if flag("crba: triangle", triangle) else CRBA, q)


@public
def coriolis(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """Coriolis matrix C(q, v), shape (..., nv, nv): that of the Christoffel symbols, with dM/dt = C + C^T.

    Many matrices give the same C v; this one makes dM/dt - 2 C skew for every q and v.  With a
    floating base it is the matrix of the Levi-Civita connection in body velocities.

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
    ndarray, shape (..., nv, nv)

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Echeandia & Wensing (2021).
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, v, _ = robot.sample(seed=0)
    >>> C = dp.coriolis(robot, q, v)
    >>> bool(np.allclose(C @ v + dp.gravity(robot, q), dp.bias(robot, q, v)))
    True
    """
    return ask(CORIOLIS, q, v)


@public
def minv(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, dtype: DTypeLike = "float64", engine: str = "auto"
) -> np.ndarray:
    """Inverse of the joint-space inertia matrix, shape (..., nv, nv), by its branch-sparse L^T D L factors.

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
    ndarray, shape (..., nv, nv)

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Featherstone (2008), 6.5.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q = np.zeros(6)
    >>> bool(np.allclose(dp.minv(robot, q) @ dp.crba(robot, q), np.eye(6)))
    True
    """
    return ask(MINV, q)
