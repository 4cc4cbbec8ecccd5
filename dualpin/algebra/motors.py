"""Motors: dual vectors M + eps M', and lines among them.

A motor is a twist w + eps v, a wrench f + eps n, or a line u + eps (p x u).  Arrays of them are dual
arrays (..., 3); every function here takes a `Motor`, a `Dual` array (..., 3) or an array (..., 6) of
[real part | dual part].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..dual import Dual, stack
from ..errors import ShapeError
from ..spatial.vector import Vector3
from .arguments import EPSILON, SingularError, dual_array, length, scaled, where

ROUNDING = 64 * EPSILON  # values below count as zero: the rounding of a few operations on entries of size 1


class Motor:
    """An array of motors:  M + eps M', a magnitude times a line:  (a + eps a') (u + eps p x u).

    Parameters
    ----------
    real, dual : array_like, shape (..., 3)
        M and its moment M' about the origin, [M'] = [M] length in kinematics; or both as one `Dual`.

    Notes
    -----
    `dualpin.spatial.Vector3` over dual numbers defines the algebra of motors; this class holds arrays of them and
    adds their geometry.

    References
    ----------
    Study (1903); Pennestri & Stefanelli (2007), sec. 3.

    Examples
    --------
    >>> import dualpin as dp
    >>> m = dp.algebra.Motor([0, 0, 2], [0, -2, 3])
    >>> float(m.pitch), (m.point + 0).tolist(), str(m.kind)
    (1.5, [1.0, 0.0, 0.0], 'screw')
    """

    __slots__ = ("dual", "real")
    __array_ufunc__ = None
    real: np.ndarray
    dual: np.ndarray

    def __init__(self, real: ArrayLike, dual: ArrayLike | None = None) -> None:
        whole = real if dual is None else Dual(np.asarray(real), np.asarray(dual))
        a, b = dual_array(type(self).__name__, whole, 1, symbols=True)
        if a.shape[-1] != 3:
            raise ShapeError(f"{type(self).__name__}: parts of shape (..., 3) expected, got {a.shape}")
        self.real, self.dual = a, b

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.real.tolist()}, {self.dual.tolist()})"

    def __getitem__(self, index: Any) -> Motor:
        """Motors of a batch; the three components stay together."""
        key = (*(index if isinstance(index, tuple) else (index,)), Ellipsis, slice(None))
        return type(self)(self.real[key], self.dual[key])

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the batch."""
        return self.real.shape[:-1]

    @property
    def vector(self) -> Dual:
        """The same as a dual array (..., 3)."""
        return Dual(self.real, self.dual)

    @property
    def six(self) -> np.ndarray:
        """[real part | dual part], shape (..., 6): of a twist [w; v]."""
        return np.concatenate((self.real, self.dual), axis=-1)

    @property
    def entries(self) -> Vector3:
        """The same as a vector of three dual numbers (...)."""
        return Vector3(*(Dual(self.real[..., i], self.dual[..., i]) for i in range(3)))

    @staticmethod
    def of_entries(v: Vector3) -> Motor:
        """The array of a vector of dual numbers."""
        whole = stack([Dual(*x.arrays) for x in v], axis=-1)
        return Motor(whole.real, whole.dual)

    # algebra

    def __neg__(self) -> Motor:
        return Motor(-self.real, -self.dual)

    def __add__(self, b: Motor) -> Motor:
        b = as_motor("sum", b)
        return Motor(self.real + b.real, self.dual + b.dual)

    def __sub__(self, b: Motor) -> Motor:
        return self + -as_motor("difference", b)

    def __mul__(self, s: Any) -> Motor:
        """The product with a dual number a + eps a': scaled by a, with the pitch increased by a' / a."""
        s = s if isinstance(s, Dual) else Dual(np.asarray(s, dtype=float))
        return Motor.of_entries(self.entries * s)

    __rmul__ = __mul__

    def __eq__(self, b: object) -> Any:
        if not isinstance(b, Motor):
            return NotImplemented
        return bool(np.array_equal(self.real, b.real) and np.array_equal(self.dual, b.dual))

    __hash__ = None  # type: ignore[assignment]

    def dot(self, b: Any) -> Dual:
        """A.B + eps (A.B' + A'.B);  of lines cos(theta), theta their dual angle."""
        found: Dual = self.entries.dot(as_motor("dot", b).entries)
        return found

    def cross(self, b: Any) -> Motor:
        """A x B + eps (A x B' + A' x B);  of lines sin(theta) times their common perpendicular."""
        return Motor.of_entries(self.entries.cross(as_motor("cross", b).entries))

    # geometry

    @property
    def magnitude(self) -> Dual:
        """sqrt(M.M) = a + eps M.M' / a; raises `DualDivisionError` for a couple."""
        unit, scale = scaled(self.real, -1)
        size = np.sqrt(_dot(unit, unit))
        _need_direction("magnitude", size)
        return Dual(size * scale[..., 0], _dot(unit, self.dual) / size)

    @property
    def axis(self) -> LineVector:
        """The unit line M / sqrt(M.M) along which the motor acts, shape (..., 3)."""
        return LineVector.of(self.vector / self.magnitude[..., None])

    @property
    def direction(self) -> np.ndarray:
        """Unit vector of the real part; for a couple, of its dual part."""
        size, moment = (length(x, -1, keepdims=True) for x in (self.real, self.dual))
        safe = np.where(moment > 0, moment, 1.0)
        return np.where(size > 0, self.real / np.where(size > 0, size, 1.0), self.dual / safe)

    @property
    def point(self) -> np.ndarray:
        """The point of the axis nearest to the origin, M x M' / M.M."""
        unit, scale = scaled(self.real, -1)
        square = _dot(unit, unit)
        _need_direction("point", square)
        return np.cross(unit, self.dual / scale) / square[..., None]

    @property
    def pitch(self) -> np.ndarray:
        """M.M' / M.M in metres per radian (for a twist); infinite for a couple, nan for zero."""
        unit, scale = scaled(self.real, -1)
        square, mixed = _dot(unit, unit), _dot(unit, self.dual / scale)
        no_couple = np.where(np.any(self.dual != 0, axis=-1), np.inf, np.nan)
        return np.where(square > 0, mixed / np.where(square > 0, square, 1.0), no_couple)

    @property
    def kind(self) -> np.ndarray:
        """ "screw", "line", "couple" or "zero"; see `classify`."""
        return classify(self)

    def shifted(self, origin: ArrayLike) -> Motor:
        """The same motor about another origin P:  M' + (O - P) x M."""
        return Motor(self.real, self.dual - np.cross(np.asarray(origin, dtype=float), self.real))


