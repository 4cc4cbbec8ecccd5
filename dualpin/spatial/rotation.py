"""Rotations, as matrices.  Over dual numbers they are dual-orthogonal matrices, the rigid motions."""

from __future__ import annotations

from ..dual import cos_sin
from ..errors import ArgumentError, nearest
from ..scalars import ZERO, Scalar
from .vector import AXES, UX, UY, UZ, Matrix3, Vector3


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
