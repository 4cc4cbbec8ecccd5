"""Rotations, as matrices.  Over dual numbers they are dual-orthogonal matrices, the rigid motions."""

from __future__ import annotations

from ..dual import cos_sin
from ..errors import ArgumentError, nearest
from ..scalars import ZERO, Scalar
from .vector import AXES, UX, UY, UZ, Matrix3, Vector3


def diagonal(s: Scalar) -> Matrix3:
    """s times the identity.

    Parameters
    ----------
    s : scalar

    Returns
    -------
    Matrix3

    Examples
    --------
    >>> from dualpin.spatial import diagonal
    >>> diagonal(2.0).array.tolist()
    [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]
    """
    return Matrix3(UX * s, UY * s, UZ * s)


class Rotation(Matrix3):
    """A matrix whose inverse is its transpose; over dual numbers (1 + eps [p]) R, a rigid motion."""

    __slots__ = ()

    @classmethod
    def about(cls, axis: Vector3, angle: Scalar) -> Rotation:
        """a a^T + cos t (1 - a a^T) + sin t [a].

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
    """[p], with [p] b = p x b.

    Parameters
    ----------
    p : Vector3

    Returns
    -------
    Matrix3

    References
    ----------
    Lynch & Park (2017), 3.2.2.

    Examples
    --------
    >>> from dualpin.spatial import Vector3, skew
    >>> skew(Vector3(1.0, 2.0, 3.0)) @ Vector3(0.0, 0.0, 1.0)
    Vector3(2.0, -1.0, 0.0)
    """
    return IDENTITY.skewed(p)


def dh_rotation(theta: Scalar, alpha: Scalar, convention: str = "standard") -> Rotation:
    """Denavit-Hartenberg step as a dual rotation, with theta + eps d and alpha + eps a.

    standard (distal):  Rz(theta) Rx(alpha);    modified (proximal, Craig):  Rx(alpha) Rz(theta)

    Parameters
    ----------
    theta, alpha : scalar
        Dual angles theta + eps d and alpha + eps a.
    convention : "standard" or "modified"

    Returns
    -------
    Rotation

    Raises
    ------
    ArgumentError
        For another convention.

    References
    ----------
    Denavit & Hartenberg (1955); Craig (2005), 3.4.

    Examples
    --------
    >>> from dualpin import Dual
    >>> from dualpin.spatial import dh_rotation
    >>> dh_rotation(Dual(0.0, 0.3), Dual(0.0, 0.0)).rows[0].y
    Dual(-0.0, -0.3)
    """
    check_convention(convention)
    Z, X = Rotation.about(UZ, theta), Rotation.about(UX, alpha)
    return Z @ X if convention == "standard" else X @ Z


def check_convention(convention: str) -> None:
    if convention not in CONVENTIONS:
        raise ArgumentError(f"convention {convention!r} is not known; {nearest(str(convention), CONVENTIONS)}")
