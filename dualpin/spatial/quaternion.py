"""Hamilton's quaternions, scalar first.  Over dual numbers: dual quaternions, the rigid motions."""

from __future__ import annotations

from collections.abc import Iterator

from ..dual import Compound, Dual, atan2, cos_sin, real_part, sqrt, stumpff, where
from ..scalars import ONE, ZERO, Scalar
from .rotation import Rotation
from .vector import Matrix3, Vector3


class Quaternion(Compound):
    """w + x i + y j + z k.

    Examples
    --------
    >>> from dualpin.spatial import Quaternion
    >>> i, j = Quaternion(0.0, 1.0, 0.0, 0.0), Quaternion(0.0, 0.0, 1.0, 0.0)
    >>> i * j
    Quaternion(0.0, 0.0, 0.0, 1.0)
    """

    __slots__ = ("v", "w")

    def __init__(self, w: Scalar, x: Scalar, y: Scalar, z: Scalar) -> None:
        self.w, self.v = w, Vector3(x, y, z)

    def __iter__(self) -> Iterator[Scalar]:
        return iter((self.w, *self.v))

    def __repr__(self) -> str:
        return f"Quaternion({self.w}, {self.v.x}, {self.v.y}, {self.v.z})"

    def __neg__(self) -> Quaternion:
        return Quaternion(-self.w, *-self.v)

    def __add__(self, q: Quaternion) -> Quaternion:
        return Quaternion(self.w + q.w, *(self.v + q.v))

    def __sub__(self, q: Quaternion) -> Quaternion:
        return Quaternion(self.w - q.w, *(self.v - q.v))

    def __mul__(self, q: Quaternion | Scalar) -> Quaternion:
        """Hamilton's product; p * q is the motion q followed by p."""
        if type(q) is not Quaternion:
            return Quaternion(self.w * q, *(self.v * q))
        p = self
        return Quaternion(p.w * q.w - p.v.dot(q.v), *(q.v * p.w + p.v * q.w + p.v.cross(q.v)))

    def __rmul__(self, s: Scalar) -> Quaternion:
        return Quaternion(self.w * s, *(self.v * s))

    def dot(self, q: Quaternion) -> Scalar:
        return self.w * q.w + self.v.dot(q.v)

    @property
    def real(self) -> Quaternion:
        return Quaternion(self.w.real, *self.v.real)

    @property
    def dual(self) -> Quaternion:
        return Quaternion(self.w.dual, *self.v.dual)

    @property
    def conjugate(self) -> Quaternion:
        """w - v; of a unit (dual) quaternion, the inverse."""
        return Quaternion(self.w, *-self.v)

    @property
    def dual_conjugate(self) -> Quaternion:
        """q - eps q': the other conjugate of a dual quaternion."""
        return Quaternion(*(Dual(c.real, -c.dual) for c in self))

    @property
    def inverse(self) -> Quaternion:
        """conjugate / |q|^2, which over dual numbers is q^-1 - eps q^-1 q' q^-1."""
        return self.conjugate * (1 / self.dot(self))

    @property
    def normalized(self) -> Quaternion:
        """q / |q|; over dual numbers also q . q' = 0 is restored."""
        return self * (1 / sqrt(self.dot(self)))

    @property
    def rotation(self) -> Rotation:
        """The rotation b -> q b q* of a unit quaternion: 1 + 2 w [v] + 2 [v]^2."""
        (x, y, z), (X, Y, Z) = self.v, self.v + self.v
        xx, yy, zz, xy, yz, zx = x * X, y * Y, z * Z, x * Y, y * Z, z * X
        wx, wy, wz = self.w * X, self.w * Y, self.w * Z
        return Rotation(
            Vector3(ONE - (yy + zz), xy - wz, zx + wy),
            Vector3(xy + wz, ONE - (xx + zz), yz - wx),
            Vector3(zx - wy, yz + wx, ONE - (xx + yy)),
        )

    @classmethod
    def from_rotation(cls, R: Matrix3) -> Quaternion:
        """Euler parameters of a rotation, w >= 0.

        Shepperd (1978); over dual numbers, Pennestri & Stefanelli (2007), Table 4.

        4 q q^T is linear in R; of its four rows the one with the largest diagonal entry is used,
        so nothing is lost for angles near 0 or near pi.
        """
        (a, b, c), (d, e, f), (g, h, i) = R.rows
        x, y, z = h - f, c - g, d - b  # 4 w (x, y, z)
        xy, xz, yz = d + b, g + c, h + f
        best = (1 + a + e + i, x, y, z)
        largest = best[0]
        for square, row in (
            (1 + a - e - i, (x, 1 + a - e - i, xy, xz)),
            (1 - a + e - i, (y, xy, 1 - a + e - i, yz)),
            (1 - a - e + i, (z, xz, yz, 1 - a - e + i)),
        ):
            better = real_part(square) > real_part(largest)
            largest = where(better, square, largest)
            best = tuple(where(better, new, old) for new, old in zip(row, best, strict=True))
        q = cls(*best)
        return (q * (1 / (2 * sqrt(largest)))).positive

    @property
    def positive(self) -> Quaternion:
        """The one of q and -q, which are the same rotation, with w >= 0."""
        flip = real_part(self.w) < 0
        return type(self)(*(where(flip, -c, c) for c in self))

    @classmethod
    def about(cls, axis: Vector3, angle: Scalar) -> Quaternion:
        """cos(t/2) + axis sin(t/2); for a dual angle about a unit line, the screw displacement."""
        c, s = cos_sin(angle / 2)
        return cls(c, *(axis * s))

    @classmethod
    def exp(cls, v: Vector3) -> Quaternion:
        """cos r + v sin r / r with r = |v|; over dual numbers, the displacement by the motor 2 v."""
        y = v.dot(v)
        return cls(stumpff(0, y), *(v * stumpff(1, y)))

    @property
    def log(self) -> Vector3:
        """The v of least length with exp(v) = +-q, for a unit q.

            v = u f,   f = phi / sin phi,   phi = atan2(|u|, w)

        with q = w + u.  Over dual numbers f' = -2 c_3(4 phi^2) f^3 (u.u)' - w', c_3 of Stumpff,
        exact for every angle.
        """
        q = self.positive
        u = Vector3(*map(real_part, q.v))
        s = sqrt(u.dot(u))
        phi = atan2(s, real_part(q.w))
        f = 1 / stumpff(1, phi * phi)
        if type(q.w) is not Dual:
            return u * f
        slope = -2 * stumpff(3, 4 * phi * phi) * f * f * f
        return q.v * Dual(f, slope * (2 * u.dot(q.v.dual)) - q.w.dual)


def displaced(r: Quaternion, t: Vector3) -> Quaternion:
    """The unit dual quaternion r + eps t r / 2 of the rotation r followed by the translation t.

    Parameters
    ----------
    r : Quaternion
        A unit quaternion: the rotation.
    t : Vector3
        The translation [m].

    Returns
    -------
    Quaternion
        Over dual numbers.

    References
    ----------
    Study (1903).

    Examples
    --------
    >>> from dualpin.spatial import Quaternion, Vector3, displaced
    >>> displaced(Quaternion(1.0, 0.0, 0.0, 0.0), Vector3(2.0, 0.0, 0.0)).dual
    Quaternion(-0.0, 1.0, 0.0, 0.0)
    """
    moved = Quaternion(ZERO, *t) * r
    return Quaternion(*(Dual(a, b / 2) for a, b in zip(r, moved, strict=True)))
