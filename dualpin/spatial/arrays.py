"""Rigid motions as arrays: dual quaternions (..., 8), matrices (..., 4, 4), motors (..., 6).

A dual quaternion is stored real part first, scalar first: w x y z | w x y z.  A motor is a twist
[w; v].  The classes of this package compute, with one array for each component.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import numbers, shaped
from ..dual import Dual
from ..errors import ArgumentError, ShapeError
from .pose import Pose
from .quaternion import Quaternion, displaced
from .vector import Matrix3, Vector3, motor


def _dual_quaternion(what: str, value: ArrayLike) -> Quaternion:
    x = np.moveaxis(shaped(what, value, 8), -1, 0)
    return Quaternion(*(Dual(x[i], x[i + 4]) for i in range(4)))


_UNIT = 1e-6  # tolerance of a norm: above rounding, below mistakes


def _motion(what: str, value: ArrayLike) -> Quaternion:
    """A unit dual quaternion: |r| = 1 and r . d = 0."""
    q = _dual_quaternion(what, value)
    norm, skew = np.sqrt(q.real.dot(q.real)), np.abs(q.real.dot(q.dual))
    wrong = (np.abs(norm - 1) > _UNIT) | (skew > _UNIT * (1 + np.sqrt(q.dual.dot(q.dual))))
    if np.any(wrong):
        at = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise ArgumentError(
            f"{what}: a unit dual quaternion r | d with |r| = 1 and r . d = 0 expected; they are "
            f"{float(norm[at]):.9g} and {float(skew[at]):.3g}" + (f" at index {at}" if at else "")
        )
    return q


def _together(what: str, *shapes: tuple[int, ...]) -> None:
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        raise ShapeError(f"{what}: the leading axes {', '.join(map(str, shapes))} do not broadcast together") from None


def _stack(q: Quaternion) -> np.ndarray:
    # + 0.0 removes the sign of zeros
    return np.stack(np.broadcast_arrays(*map(_float, (*q.real, *q.dual))), axis=-1) + 0.0


def _float(x: object) -> np.ndarray:
    return np.asarray(x if isinstance(x, np.ndarray) else float(x), dtype=float)  # type: ignore[arg-type]


def _motor(what: str, value: ArrayLike) -> Vector3:
    x = np.moveaxis(shaped(what, value, 6), -1, 0)
    return motor(Vector3(*x[:3]), Vector3(*x[3:]))


def from_matrix(T: ArrayLike) -> np.ndarray:
    """Dual quaternion of a homogeneous matrix, r + eps t r / 2 with w >= 0, shape (..., 8).

    Parameters
    ----------
    T : array_like, shape (..., 4, 4)
        Homogeneous matrices.

    Returns
    -------
    ndarray, shape (..., 8)
        w x y z of the real part, then of the dual part, w >= 0.

    Raises
    ------
    ArgumentError
        If the upper left block is not a rotation to 1e-6 or the last row is not 0 0 0 1.

    References
    ----------
    Shepperd (1978); Pennestri & Stefanelli (2007), Table 4.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> dp.spatial.from_matrix(np.eye(4)).tolist()
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    M = shaped("from_matrix: T", T, 4, 4)
    R = M[..., :3, :3]
    with np.errstate(invalid="ignore"):
        skewness = np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max(initial=0.0)
        proper = np.all(np.linalg.det(R) > 0) if R.size else True
    if skewness > 1e-6 or not proper or (np.abs(M[..., 3, :] - [0, 0, 0, 1]) > 1e-12).any():
        raise ArgumentError(
            f"from_matrix: a rotation and a last row 0 0 0 1 expected; |R^T R - 1| is {skewness:.3g}"
            + ("" if proper else ", det R is negative")
        )
    rows = [Vector3(*(R[..., i, j] for j in range(3))) for i in range(3)]
    r = Quaternion.from_rotation(Matrix3(*rows))
    return _stack(displaced(r, Vector3(*(M[..., i, 3] for i in range(3)))))


