"""Displacements: the dual rotation (1 + eps [p]) R, stored as its two real factors."""

from __future__ import annotations

from sys import float_info
from typing import Any

import numpy as np

from ..arguments import is_symbol
from ..dual import Dual
from ..renamed import renamed_names
from ..scalars import ONE, ZERO, Scalar, exact
from .quaternion import Quaternion, displaced
from .rotation import IDENTITY, Rotation, check_convention
from .vector import AXES, UX, UZ, ZERO_VECTOR, Vector3, motor

EPSILON = float_info.epsilon


class Pose:
    """Position p and orientation R of one frame in another.

    ``X @ thing`` transforms a motor, an inertia or another pose from the inner to the outer frame;
    ``X.pull(motor)`` transforms a motor from the outer to the inner frame.
    """

    __slots__ = ("position", "rotation", "shift")

    def __init__(self, rotation: Rotation = IDENTITY, position: Vector3 = ZERO_VECTOR) -> None:
        self.rotation, self.position = rotation, position
        self.shift = motor(ZERO_VECTOR, position)  # eps p

    def __repr__(self) -> str:
        return f"Pose({self.rotation!r}, {self.position!r})"

    @classmethod
    def about(cls, axis: Vector3, angle: Scalar) -> Pose:
        """Rotation by t about, and translation by d along, an axis through the origin: angle t + eps d."""
        return cls(Rotation.about(axis, angle.real), axis * angle.dual)

    @classmethod
    def dh(cls, theta: Dual, alpha: Dual, convention: str = "standard") -> Pose:
        """Denavit-Hartenberg step Z(theta + eps d) X(alpha + eps a), or X Z if modified."""
        check_convention(convention)
        Z, X = cls.about(UZ, theta), cls.about(UX, alpha)
        return Z @ X if convention == "standard" else X @ Z

    @classmethod
    def from_quaternion(cls, q: Quaternion) -> Pose:
        """Of the unit dual quaternion r + eps t r / 2."""
        return cls(q.real.rotation, (q.dual * q.real.conjugate * 2).v)

    @property
    def quaternion(self) -> Quaternion:
        """The unit dual quaternion r + eps t r / 2, with w >= 0."""
        return displaced(Quaternion.from_rotation(self.rotation), self.position)

    def __matmul__(self, thing: Any) -> Any:
        return thing.moved(self)

    def translate(self, m: Vector3) -> Vector3:
        return m + self.shift.cross(m)

    def untranslate(self, m: Vector3) -> Vector3:
        return m - self.shift.cross(m)

    def pull(self, m: Vector3) -> Vector3:
        """The motor m of the outer frame, expressed in the inner one."""
        return self.rotation.T @ self.untranslate(m)

    def moved(self, X: Pose) -> Pose:
        return Pose(X.rotation @ self.rotation, X.position + X.rotation @ self.position)

    @property
    def inverse(self) -> Pose:
        R = self.rotation.T
        return Pose(R, -(R @ self.position))

    @property
    def dual_matrix(self) -> Rotation:
        """(1 + eps [p]) R multiplied out."""
        columns = (self @ motor(a, ZERO_VECTOR) for a in AXES)
        return Rotation(*columns).T

    @property
    def rows(self) -> list[list[Scalar]]:
        """The homogeneous 4x4 matrix [R p; 0 1], row by row."""
        top = [[*r, p] for r, p in zip(self.rotation.rows, self.position, strict=True)]
        return [*top, [ZERO, ZERO, ZERO, ONE]]

    @property
    def array(self) -> np.ndarray:
        """The homogeneous matrix in floats, (4, 4)."""
        return np.array([[float(x) for x in row] for row in self.rows])

    @classmethod
    def from_matrix(cls, T: Any) -> Pose:
        """Of a numeric homogeneous matrix; entries within rounding of -1, 0, 1 become exact constants.

        The tolerance is 4 eps, of 1 in the rotation and of the longest component in the position: the
        rounding of a product of a few matrices.
        """
        T = np.asarray(T, dtype=float)
        scale = float(np.abs(T[:3, 3]).max())
        rotation = [Vector3(*(_snapped(x, 1.0, (-1, 0, 1)) for x in row[:3])) for row in T[:3].tolist()]
        return cls(Rotation(*rotation), Vector3(*(_snapped(x, scale, (0,)) for x in T[:3, 3].tolist())))

    @property
    def snapped(self) -> Pose:
        """The same with numbers within rounding of -1, 0, 1 made exact, to save operations; symbols do not change."""
        entries = [x for row in self.rows for x in row]
        if not any(map(is_symbol, entries)):
            return Pose.from_matrix(self.array)
        scale = max((abs(float(x)) for x in self.position if not is_symbol(x)), default=0.0)
        rotation = (Vector3(*(_kept(x, 1.0, (-1, 0, 1)) for x in row)) for row in self.rotation.rows)
        return Pose(Rotation(*rotation), Vector3(*(_kept(x, scale, (0,)) for x in self.position)))

    @classmethod
    def from_rows(cls, rows: Any) -> Pose:
        """Of a homogeneous 4x4 matrix given as nested sequences of scalars."""
        (a, b, c, x), (d, e, f, y), (g, h, i, z) = rows[:3]
        return cls(Rotation(Vector3(a, b, c), Vector3(d, e, f), Vector3(g, h, i)), Vector3(x, y, z))


IDENTITY_POSE = Pose()


def _kept(x: Scalar, scale: float, values: tuple[int, ...]) -> Scalar:
    """A float snapped; a formula, or an exact number of SymPy such as sqrt(3)/2, unchanged unless it is -1, 0 or 1."""
    if is_symbol(x) and not getattr(x, "is_Float", False):
        return next((exact(n) for n in values if x == n), x)
    return _snapped(float(x), scale, values)


def _snapped(x: float, scale: float, values: tuple[int, ...]) -> Scalar:
    for n in values:
        if abs(x - n) <= 4 * EPSILON * scale:
            return exact(n)
    return exact(x)


__getattr__ = renamed_names(__name__, GROUND="IDENTITY_POSE")
