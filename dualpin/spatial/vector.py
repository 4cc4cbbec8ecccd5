"""Vectors of three scalars, and 3x3 matrices.  Over dual numbers a vector is a motor.

    Vector3      over Dual: a twist w + eps v, a wrench f + eps n, a momentum p + eps l, a screw
    a.cross(b)   over Dual: the spatial cross product, of motions and of forces alike
    a.dot(b)     over Dual: a.b + eps (power); the dual part pairs twists with wrenches

Mind the order: the *real* part of a twist is angular, the real part of a wrench is the force.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol, TypeAlias, TypeVar

import numpy as np

from ..dual import Compound, Dual
from ..renamed import renamed_names
from ..scalars import ONE, ZERO, Scalar

M = TypeVar("M", bound="Matrix3")


class Carrier(Protocol):
    """An object that transforms motors from one frame to another: a `Pose`."""

    rotation: Matrix3

    def translate(self, m: Vector3) -> Vector3: ...


class Vector3(Compound):
    """A vector of three scalars of any kind.

    Examples
    --------
    >>> from dualpin.spatial import Vector3
    >>> Vector3(1.0, 0.0, 0.0).cross(Vector3(0.0, 2.0, 0.0))
    Vector3(0.0, 0.0, 2.0)
    """

    __slots__ = ("x", "y", "z")

    def __init__(self, x: Scalar, y: Scalar, z: Scalar) -> None:
        self.x, self.y, self.z = x, y, z

    def __iter__(self) -> Iterator[Scalar]:
        return iter((self.x, self.y, self.z))

    def __repr__(self) -> str:
        return f"Vector3({self.x}, {self.y}, {self.z})"

    def __neg__(self) -> Vector3:
        return Vector3(-self.x, -self.y, -self.z)

    def __add__(self, b: Vector3) -> Vector3:
        return Vector3(self.x + b.x, self.y + b.y, self.z + b.z)

    def __sub__(self, b: Vector3) -> Vector3:
        return Vector3(self.x - b.x, self.y - b.y, self.z - b.z)

    def __mul__(self, s: Scalar) -> Vector3:
        return Vector3(self.x * s, self.y * s, self.z * s)

    __rmul__ = __mul__

    def __truediv__(self, s: Scalar) -> Vector3:
        return Vector3(self.x / s, self.y / s, self.z / s)

    def dot(self, b: Vector3) -> Scalar:
        return self.x * b.x + self.y * b.y + self.z * b.z

    def cross(self, b: Vector3) -> Vector3:
        return Vector3(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)

    def outer(self, b: Vector3) -> Matrix3:
        """a b^T"""
        return Matrix3(b * self.x, b * self.y, b * self.z)

    @property
    def array(self) -> np.ndarray:
        """In floats, (3,)."""
        return np.array([float(x) for x in self])

    @property
    def real(self) -> Vector3:
        return Vector3(self.x.real, self.y.real, self.z.real)

    @property
    def dual(self) -> Vector3:
        return Vector3(self.x.dual, self.y.dual, self.z.dual)

    def moved(self, X: Carrier) -> Vector3:
        """A motor transformed from the frame X to the frame in which X is given."""
        moved: Vector3 = X.translate(X.rotation @ self)
        return moved


class Matrix3(Compound):
    """A 3x3 matrix of scalars, as three rows."""

    __slots__ = ("rows",)

    def __init__(self, *rows: Vector3) -> None:
        self.rows = rows

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, self.rows))})"

    def __add__(self, B: Matrix3) -> Matrix3:
        return Matrix3(*(a + b for a, b in zip(self.rows, B.rows, strict=True)))

    def __sub__(self, B: Matrix3) -> Matrix3:
        return Matrix3(*(a - b for a, b in zip(self.rows, B.rows, strict=True)))

    def __mul__(self, s: Scalar) -> Matrix3:
        return Matrix3(*(a * s for a in self.rows))

    __rmul__ = __mul__

    def __truediv__(self, s: Scalar) -> Matrix3:
        return Matrix3(*(a / s for a in self.rows))

    def __matmul__(self, b: Any) -> Any:
        if type(b) is Vector3:
            r, s, t = self.rows
            return Vector3(b.dot(r), b.dot(s), b.dot(t))  # dual numbers are left of real ones, which do not know them
        columns = b.T.rows
        return type(b)(*(Vector3(*(a.dot(column) for column in columns)) for a in self.rows))

    @property
    def T(self: M) -> M:
        """The transpose; of a rotation, the inverse."""
        r, s, t = self.rows
        return type(self)(Vector3(r.x, s.x, t.x), Vector3(r.y, s.y, t.y), Vector3(r.z, s.z, t.z))

    @property
    def mirrored(self) -> Matrix3:
        """The symmetric matrix with this upper triangle, for products known to be symmetric."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.rows
        return Matrix3(Vector3(xx, xy, xz), Vector3(xy, yy, yz), Vector3(xz, yz, zz))

    @property
    def array(self) -> np.ndarray:
        """In floats, (3, 3)."""
        return np.array([row.array for row in self.rows])

    def skewed(self, p: Vector3) -> Matrix3:
        """A [p], row by row: r^T [p] = (r x p)^T."""
        return Matrix3(*(a.cross(p) for a in self.rows))