def to_matrix(x: ArrayLike) -> np.ndarray:
    """Homogeneous matrix of a unit dual quaternion, shape (..., 4, 4).

    Parameters
    ----------
    x : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Study (1903).

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.spatial.to_matrix([1, 0, 0, 0, 0, 0, 0, 0.5])[:3, 3].tolist()
    [0.0, 0.0, 1.0]
    """
    X = Pose.from_quaternion(_motion("to_matrix: x", x))
    rows = [np.broadcast_arrays(*map(_float, row)) for row in X.rows[:3]]
    shape = np.shape(rows[0][0])
    T = np.zeros((*shape, 4, 4))
    for i, row in enumerate(rows):
        for j, value in enumerate(row):
            T[..., i, j] = value
    T[..., 3, 3] = 1.0
    return T


def compose(a: ArrayLike, b: ArrayLike) -> np.ndarray:
    """The dual quaternion product a b: the motion b followed by a, both in the fixed frame, shape (..., 8).

    Parameters
    ----------
    a, b : array_like, shape (..., 8)
        Unit dual quaternions; b is applied first.

    Returns
    -------
    ndarray, shape (..., 8)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Study (1903); Lynch & Park (2017), 3.3.1, of the same product of matrices.

    Examples
    --------
    >>> import dualpin as dp
    >>> x = dp.spatial.exp([0, 0, 1, 0, 0, 2])
    >>> bool(abs(dp.spatial.log(dp.spatial.compose(x, x)) - [0, 0, 2, 0, 0, 4]).max() < 1e-15)
    True
    """
    p, q = _dual_quaternion("compose: a", a), _dual_quaternion("compose: b", b)
    _together("compose", np.shape(p.w.real), np.shape(q.w.real))
    return _stack(p * q)


def inverse(x: ArrayLike) -> np.ndarray:
    """The inverse of a unit dual quaternion, its conjugate, shape (..., 8).

    Parameters
    ----------
    x : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    ndarray, shape (..., 8)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Study (1903): the conjugate.

    Examples
    --------
    >>> import numpy as np
    >>> from dualpin.spatial import compose, exp, inverse
    >>> x = exp([0.1, 0.2, 0.3, 1.0, 2.0, 3.0])
    >>> bool(np.allclose(compose(x, inverse(x)), [1, 0, 0, 0, 0, 0, 0, 0]))
    True
    """
    return _stack(_motion("inverse: x", x).conjugate)


def exp(twist: ArrayLike) -> np.ndarray:
    """Unit dual quaternion of the motion with the constant twist [w; v] for one unit of time.

    ``exp`` of t n + eps (d n + t m): turn by t about the line n + eps m and slide by d along it;
    exact for every t, also near 0.

    Parameters
    ----------
    twist : array_like, shape (..., 6)
        [w; v] in rad and m, about the origin.

    Returns
    -------
    ndarray, shape (..., 8)

    Raises
    ------
    ShapeError, ArgumentError
        For other shapes.

    References
    ----------
    Study (1903); Lynch & Park (2017), 3.3.3.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.spatial.exp([0, 0, 0, 1, 2, 3]).tolist()
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.5]
    """
    x = shaped("exp: twist", twist, 6)
    rows = x.reshape(-1, 6)  # an array also for one sample: arrays give nan where floats raise
    with np.errstate(all="ignore"):
        return _stack(Quaternion.exp(_motor("exp: twist", rows) / 2)).reshape(*x.shape[:-1], 8)


def log(x: ArrayLike) -> np.ndarray:
    """The twist [w; v] with exp(twist) = +-x, |w| <= pi, shape (..., 6).

    x is a unit dual quaternion (..., 8), or a homogeneous matrix (..., 4, 4).

    Parameters
    ----------
    x : array_like, shape (..., 8)
        Unit dual quaternions.

    Returns
    -------
    ndarray, shape (..., 6)
        [w; v] in rad and m.

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Lynch & Park (2017), 3.3.3.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.spatial.log([1, 0, 0, 0, 0, 0.5, 0, 0]).tolist()
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
    """
    return _log(_either("log: x", x))


def _log(q: Quaternion) -> np.ndarray:
    m = q.log * 2
    return np.stack(np.broadcast_arrays(*map(_float, (*m.real, *m.dual))), axis=-1)


