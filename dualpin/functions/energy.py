"""Energy and momentum."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..call.public import ask, public
from ..model.robot import Robot
from ..terms import CENTROIDAL_MOMENTUM_MATRIX, KINETIC_ENERGY, POTENTIAL_ENERGY


@public
def kinetic_energy(
    robot: Robot, q: ArrayLike, v: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """T = v^T M v / 2 [J], shape (...,).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> float(dp.kinetic_energy(dp.load("ur5"), np.zeros(6), np.zeros(6)))
    0.0
    """
    return ask(KINETIC_ENERGY, q, v)


@public
def potential_energy(robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto") -> np.ndarray:
    """U = -sum m g . c [J], zero with all mass at the world's origin, shape (...,).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.potential_energy(dp.load("ur5"), np.zeros((3, 6))).shape
    (3,)
    """
    return ask(POTENTIAL_ENERGY, q)


@public
def centroidal_momentum_matrix(
    robot: Robot, q: ArrayLike, *, out: np.ndarray | None = None, engine: str = "auto"
) -> np.ndarray:
    """A(q) with momentum about the centre of mass = A v, world axes, shape (..., 6, nv).

    Rows [l; p], angular first.

    References
    ----------
    Orin & Goswami (2008).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.centroidal_momentum_matrix(dp.load("ur5"), np.zeros(6)).shape
    (6, 6)
    """
    return ask(CENTROIDAL_MOMENTUM_MATRIX, q)
