"""Changes of frame as 6x6 matrices.  The algorithms do not use them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import from_matrix


def adjoint(T: ArrayLike) -> np.ndarray:
    """Ad_T: transforms a twist [w; v] from the frame T to the frame in which T is given, shape (..., 6, 6).

        Ad = [R, 0; [p] R, R]

    Its inverse transpose transforms wrenches, see `coadjoint`.

    Parameters
    ----------
    T : array_like, shape (..., 4, 4)
        Homogeneous matrices.

    Returns
    -------
    ndarray, shape (..., 6, 6)
        Angular part first.

    Raises
    ------
    ArgumentError
        If a matrix is not a rigid motion.

    References
    ----------
    Lynch & Park (2017), 3.3.2; Featherstone (2008), 2.8.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot, q = dp.load("ur5"), np.ones(6)
    >>> T = dp.fk(robot, q, "tool0")
    >>> world, local = (dp.jacobian(robot, q, "tool0", seen) for seen in ("world", "local"))
    >>> bool(np.allclose(dp.spatial.adjoint(T) @ local, world))
    True
    """
    R, p = _parts(T)
    return _blocks(R, cross_matrix(p) @ R, lower=True)


def coadjoint(T: ArrayLike) -> np.ndarray:
    """Ad_T^-T: transforms a wrench [n; f] from the frame T to the frame in which T is given, shape (..., 6, 6).

        Ad^-T = [R, [p] R; 0, R]

    Parameters
    ----------
    T : array_like, shape (..., 4, 4)
        Homogeneous matrices.

    Returns
    -------
    ndarray, shape (..., 6, 6)
        Moment first.

    Raises
    ------
    ArgumentError
        If a matrix is not a rigid motion.

    References
    ----------
    Featherstone (2008), 2.8.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> T = dp.fk(dp.load("ur5"), np.ones(6), "tool0")
    >>> bool(np.allclose(dp.spatial.coadjoint(T).T @ dp.spatial.adjoint(T), np.eye(6)))
    True
    """
    R, p = _parts(T)
    return _blocks(R, cross_matrix(p) @ R, lower=False)


def inverted(T: np.ndarray) -> np.ndarray:
    """[R^T, -R^T p], the inverse of a rigid motion (..., 4, 4)."""
    out, turned = np.zeros_like(T), np.swapaxes(T[..., :3, :3], -1, -2)
    out[..., :3, :3], out[..., :3, 3:], out[..., 3, 3] = turned, -turned @ T[..., :3, 3:], 1.0
    return out


def _parts(T: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    from_matrix(T)  # raises if it is not a rigid motion
    X = np.asarray(T, dtype=float)
    return X[..., :3, :3], X[..., :3, 3]


def cross_matrix(p: np.ndarray) -> np.ndarray:
    """[p] (..., 3, 3) with  [p] b = p x b."""
    x, y, z = p[..., 0], p[..., 1], p[..., 2]
    out = np.zeros((*p.shape, 3), np.result_type(p, float))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -z, y, -x
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = z, -y, x
    return out


def _blocks(R: np.ndarray, pR: np.ndarray, *, lower: bool) -> np.ndarray:
    A = np.zeros((*R.shape[:-2], 6, 6))
    A[..., :3, :3] = A[..., 3:, 3:] = R
    A[..., slice(3, 6) if lower else slice(3), slice(3) if lower else slice(3, 6)] = pR
    return A
