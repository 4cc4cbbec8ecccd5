"""Points, lines and planes transformed by dual quaternions, q x q*, with different conjugates.

A line u + eps m is a dual vector; its right factor is q*.  A point 1 + eps p and a plane n - eps d need both
conjugates: the right factor is q* with eps replaced by -eps.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import shaped
from ..dual import Dual
from ..errors import ArgumentError, ShapeError
from ..scalars import ONE, ZERO
from .arrays import _either, _float, _motion, _stack, from_matrix
from .quaternion import Quaternion
from .vector import Vector3


def transform_points(x: ArrayLike, points: ArrayLike) -> np.ndarray:
    """Points transformed by a motion:  1 + eps p' = q (1 + eps p) conj(q*),  conj: eps to -eps.

    Parameters
    ----------
    x : array_like
        Unit dual quaternion (..., 8), or homogeneous matrix (..., 4, 4).
    points : array_like, shape (..., k, 3)
        [m], or one point (3,).

    Returns
    -------
    ndarray, shape (..., k, 3)

    Raises
    ------
    ArgumentError, ShapeError
        If x is not a motion, or the leading axes do not broadcast.

    References
    ----------
    Gouasmi et al. (2020), eqs A11, A14; Kavan et al. (2008).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> x = dp.spatial.exp([0, 0, np.pi / 2, 0, 0, 1.0])
    >>> (dp.spatial.transform_points(x, [[1.0, 0, 0], [0, 0, 2.0]]).round(12) + 0.0).tolist()
    [[0.0, 1.0, 1.0], [0.0, 0.0, 3.0]]
    """
    p, alone = _items("transform_points: points", points, 3)
    q = _against("transform_points", x, p)
    moved = q * _pure(ONE, p) * q.dual_conjugate.conjugate
    return _columns([c.dual for c in moved.v], alone)


def transform_lines(x: ArrayLike, lines: Any) -> Any:
    """Lines, and all dual vectors, transformed by a motion:  u' + eps m' = q (u + eps m) q*.

    Parameters
    ----------
    x : array_like
        Unit dual quaternion (..., 8), or homogeneous matrix (..., 4, 4).
    lines : array_like, shape (..., k, 6), or with parts .real, .dual of shape (..., k, 3)
        [direction | moment about the origin], or one of them (6,); also twists [w; v].  Dual arrays and
        `dualpin.algebra.line` give both parts.

    Returns
    -------
    ndarray, shape (..., k, 6), or Dual, shape (..., k, 3), as given

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Study (1903); Daniilidis (1999); Gouasmi et al. (2020), eq A3 by transference.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> x = dp.spatial.exp([0, 0, 0, 0, 2.0, 0])  # two metres along y
    >>> dp.spatial.transform_lines(x, [[0, 0, 1.0, 0, 0, 0]]).tolist()
    [[0.0, 0.0, 1.0, 2.0, 0.0, 0.0]]
    """
    dual = hasattr(lines, "dual")
    six = np.concatenate((lines.real, lines.dual), axis=-1) if dual else lines
    l, alone = _items("transform_lines: lines", six, 6)
    q = _against("transform_lines", x, l)
    line = Vector3(*(Dual(l[..., i], l[..., i + 3]) for i in range(3)))
    moved = (q * Quaternion(ZERO, *line) * q.conjugate).v
    out = _columns([*(c.real for c in moved), *(c.dual for c in moved)], alone)
    return Dual(out[..., :3], out[..., 3:]) if dual else out


def transform_planes(x: ArrayLike, planes: ArrayLike) -> np.ndarray:
    """Planes n . p = d transformed by a motion:  n' - eps d' = q (n - eps d) conj(q*),  conj: eps to -eps.

    Parameters
    ----------
    x : array_like
        Unit dual quaternion (..., 8), or homogeneous matrix (..., 4, 4).
    planes : array_like, shape (..., k, 4)
        [n | d], or one plane (4,); d is the distance from the origin along n if n has length one [m].

    Returns
    -------
    ndarray, shape (..., k, 4)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Selig (2005), *Geometric Fundamentals of Robotics*, 9.3.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.spatial.transform_planes(dp.spatial.exp([0, 0, 0, 0, 0, 3.0]), [0, 0, 1.0, 0.5]).tolist()
    [0.0, 0.0, 1.0, 3.5]
    """
    n, alone = _items("transform_planes: planes", planes, 4)
    q = _against("transform_planes", x, n)
    plane = Quaternion(Dual(ZERO, -n[..., 3]), *(Dual(n[..., i], ZERO) for i in range(3)))
    moved = q * plane * q.dual_conjugate.conjugate
    return _columns([*(c.real for c in moved.v), -moved.w.dual], alone)


def quaternion_to_matrix(q: ArrayLike) -> np.ndarray:
    """Rotation matrices of unit quaternions w x y z, shape (..., 3, 3).

    Parameters
    ----------
    q : array_like, shape (..., 4)
        Scalar first; q and -q are the same rotation.

    Returns
    -------
    ndarray, shape (..., 3, 3)

    Raises
    ------
    ArgumentError
        If a norm is not 1 to 1e-6.

    References
    ----------
    Euler (1771); Hamilton (1844).

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.spatial.quaternion_to_matrix([0.5, 0.5, 0.5, 0.5]).tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    """
    x = shaped("quaternion_to_matrix: q", q, 4)
    _motion("quaternion_to_matrix: q", np.concatenate((x, np.zeros(x.shape)), axis=-1))
    R = Quaternion(*np.moveaxis(x, -1, 0)).rotation
    return np.stack([np.stack(np.broadcast_arrays(*map(_float, row)), axis=-1) for row in R.rows], axis=-2)


def matrix_to_quaternion(R: ArrayLike) -> np.ndarray:
    """Unit quaternions w x y z of rotation matrices, w >= 0, shape (..., 4); exact at every angle.

    Parameters
    ----------
    R : array_like, shape (..., 3, 3)

    Returns
    -------
    ndarray, shape (..., 4)

    Raises
    ------
    ArgumentError
        If a matrix is not a rotation to 1e-6.

    References
    ----------
    Shepperd (1978); Pennestri & Stefanelli (2007), Table 4.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.spatial.matrix_to_quaternion([[0, 0, 1], [1, 0, 0], [0, 1, 0]]).tolist()
    [0.5, 0.5, 0.5, 0.5]
    """
    x = shaped("matrix_to_quaternion: R", R, 3, 3)
    T = np.zeros((*x.shape[:-2], 4, 4))
    T[..., :3, :3], T[..., 3, 3] = x, 1.0
    try:
        return from_matrix(T)[..., :4]
    except ArgumentError as e:
        raise ArgumentError(str(e).replace("from_matrix", "matrix_to_quaternion")) from None


def _items(what: str, value: Any, size: int) -> tuple[np.ndarray, bool]:
    """(..., k, size), and whether there was only one, without the axis k."""
    x = shaped(what, value, size)
    return (x[None], True) if x.ndim == 1 else (x, False)


def _against(who: str, x: ArrayLike, items: np.ndarray) -> Quaternion:
    """The motion with one more axis, (..., 1), to broadcast with items (..., k, size)."""
    q = _stack(_either(f"{who}: x", x))[..., None, :]
    try:
        np.broadcast_shapes(q.shape[:-1], items.shape[:-1])
    except ValueError:
        raise ShapeError(
            f"{who}: motions {q.shape[:-2]} and {items.shape[:-1]} of (..., k) do not broadcast together"
        ) from None
    return Quaternion(*(Dual(q[..., i], q[..., i + 4]) for i in range(4)))


def _pure(scalar: Any, p: np.ndarray) -> Quaternion:
    """scalar + eps p."""
    return Quaternion(Dual(scalar, ZERO), *(Dual(ZERO, p[..., i]) for i in range(3)))


def _columns(parts: list[Any], alone: bool) -> np.ndarray:
    out = np.stack(np.broadcast_arrays(*map(_float, parts)), axis=-1) + 0.0
    return out[..., 0, :] if alone else out