class LineVector(Motor):
    """A directed line in space as a unit line vector,  u + eps p x u  with |u| = 1, for any point p of it."""

    __slots__ = ()

    @classmethod
    def of(cls, vector: Dual) -> LineVector:
        return cls(vector.real, vector.dual)

    def __neg__(self) -> LineVector:
        """The same line with the opposite direction."""
        return LineVector(-self.real, -self.dual)

    @property
    def moment(self) -> np.ndarray:
        return self.dual

    def at(self, t: ArrayLike) -> np.ndarray:
        """The point at the distance t from the foot of the perpendicular from the origin, shape (..., 3)."""
        return self.point + np.asarray(t, dtype=float)[..., None] * self.real


def line(point: ArrayLike, direction: ArrayLike) -> LineVector:
    """The line through a point: u + eps p x u with u = direction / |direction|.

    Parameters
    ----------
    point, direction : array_like, shape (..., 3)
        The direction need not be a unit vector.

    Returns
    -------
    LineVector

    Raises
    ------
    SingularError
        If a direction is zero.

    References
    ----------
    Pluecker (1865); Study (1903).

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.algebra.line([0, 1, 5], [2, 0, 0]).dual.tolist()
    [0.0, 5.0, -1.0]
    """
    p, d = (dual_array(f"line: {name}", x, 1)[0] for name, x in (("point", point), ("direction", direction)))
    for name, x in (("point", p), ("direction", d)):
        if x.shape[-1] != 3:
            raise ShapeError(f"line: {name} of shape (..., 3) expected, got {x.shape}")
    size = length(d, -1, keepdims=True)
    _need_direction("line: direction", size[..., 0])
    u = d / size
    return LineVector(*np.broadcast_arrays(u, np.cross(p, u)))


