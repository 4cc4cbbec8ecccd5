"""Maps from motions to forces, which are not dual-linear.

An inertia maps the twist w + eps v to the momentum p + eps l.  It maps the dual part v mostly to the real part p,
and w to l, so it does not commute with eps (Brodsky & Shoham 1999).  But it is symmetric with respect to the
power, power(U, I(V)) = power(V, I(U)), which is all that the algorithms need.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..renamed import renamed_names
from ..scalars import ONE, ZERO, Scalar, exact
from .pose import Pose
from .rotation import ZEROS, diagonal, skew
from .vector import AXES, ZERO_VECTOR, Matrix3, Momentum, Twist, Vector3, Wrench, motor


def steiner(m: float, c: np.ndarray) -> np.ndarray:
    """m (c.c 1 - c c^T): what the parallel axis theorem adds, in floats (3, 3)."""
    return np.asarray(m * (c @ c * np.eye(3) - np.outer(c, c)))


class Inertia:
    """A rigid body: mass m, first moment h = m c, and rotational inertia J about the origin.

    Linear in its ten parameters (m; hx hy hz; Jxx Jxy Jyy Jxz Jyz Jzz), so bodies simply add.
    """

    __slots__ = ("mass", "moment", "rotational")

    def __init__(self, mass: Scalar, moment: Vector3, rotational: Matrix3) -> None:
        self.mass, self.moment, self.rotational = mass, moment, rotational

    @classmethod
    def of(cls, mass: Scalar, com: Iterable[Scalar], about_com: Iterable[Iterable[Scalar]]) -> Inertia:
        """From mass, centre of mass, and rotational inertia about the centre of mass, in the axes of the frame."""
        J = Matrix3(*(Vector3(*map(exact, row)) for row in about_com))
        return Pose(position=Vector3(*map(exact, com))) @ cls(exact(mass), ZERO_VECTOR, J)

    @property
    def massless(self) -> bool:
        """Whether its mass is the number zero."""
        return exact(self.mass) is ZERO

    @property
    def central(self) -> tuple[Vector3, Matrix3]:
        """Centre of mass, and the rotational inertia about it; of a body without mass, about the origin."""
        c = ZERO_VECTOR if self.massless else self.moment / self.mass
        return c, (Pose(position=-c) @ self).rotational

    def __call__(self, twist: Twist) -> Momentum:
        """Momentum of the twist w + eps v:   p = m v + w x h,   l = J w + h x v"""
        w, v, h = twist.real, twist.dual, self.moment
        return motor(v * self.mass + w.cross(h), self.rotational @ w + h.cross(v))

    def __add__(self, b: Inertia) -> Inertia:
        return Inertia(self.mass + b.mass, self.moment + b.moment, self.rotational + b.rotational)

    def moved(self, X: Pose) -> Inertia:
        """Turn by R, then shift by p (Steiner):  h' = h + m p,  J' = J + (p.h + p.h') 1 - h p^T - p h'^T"""
        R, p, m = X.rotation, X.position, self.mass
        h, J = R @ self.moment, R @ self.rotational @ R.T
        h_ = h + p * m
        J_ = J + diagonal(p.dot(h) + p.dot(h_)) - h.outer(p) - p.outer(h_)
        return Inertia(m, h_, J_.mirrored)

    @property
    def parameters(self) -> list[Scalar]:
        """m; hx hy hz; Jxx Jxy Jyy Jxz Jyz Jzz about the origin, the parameters of the regressor."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.rotational.rows
        return [self.mass, *self.moment, xx, xy, yy, xz, yz, zz]

    @property
    def array(self) -> np.ndarray:
        """The parameters in floats, (10,)."""
        return np.array([float(x) for x in self.parameters])

    @classmethod
    def from_array(cls, parameters: Iterable[float]) -> Inertia:
        """The body of ten parameters; a difference of bodies is one too."""
        m, x, y, z, xx, xy, yy, xz, yz, zz = map(float, parameters)
        J = Matrix3(Vector3(xx, xy, xz), Vector3(xy, yy, yz), Vector3(xz, yz, zz))
        return cls(m, Vector3(x, y, z), J)

    @classmethod
    def basis(cls) -> list[Inertia]:
        """The ten unit inertias, in the order of `parameters`:  I = sum parameter * basis."""
        units = [cls(ONE, ZERO_VECTOR, ZEROS)] + [cls(ZERO, axis, ZEROS) for axis in AXES]
        for c in range(3):
            for r in range(c + 1):
                unit = AXES[r].outer(AXES[c])
                units.append(cls(ZERO, ZERO_VECTOR, unit if r == c else unit + unit.T))
        return units


ZERO_INERTIA = Inertia(ZERO, ZERO_VECTOR, ZEROS)


class Articulated:
    """Any symmetric map of twists to wrenches, in blocks:  f = M v + H w,   n = H^T v + J w."""

    __slots__ = ("H", "J", "M")

    def __init__(self, M: Matrix3, H: Matrix3, J: Matrix3) -> None:
        self.M, self.H, self.J = M, H, J

    @classmethod
    def of(cls, body: Inertia) -> Articulated:
        return cls(diagonal(body.mass), skew(-body.moment), body.rotational)

    def __call__(self, twist: Twist) -> Momentum:
        w, v = twist.real, twist.dual
        return motor(self.M @ v + self.H @ w, self.H.T @ v + self.J @ w)

    def __add__(self, b: Articulated) -> Articulated:
        return Articulated(self.M + b.M, self.H + b.H, self.J + b.J)

    def released(self, U: Wrench, d: Scalar) -> Articulated:
        """I - U U^T / d: the articulated inertia when the screw with U = I(s), d = power(s, U) moves freely."""
        f, n = U.real, U.dual
        kf, kn = f * (1 / d), n * (1 / d)
        return Articulated((self.M - kf.outer(f)).mirrored, self.H - kf.outer(n), (self.J - kn.outer(n)).mirrored)

    def moved(self, X: Pose) -> Articulated:
        """Turn each block, then shift:  H' = H - M [p],  J' = J + [p] H' - H^T [p]"""
        R, p = X.rotation, X.position
        M, H, J = (R @ block @ R.T for block in (self.M, self.H, self.J))
        M = M.mirrored
        H_ = H - M.skewed(p)
        return Articulated(M, H_, (J - H_.T.skewed(p).T - H.T.skewed(p)).mirrored)


class Connection:
    """B(V): the bilinear map  D(V, U) = [V x I(U) + U x I(V) - I(V x U)] / 2  for a given V.

    This is the Levi-Civita connection of the kinetic energy on SE(3) (Arnold 1966; as a matrix,
    Echeandia & Wensing 2021).  By Jacobi's identity it depends only on the angular part of U: with p
    the linear momentum, B(V)(a + eps b) = a x p + eps (B a), twelve numbers in all.
    """

    __slots__ = ("B", "p")

    def __init__(self, p: Vector3, B: Matrix3) -> None:
        self.p, self.B = p, B

    @classmethod
    def of(cls, I: Inertia, V: Twist) -> Connection:
        """B a = w x K a + h x (a x v)  with  K = J - tr(J) / 2

        Of the rotational part w x Ja + a x Jw - J(w x a), since  J(w x a) + Jw x a + w x Ja = tr(J) w x a  for a
        symmetric J; of the rest, by Jacobi's identity, v x (a x h) + a x (h x v) - h x (v x a) = 2 h x (a x v).
        """
        w, v, h, J = V.real, V.dual, I.moment, I.rotational
        half = (J.rows[0].x + J.rows[1].y + J.rows[2].z) / 2
        turning = Matrix3(*map(w.cross, (J - diagonal(half)).rows)).T  # K is symmetric: its rows are its columns
        return cls(I(V).real, turning + diagonal(h.dot(v)) - v.outer(h))

    def __call__(self, U: Twist) -> Wrench:
        return motor(U.real.cross(self.p), self.B @ U.real)

    def transposed(self, U: Twist) -> Wrench:
        """power(W, B(U)) = power(U, B^T(W))"""
        return motor(ZERO_VECTOR, self.B.T @ U.real + self.p.cross(U.dual))

    def __add__(self, b: Connection) -> Connection:
        return Connection(self.p + b.p, self.B + b.B)

    def moved(self, X: Pose) -> Connection:
        """Turn, then shift:  B' a = R B R^T a + r x (a x p)"""
        R, r = X.rotation, X.position
        p, B = R @ self.p, R @ self.B @ R.T
        return Connection(p, B + diagonal(r.dot(p)) - p.outer(r))


ZERO_CONNECTION = Connection(ZERO_VECTOR, ZEROS)

__getattr__ = renamed_names(__name__, NOTHING="ZERO_INERTIA")