Twist: TypeAlias = Vector3
"""A motion w + eps v: angular velocity, and velocity of the point at the origin [rad/s, m/s]; also a unit screw, and
their rates of change."""
Wrench: TypeAlias = Vector3
"""A force f + eps n: force, and moment about the origin [N, N m]."""
Momentum: TypeAlias = Vector3
"""A momentum p + eps l: linear, and angular about the origin [kg m/s, kg m^2/s]."""

ZERO_VECTOR = Vector3(ZERO, ZERO, ZERO)
AXES = UX, UY, UZ = Vector3(ONE, ZERO, ZERO), Vector3(ZERO, ONE, ZERO), Vector3(ZERO, ZERO, ONE)


def motor(real: Vector3, dual: Vector3) -> Vector3:
    """The dual vector real + eps dual.

    Parameters
    ----------
    real, dual : Vector3

    Returns
    -------
    Vector3
        Over dual numbers.

    References
    ----------
    Clifford (1873); Study (1903).

    Examples
    --------
    >>> from dualpin.spatial import Vector3, motor
    >>> motor(Vector3(0.0, 0.0, 1.0), Vector3(0.0, -2.0, 0.0)).y
    Dual(0.0, -2.0)
    """
    return Vector3(Dual(real.x, dual.x), Dual(real.y, dual.y), Dual(real.z, dual.z))


ZERO_MOTOR = motor(ZERO_VECTOR, ZERO_VECTOR)


def power(screw: Twist, wrench: Wrench) -> Scalar:
    """Virtual power w.n + v.f of a wrench f + eps n on a twist w + eps v.

    The dual part of the dot product; Ball's reciprocal product (Ball 1900).  It replaces products with the
    transposed motion subspace, for all types of joints.

    Parameters
    ----------
    screw : Twist
        w + eps v.
    wrench : Wrench
        f + eps n.

    Returns
    -------
    scalar
        [W]

    References
    ----------
    Ball (1900), ch. II.

    Examples
    --------
    >>> from dualpin.spatial import Vector3, motor, power
    >>> twist = motor(Vector3(0.0, 0.0, 2.0), Vector3(1.0, 0.0, 0.0))
    >>> power(twist, motor(Vector3(3.0, 0.0, 0.0), Vector3(0.0, 0.0, 0.5)))
    4.0
    """
    s, f = screw, wrench
    return _dual_part(s.x, f.x) + _dual_part(s.y, f.y) + _dual_part(s.z, f.z)


def _dual_part(x: Scalar, y: Scalar) -> Scalar:
    """The dual part of the product x y, a b' + a' b, without its real part, which takes a third of the operations."""
    if type(x) is not Dual or type(y) is not Dual:
        return (x * y).dual
    a, da, b, db = x.real, x.dual, y.real, y.dual
    try:
        if a is ZERO or db is ZERO:  # what is not there is not added
            return da * b
        return a * db if b is ZERO or da is ZERO else a * db + da * b
    except ValueError:
        return (x * y).dual  # raises the error that names the shapes


__getattr__ = renamed_names(__name__, NOUGHT="ZERO_VECTOR", REST="ZERO_MOTOR")