def as_motor(what: str, x: Any) -> Motor:
    """A motor from a `Motor`, a dual array (..., 3), or an array (..., 6)."""
    if isinstance(x, Motor):
        return x
    a, b = dual_array(what, x, 1)
    if a.shape[-1] == 6 and not isinstance(x, Dual):
        a, b = a[..., :3], a[..., 3:]
    if a.shape[-1] != 3:
        raise ShapeError(f"{what}: a motor expected, Dual (..., 3) or array (..., 6); got shape {a.shape}")
    return Motor(a, b)


def classify(motor: Any, tol: float = ROUNDING) -> np.ndarray:
    """The kind of each motor: "screw", "line", "couple" or "zero".

        screw   M != 0, M.M' != 0        couple  M = 0, M' != 0
        line    M != 0, M.M' = 0         zero    M = 0, M' = 0

    Parameters
    ----------
    motor : Motor, Dual (..., 3) or array_like (..., 6)
    tol : float
        M.M' counts as zero up to tol |M| |M'|: the rounding of the product.

    Returns
    -------
    ndarray of str, shape (...)

    Raises
    ------
    ShapeError
        If the last axis is not that of a motor.

    References
    ----------
    Pennestri & Stefanelli (2007), Table 1, where the couple's M' != 0 is missing.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.algebra.classify([[0, 0, 1, 0, 0, 2], [0, 0, 1, 1, 0, 0], [0, 0, 0, 1, 0, 0]]).tolist()
    ['screw', 'line', 'couple']
    """
    m = as_motor("classify", motor)
    size, moment = (length(x, -1) for x in (m.real, m.dual))
    unit, along = (x / np.where(r > 0, r, 1.0)[..., None] for x, r in ((m.real, size), (m.dual, moment)))
    flat = np.abs(_dot(unit, along)) <= tol
    with_axis = np.where(flat, "line", "screw")
    return np.where(size > 0, with_axis, np.where(moment > 0, "couple", "zero"))


def pitch(motor: Any) -> np.ndarray:
    """M.M' / M.M in metres per radian; infinite for a couple, nan for zero.  Per turn: times 2 pi.

    Parameters
    ----------
    motor : Motor, Dual (..., 3) or array_like (..., 6)

    Returns
    -------
    ndarray, shape (...,), in m/rad

    Raises
    ------
    ShapeError
        If the last axis is not that of a motor.

    References
    ----------
    Ball (1900), ch. I.

    Examples
    --------
    >>> import dualpin as dp
    >>> float(dp.algebra.pitch([0, 1, 1, 0, 0, 1]))
    0.5
    """
    return as_motor("pitch", motor).pitch


def reciprocal(a: Any, b: Any) -> np.ndarray:
    """Ball's reciprocal product A.B' + A'.B, the dual part of the dot product; zero when a, b are reciprocal.

    For a twist w + eps v and a wrench f + eps n it is the virtual power; for two unit lines -s sin(theta), zero if
    they meet or are parallel.

    Parameters
    ----------
    a, b : Motor, Dual (..., 3) or array_like (..., 6)
        Broadcast together.

    Returns
    -------
    ndarray, shape (...,)

    Raises
    ------
    ShapeError
        If the last axis is not that of a motor.

    References
    ----------
    Ball (1900), ch. II; Lynch & Park (2017), 3.4, of power.

    Examples
    --------
    >>> import dualpin as dp
    >>> z, x = dp.algebra.line([0, 0, 0], [0, 0, 1]), dp.algebra.line([0, 2, 0], [1, 0, 0])
    >>> float(dp.algebra.reciprocal(z, x))
    -2.0
    """
    return as_motor("reciprocal", a).dot(b).dual


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a * b).sum(axis=-1)


def _need_direction(what: str, size: np.ndarray) -> None:
    if np.any(size == 0):
        raise SingularError(f"{what}: a real part is needed, and it is zero{where(np.asarray(size == 0))}")
