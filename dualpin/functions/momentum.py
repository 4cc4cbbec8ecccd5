"""Energy, momentum, and the centre of mass."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..call.public import ask, public
from ..model.robot import Robot
from ..terms import CENTROIDAL_MOMENTUM_MATRIX, COM, COM_JACOBIAN, KINETIC_ENERGY, POTENTIAL_ENERGY


@public
def kinetic_energy(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    *,
    out: np.ndarray | None = None,
    dtype: DTypeLike = "float64",
    engine: str = "auto",
) -> np.ndarray:
    """T = v^T M v / 2 [J], shape (...,).

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
    ndarray, shape (...,), or a number of one sample

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Featherstone (2008), 2.13; Lynch & Park (2017), 8.1.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> float(dp.kinetic_energy(dp.load("ur5"), np.zeros(6), np.zeros(6)))
    0.0
    """
    return ask(KINETIC_ENERGY, q, v)


@public
def potential_energy(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, dtype: DTypeLike = "float64", engine: str = "auto"
) -> np.ndarray:
    """U = -sum m g . c [J], zero with all mass at the world's origin, shape (...,).

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
    ndarray, shape (...,), or a number of one sample

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Lynch & Park (2017), 8.1.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.potential_energy(dp.load("ur5"), np.zeros((3, 6))).shape
    (3,)
    """
    return ask(POTENTIAL_ENERGY, q)


@public
def centroidal_momentum_matrix(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, dtype: DTypeLike = "float64", engine: str = "auto"
) -> np.ndarray:
    """A(q) with momentum about the centre of mass = A v, world axes, shape (..., 6, nv).

    Rows [l; p], angular first.

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
    ndarray, shape (..., 6, nv)
        Rows [l; p]: angular momentum [kg m^2/s], then linear [kg m/s].

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Orin & Goswami (2008).
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.centroidal_momentum_matrix(dp.load("ur5"), np.zeros(6)).shape
    (6, 6)
    """
    return ask(CENTROIDAL_MOMENTUM_MATRIX, q)


@public
def com(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, dtype: DTypeLike = "float64", engine: str = "auto"
) -> np.ndarray:
    """Centre of mass of the moving bodies in the world [m], shape (..., 3).

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
    ndarray, shape (..., 3)

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Featherstone (2008), 2.13, first moments of mass; over the bodies that joints move.
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.com(dp.load("ur5"), np.zeros(6)).shape
    (3,)
    """
    return ask(COM, q)


@public
def com_jacobian(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, dtype: DTypeLike = "float64", engine: str = "auto"
) -> np.ndarray:
    """Jacobian of the centre of mass, dc/dt = J v, world axes, shape (..., 3, nv).

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
    ndarray, shape (..., 3, nv)

    Raises
    ------
    ShapeError, ArgumentError
        If an array or an option is not as described above; the message says what was expected.

    References
    ----------
    Orin & Goswami (2008).
    Six-vectors, quaternions and the order of joints: docs/conventions.md.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.com_jacobian(dp.load("ur5"), np.zeros(6)).shape
    (3, 6)
    """
    return ask(COM_JACOBIAN, q)
