"""Displacements as dual orthogonal matrices, dual Euler parameters and finite screws."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import is_symbol, shaped
from ..dual import Dual, atan, stack, tan
from ..errors import ArgumentError, DualDivisionError, ShapeError
from ..parts import array
from ..scalars import ZERO, Exact
from ..spatial import Matrix3, Quaternion, Rotation, Vector3, compose, from_matrix, inverse
from ..spatial import log as twist_of
from .arguments import EPSILON, matrices, where
from .motors import LineVector, Motor, as_motor


def dual_matrix(T: ArrayLike) -> Dual:
    """The dual orthogonal matrix R + eps [p] R of homogeneous matrices, shape (..., 3, 3).

    It transforms motors from the child frame to the parent: composition is the product, inversion the transpose.

    Parameters
    ----------
    T : array_like, shape (..., 4, 4)
        Homogeneous matrices.

    Returns
    -------
    Dual, shape (..., 3, 3)

    Raises
    ------
    ShapeError, ArgumentError
        If they are not homogeneous matrices.

    References
    ----------
    Kotelnikov (1895); Study (1903).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> T = np.eye(4); T[:3, 3] = 1, 2, 3
    >>> dp.algebra.dual_matrix(T).dual.tolist()
    [[0.0, -3.0, 2.0], [3.0, 0.0, -1.0], [-2.0, 1.0, 0.0]]
    """
    M = shaped("dual_matrix: T", T, 4, 4)
    R, p = M[..., :3, :3], M[..., :3, 3]
    return Dual(R, np.cross(p[..., None, :], R.swapaxes(-1, -2)).swapaxes(-1, -2) + 0.0)


def homogeneous(A: Any) -> np.ndarray:
    """The homogeneous matrix of a dual orthogonal one: [p] = A' R^T, shape (..., 4, 4).

    Parameters
    ----------
    A : Dual, shape (..., 3, 3)

    Returns
    -------
    ndarray, shape (..., 4, 4)

    Raises
    ------
    ShapeError
        For other shapes.

    References
    ----------
    Study (1903).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> T = np.eye(4); T[:3, 3] = 1, 2, 3
    >>> bool((dp.algebra.homogeneous(dp.algebra.dual_matrix(T)) == T).all())
    True
    """
    R, D = matrices("homogeneous: A", A)
    S = D @ R.swapaxes(-1, -2)
    T = np.zeros((*R.shape[:-2], 4, 4))
    T[..., :3, :3], T[..., 3, 3] = R, 1.0
    T[..., 0, 3], T[..., 1, 3], T[..., 2, 3] = ((S[..., i, j] - S[..., j, i]) / 2 for i, j in ((2, 1), (0, 2), (1, 0)))
    return T


def euler_parameters(A: Any) -> Dual:
    """Dual Euler parameters e_0 ... e_3 of a dual orthogonal matrix: its dual quaternion, shape (..., 4).

    The square root of the largest of the four 4 e_i^2 is taken; the other three follow by division:

        4 e0^2 = 1 + a11 + a22 + a33,   4 e1^2 = 1 + a11 - a22 - a33,   ...
        a32 - a23 = 4 e0 e1,   a21 + a12 = 4 e1 e2,   ...

    Parameters
    ----------
    A : Dual, shape (..., 3, 3); or array_like, homogeneous matrices (..., 4, 4)

    Returns
    -------
    Dual, shape (..., 4), with e_0 >= 0

    Raises
    ------
    ShapeError, ArgumentError
        For other shapes, or matrices that are not dual orthogonal.

    References
    ----------
    Pennestri & Stefanelli (2007), Table 4.

    Examples
    --------
    >>> import dualpin as dp
    >>> A = dp.Dual([[0, 0, 1], [1, 0, 0], [0, 1, 0]], [[-1, 0, 0], [0, -1, 1], [1, 0, 0]])
    >>> dp.algebra.euler_parameters(A).dual.tolist()
    [-0.5, 0.0, 0.0, 0.5]
    """
    A = A if isinstance(A, Dual) or np.shape(A)[-2:] != (4, 4) else dual_matrix(A)
    a, b = matrices("euler_parameters: A", A)
    if a.shape[-2:] != (3, 3):
        raise ShapeError(f"euler_parameters: dual matrices (..., 3, 3) or poses (..., 4, 4) expected, got {a.shape}")
    _check_orthogonal("euler_parameters", a, b)
    R = Matrix3(*(Vector3(*(Dual(a[..., i, j], b[..., i, j]) for j in range(3))) for i in range(3)))
    return stack(list(Quaternion.from_rotation(R)), axis=-1)


def _check_orthogonal(what: str, a: np.ndarray, b: np.ndarray) -> None:
    G = Dual(a, b).mT @ Dual(a, b)
    off = np.maximum(np.abs(G.real - np.eye(3)).max(axis=(-1, -2)), np.abs(G.dual).max(axis=(-1, -2)))
    wrong = off > 1e-6 * np.maximum(1.0, np.abs(b).max(axis=(-1, -2)))
    if np.any(wrong):
        at = f"{float(np.max(off)):.3g}{where(wrong)}"
        raise ArgumentError(f"{what}: a dual orthogonal matrix expected; |A^T A - 1| is {at}")


def screw_matrix(axis: Any, angle: Any) -> Dual:
    """The dual matrix of the rotation by t about and translation by d along a line, for t + eps d, (..., 3, 3).

        A = E E^T + cos(t) (1 - E E^T) + sin(t) [E]

    Parameters
    ----------
    axis : LineVector, Motor, Dual (..., 3) or array_like (..., 6)
        A unit line.
    angle : Dual, number or array of them
        t + eps d in rad and m.

    Returns
    -------
    Dual, shape (..., 3, 3)

    Raises
    ------
    ShapeError
        If the last axis is not that of a motor.

    References
    ----------
    Rodrigues (1840); by transference, Study (1903).

    Examples
    --------
    >>> import dualpin as dp
    >>> A = dp.algebra.screw_matrix(dp.algebra.line([1, 0, 0], [0, 0, 1]), dp.Dual(0.5, 2.0))
    >>> dp.algebra.homogeneous(A)[:3, 3].round(4).tolist()
    [0.1224, -0.4794, 2.0]
    """
    E = as_motor("screw_matrix", axis).axis.vector
    return stacked(Rotation.about(Vector3(*(E[..., i] for i in range(3))), _angle(angle)))


def stacked(R: Matrix3) -> Dual:
    """The entries of a matrix of dual numbers as one dual array, shape (..., 3, 3)."""
    entries = [x if isinstance(x, Dual) else Dual(x, ZERO) for row in R.rows for x in row]
    if any(is_symbol(part) for x in entries for part in (x.real, x.dual)):  # whole numbers become integers, not 1.0
        return Dual(*(np.array([_whole(getattr(x, p)) for x in entries], dtype=object).reshape(3, 3)
                      for p in ("real", "dual")))  # fmt: skip
    shape = np.broadcast_shapes(*(x.shape for x in entries))
    return Dual(*(np.stack([_entry(getattr(x, part), shape) for x in entries], axis=-1).reshape(*shape, 3, 3)
                  for part in ("real", "dual")))  # fmt: skip


def _whole(x: Any) -> Any:
    return x.n if type(x) is Exact else x


def _entry(x: Any, shape: tuple[int, ...]) -> np.ndarray:
    return np.broadcast_to(array(x), shape)


def _angle(angle: Any) -> Dual:
    return angle if isinstance(angle, Dual) else Dual(np.asarray(angle, dtype=float), 0.0)


def rodrigues(axis: Any, angle: Any) -> Motor:
    """The dual Rodrigues vector T = E tan(t / 2) of a finite screw with dual angle t about the line E.

    Parameters
    ----------
    axis : LineVector, Motor, Dual (..., 3) or array_like (..., 6)
        A unit line.
    angle : Dual, number or array of them
        t + eps d in rad and m; not an odd multiple of pi.

    Returns
    -------
    Motor

    Raises
    ------
    ShapeError
        If the last axis is not that of a motor.

    References
    ----------
    Rodrigues (1840); Pennestri & Stefanelli (2007), eqs 49-50, their composition.

    Examples
    --------
    >>> import dualpin as dp
    >>> T = dp.algebra.rodrigues(dp.algebra.line([1, 0, 0], [0, 0, 1]), dp.Dual(0.5, 2.0))
    >>> t, axis = dp.algebra.screw_of(T)
    >>> round(float(t.real), 12), round(float(t.dual), 12), (axis.point.round(12) + 0.0).tolist()
    (0.5, 2.0, [1.0, 0.0, 0.0])
    """
    return as_motor("rodrigues", axis).axis * tan(_angle(angle) / 2)


def compose_screws(first: Any, second: Any, *, body: bool = False) -> Motor:
    """The dual Rodrigues vector of two finite screws in turn.

        T = (T1 + T2 - T1 x T2) / (1 - T1.T2)

    Parameters
    ----------
    first, second : Motor, Dual (..., 3) or array_like (..., 6)
        Rodrigues vectors, see `rodrigues`.
    body : bool
        False: both axes are given in the fixed frame (R = R2 R1).  True: the second moves with the body, and
        the sign of the cross product is plus.

    Returns
    -------
    Motor

    Raises
    ------
    DualDivisionError
        If 1 - T1.T2 has no real part: the result turns by pi, where tan(t / 2) has no value.

    References
    ----------
    Pennestri & Stefanelli (2007), eq 50.

    Examples
    --------
    >>> import dualpin as dp
    >>> E, line = dp.algebra.rodrigues, dp.algebra.line
    >>> z = line([0, 0, 0], [0, 0, 1])
    >>> angle, axis = dp.algebra.screw_of(dp.algebra.compose_screws(E(z, dp.Dual(1.0, 2.0)), E(z, dp.Dual(0.5, 1.0))))
    >>> round(float(angle.real), 12), round(float(angle.dual), 12)
    (1.5, 3.0)
    """
    a, b = as_motor("compose_screws", first), as_motor("compose_screws", second)
    bottom = 1 - a.dot(b)
    # at a half turn only the rounding of T1.T2 remains
    lost = np.asarray(np.abs(bottom.real) <= 4 * EPSILON * (1 + np.abs(a.dot(b).real)))
    if np.any(lost):
        raise DualDivisionError(
            f"compose_screws: 1 - T1.T2{where(lost)} has no real part: the screws make a half turn, which has no "
            "Rodrigues vector; compose dual quaternions instead (dualpin.spatial.compose)"
        )
    across = a.cross(b)
    return (a + b + (across if body else -across)) * (1 / bottom)


def screw_of(rodrigues_vector: Any) -> tuple[Dual, LineVector]:
    """The dual angle t in (0, pi) and the axis of T = E tan(t / 2).

    Parameters
    ----------
    rodrigues_vector : Motor, Dual (..., 3) or array_like (..., 6)
        As `rodrigues` returns it.

    Returns
    -------
    t : Dual, shape (...,)
        t + eps d in rad and m, t in (0, pi).
    axis : LineVector

    Raises
    ------
    DualDivisionError
        For a pure translation, which has no axis.

    References
    ----------
    Pennestri & Stefanelli (2007), eqs 49-50, the composition of such vectors.

    Examples
    --------
    >>> import dualpin as dp
    >>> t, axis = dp.algebra.screw_of([0, 0, 1, 0, -1, 0])
    >>> round(float(t.real), 6), (axis.point.round(12) + 0.0).tolist()
    (1.570796, [1.0, 0.0, 0.0])
    """
    T = as_motor("screw_of", rodrigues_vector)
    size = T.magnitude
    return atan(size) * 2, T.axis


def twist_between(T0: ArrayLike, T1: ArrayLike, dt: float = 1.0) -> Motor:
    """The constant twist w + eps v, about the world's origin, that moves the pose T0 to T1 in the time dt.

        T1 = exp(dt V) T0

    Its axis and pitch are the screw of the motion; for small dt the instantaneous screw axis.

    Parameters
    ----------
    T0, T1 : array_like
        Homogeneous matrices (..., 4, 4) or dual quaternions (..., 8).
    dt : float
        The time between them [s].

    Returns
    -------
    Motor
        In rad/s and m/s.

    Raises
    ------
    ShapeError, ArgumentError
        If they are not poses.

    References
    ----------
    Lynch & Park (2017), 3.3.3, the logarithm of a rigid motion.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> T1 = dp.spatial.to_matrix(dp.spatial.exp([0, 0, 1, 0, -2, 0.5]))
    >>> m = dp.algebra.twist_between(np.eye(4), T1)
    >>> (m.point.round(12) + 0.0).tolist(), round(float(m.pitch), 12)
    ([2.0, 0.0, 0.0], 0.5)
    """
    x0, x1 = (from_matrix(x) if np.shape(x)[-2:] == (4, 4) else np.asarray(x, dtype=float) for x in (T0, T1))
    twist = twist_of(compose(x1, inverse(x0))) / dt
    return Motor(twist[..., :3], twist[..., 3:])
