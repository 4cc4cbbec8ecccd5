"""Three by three matrices and rotations.  Over dual numbers a rotation is a dual-orthogonal matrix."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from ..dual import Compound, cos_sin
from ..errors import ArgumentError, nearest
from ..scalars import ZERO, Scalar
from .vector import AXES, UX, UY, UZ, Vector3

M = TypeVar("M", bound="Matrix3")


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
            return Vector3(r.dot(b), s.dot(b), t.dot(b))
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
        return np.array([[float(x) for x in row] for row in self.rows])

    def skewed(self, p: Vector3) -> Matrix3:
        """A [p], row by row: r^T [p] = (r x p)^T."""
        return Matrix3(*(a.cross(p) for a in self.rows))


def diagonal(s: Scalar) -> Matrix3:
    """s times the identity."""
    return Matrix3(UX * s, UY * s, UZ * s)


class Rotation(Matrix3):
    """A matrix whose inverse is its transpose; over dual numbers (1 + eps [p]) R, a rigid motion."""

    __slots__ = ()

    @classmethod
    def about(cls, axis: Vector3, angle: Scalar) -> Rotation:
        """a a^T + cos t (1 - a a^T) + sin t [a]: what lies along the axis stays, the rest turns.

        A dual angle t + eps d about a unit line gives the screw displacement by t and d
        (Rodrigues 1840; by transference, Study 1903).
        """
        return cls.turned(axis, *cos_sin(angle))

    @classmethod
    def turned(cls, axis: Vector3, c: Scalar, s: Scalar) -> Rotation:
        """The rotation about a unit axis by the angle with cosine c and sine s."""
        along = axis.outer(axis)
        return cls(*(along + (IDENTITY - along) * c + skew(axis) * s).rows)


CONVENTIONS = ("standard", "modified")
IDENTITY = Rotation(*AXES)
ZEROS = diagonal(ZERO)


def skew(p: Vector3) -> Matrix3:
    """[p], with [p] b = p x b."""
    return IDENTITY.skewed(p)


def dh_rotation(theta: Scalar, alpha: Scalar, convention: str = "standard") -> Rotation:
    """Denavit-Hartenberg step as a dual rotation, with theta + eps d and alpha + eps a.

    standard (distal):  Rz(theta) Rx(alpha);    modified (proximal, Craig):  Rx(alpha) Rz(theta)
    """
    check_convention(convention)
    Z, X = Rotation.about(UZ, theta), Rotation.about(UX, alpha)
    return Z @ X if convention == "standard" else X @ Z


def check_convention(convention: str) -> None:
    if convention not in CONVENTIONS:
        raise ArgumentError(f"convention {convention!r} is not known; {nearest(str(convention), CONVENTIONS)}")