def _either(what: str, x: ArrayLike) -> Quaternion:
    try:
        matrices = np.shape(x)[-2:] == (4, 4)
    except ValueError:  # ragged: the next line raises
        matrices = False
    return _dual_quaternion(what, from_matrix(x)) if matrices else _motion(what, x)


def sclerp(a: ArrayLike, b: ArrayLike, s: ArrayLike) -> np.ndarray:
    """Screw linear interpolation a (a^-1 b)^s: constant screw motion from a (s = 0) to b (s = 1).

    It takes the shorter of the two motions.  (Kavan et al. 2008)

    Parameters
    ----------
    a, b : array_like, shape (..., 8)
    s : array_like, shape (...)

    Returns
    -------
    ndarray, shape (..., 8)

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Kavan, Collins, Zara & O'Sullivan (2008), Geometric skinning with approximate dual quaternion blending.

    Examples
    --------
    >>> import dualpin as dp
    >>> a, b = dp.spatial.exp([0] * 6), dp.spatial.exp([0, 0, 1, 0, 0, 2])
    >>> bool(abs(dp.spatial.sclerp(a, b, 0.5) - dp.spatial.exp([0, 0, 0.5, 0, 0, 1])).max() < 1e-15)
    True
    """
    step, share = log(compose(inverse(a), b)), numbers("sclerp: s", s)
    _together("sclerp", step.shape[:-1], share.shape)
    return compose(a, exp(step * share[..., None]))


@dataclass(frozen=True)
class ScrewParameters:
    """A finite screw motion.

    angle t in [0, pi] and distance d along the unit axis n; the axis is the line n + eps m with
    moment m = point x n, point its foot nearest to the origin; pitch d / t in metres per radian.
    A pure translation has angle 0, its direction as axis through the origin, and infinite pitch;
    the identity has the z axis, distance 0 and pitch 0.
    """

    angle: np.ndarray
    distance: np.ndarray
    axis: np.ndarray
    moment: np.ndarray
    point: np.ndarray
    pitch: np.ndarray


TURN = 8 * np.finfo(float).eps  # smaller angles cannot be distinguished from rounding in a rotation matrix


def screw_parameters(T: ArrayLike) -> ScrewParameters:
    """The screw of a displacement (Chasles): angle, distance, axis, moment, point, pitch.

    Parameters
    ----------
    T : array_like
        Homogeneous matrix (..., 4, 4) or unit dual quaternion (..., 8).

    Returns
    -------
    ScrewParameters

    Raises
    ------
    ShapeError, ArgumentError

    Notes
    -----
    From the logarithm t n + eps (d n + t m), exact near 0 and near pi; angles below 8 eps count
    as pure translations.

    References
    ----------
    Chasles (1830); Lynch & Park (2017), 3.3.2 and 3.3.3.

    Examples
    --------
    >>> import dualpin as dp
    >>> s = dp.spatial.screw_parameters(dp.spatial.exp([0, 0, 2, 0, -2, 3]))
    >>> [round(float(x), 12) for x in (s.angle, s.distance, s.pitch, *s.point)]
    [2.0, 3.0, 1.5, 1.0, 0.0, 0.0]
    """
    motor_ = _log(_either("screw_parameters: T", T))
    w, v = motor_[..., :3], motor_[..., 3:]
    turn, slide = np.linalg.norm(w, axis=-1), np.linalg.norm(v, axis=-1)
    turns = turn > TURN
    safe = np.where(turns, turn, 1.0)[..., None]
    still = np.where(slide > 0, slide, 1.0)[..., None]
    direction = np.where((slide > 0)[..., None], v / still, [0.0, 0.0, 1.0])
    axis = np.where(turns[..., None], w / safe, direction)
    distance = np.einsum("...i,...i", v, axis)
    moment = np.where(turns[..., None], (v - distance[..., None] * axis) / safe, 0.0)
    angle = np.where(turns | np.isnan(turn), turn, 0.0)
    pitch = np.where(turns, distance / safe[..., 0], np.where(slide > 0, np.inf, 0.0))
    return ScrewParameters(angle, distance, axis, moment, np.cross(axis, moment) + 0.0, pitch)
