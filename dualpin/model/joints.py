"""Joint models: axial, planar, floating and spherical.

A joint about an axis is an axis times dual numbers: a coordinate x with unit u contributes u x
to the dual angle t + eps d and the screw u axis to the motion subspace.

    revolute 1     prismatic eps     helical 1 + eps h     cylindrical 1, eps
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

from ..dual import EPS, Dual, cos_sin, stumpff
from ..errors import ArgumentError
from ..scalars import ONE, ZERO, Exact, Scalar
from ..spatial.pose import Pose
from ..spatial.quaternion import Quaternion, displaced
from ..spatial.rotation import Rotation
from ..spatial.vector import AXES, UX, UY, UZ, ZERO_VECTOR, Vector3, motor
from .joint import JointModel, Written

__all__ = [
    "Axial", "Floating", "JointModel", "Planar", "Spherical", "Written", "cylindrical", "helical", "prismatic",
    "revolute", "spherical",
]  # fmt: skip


class Axial(JointModel):
    """A joint about one axis: q contributes sum(unit * q) + offset to its dual angle."""

    def __init__(
        self, axis: Vector3, *units: Dual, kind: str, coordinates: tuple[str, ...], offset: Dual | None = None
    ) -> None:
        _check_unit(axis, kind)
        self.axis, self.units, self.kind, self.coordinates = axis, units, kind, coordinates
        self.offset = Dual(ZERO, ZERO) if offset is None else offset
        self.screws = tuple(motor(axis, ZERO_VECTOR) * u for u in units)
        self.velocity_names = ("",) if len(units) == 1 else ("angle", "slide")
        self._leader: Axial | None = None
        self.nq = len(units)
        self.neutral = (0.0,) * self.nq

    def motion(self, q: Sequence[Scalar]) -> Pose:
        return Pose.about(self.axis, self.angle(q))

    def quaternion(self, q: Sequence[Scalar]) -> Quaternion:
        return Quaternion.about(motor(self.axis, ZERO_VECTOR), self.angle(q))

    def angle(self, q: Sequence[Scalar]) -> Dual:
        """The dual angle t + eps d of the coordinates."""
        angle = self.offset
        for u, x in zip(self.units, q, strict=True):
            angle = angle + u * x
        return angle

    def written(self) -> tuple[Written, ...]:
        found = []
        for i, u in enumerate(self.units):
            turn, slide = float(u.real), float(u.dual)
            if turn and slide:
                raise ArgumentError(
                    f"is {self.kind}, and URDF has no such joint; write it as a revolute or prismatic one, or split "
                    "it into both and couple them outside the file"
                )
            if abs(abs(turn + slide) - 1) > 1e-12:
                raise ArgumentError(f"has a coordinate scaled by {abs(turn + slide):g}; URDF joints are in rad and m")
            axis = self.axis if turn + slide > 0 else -self.axis
            found.append(Written("prismatic" if slide else "revolute", axis, i, "_slide" if i else ""))
        return tuple(found)

    @property
    def free(self) -> JointModel:
        return self._leader or self

    def following(self, multiplier: Scalar, offset: Scalar) -> JointModel:
        if self.nq != 1:
            return super().following(multiplier, offset)
        (unit,) = self.units
        other = Axial(self.axis, unit * multiplier, kind=self.kind, coordinates=self.coordinates, offset=unit * offset)
        other._leader, other.coupling = self, (multiplier, offset)
        return other


def _check_unit(axis: Vector3, kind: str) -> None:
    """Numeric axes must have length 1 (to 1e-9, more than rounding leaves); symbols are not checked."""
    if all(isinstance(c, (int, float, Exact)) for c in axis):
        length = hypot(*map(float, axis))
        if not abs(length - 1) <= 1e-9:
            raise ArgumentError(f"{kind} joint: a unit axis expected, got {axis} of length {length:.9g}")


def revolute(axis: Vector3 = UZ, kind: str = "revolute") -> Axial:
    """Turns about an axis; q is the angle in rad.

    Parameters
    ----------
    axis : Vector3
        A unit vector in the moving frame.
    kind : "revolute" or "continuous"
        The type in URDF; a continuous joint also has one angle.

    Returns
    -------
    Axial

    Raises
    ------
    ArgumentError
        If the axis is not of unit length.

    References
    ----------
    Lynch & Park (2017), 2.2.1.

    Examples
    --------
    >>> from dualpin.model import revolute
    >>> revolute().coordinates
    ('angle',)
    """
    return Axial(axis, Dual(ONE, ZERO), kind=kind, coordinates=("angle",))


def prismatic(axis: Vector3 = UZ) -> Axial:
    """Slides along an axis; q is the length in m.

    Parameters
    ----------
    axis : Vector3
        A unit vector in the moving frame.

    Returns
    -------
    Axial

    Raises
    ------
    ArgumentError
        If the axis is not of unit length.

    References
    ----------
    Lynch & Park (2017), 2.2.1.

    Examples
    --------
    >>> from dualpin.model import prismatic
    >>> prismatic().coordinates
    ('length',)
    """
    return Axial(axis, EPS, kind="prismatic", coordinates=("length",))


def helical(axis: Vector3 = UZ, pitch: Scalar = 0.0) -> Axial:
    """A screw joint; `pitch` in metres per radian.

    Parameters
    ----------
    axis : Vector3
        A unit vector in the moving frame.
    pitch : scalar
        [m/rad]

    Returns
    -------
    Axial

    Raises
    ------
    ArgumentError
        If the axis is not of unit length.

    References
    ----------
    Ball (1900), ch. I: the unit 1 + eps h.

    Examples
    --------
    >>> from dualpin.model import helical
    >>> helical(pitch=0.1).screws[0].z
    Dual(1, 0.1)
    """
    return Axial(axis, Dual(ONE, pitch), kind="helical", coordinates=("angle",))


def cylindrical(axis: Vector3 = UZ) -> Axial:
    """q = (angle, slide).

    Parameters
    ----------
    axis : Vector3
        A unit vector in the moving frame.

    Returns
    -------
    Axial

    Raises
    ------
    ArgumentError
        If the axis is not of unit length.

    References
    ----------
    Study (1903): a dual angle about the axis.

    Examples
    --------
    >>> from dualpin.model import cylindrical
    >>> cylindrical().nq, cylindrical().velocity_names
    (2, ('angle', 'slide'))
    """
    return Axial(axis, Dual(ONE, ZERO), EPS, kind="cylindrical", coordinates=("angle", "length"))


class Planar(JointModel):
    """Slides in the xy-plane and turns about z.  q = (x, y, angle); v = (vx, vy, w) of the body."""

    kind, nq, neutral = "planar", 3, (0.0, 0.0, 0.0)
    coordinates = ("length", "length", "angle")
    additive, velocity_names = False, ("vx", "vy", "w")
    layout = "q = x y angle; v = the body's own velocity vx vy w"
    screws = motor(ZERO_VECTOR, UX), motor(ZERO_VECTOR, UY), motor(UZ, ZERO_VECTOR)

    def motion(self, q: Sequence[Scalar]) -> Pose:
        x, y, angle = q
        return Pose(Rotation.turned(UZ, *cos_sin(angle)), Vector3(x, y, ZERO))

    def quaternion(self, q: Sequence[Scalar]) -> Quaternion:
        x, y, angle = q
        return displaced(Quaternion.about(UZ, angle), Vector3(x, y, ZERO))

    def written(self) -> tuple[Written, ...]:
        return (Written("planar", UZ),)

    def integrate(self, q: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
        """p + R(angle) [c_1, -w c_2; w c_2, c_1] (vx, vy), with c_k = c_k(w^2) of Stumpff."""
        (x, y, angle), (vx, vy, w) = q, v
        a, b = stumpff(1, w * w), w * stumpff(2, w * w)
        tx, ty = a * vx - b * vy, b * vx + a * vy
        c, s = cos_sin(angle)
        return [x + c * tx - s * ty, y + s * tx + c * ty, angle + w]

    def difference(self, q0: Sequence[Scalar], q1: Sequence[Scalar]) -> list[Scalar]:
        """The inverse of `integrate`; without a solution if the angles differ by whole turns and positions differ."""
        (x, y, angle), (x1, y1, angle1) = q0, q1
        w = angle1 - angle
        c, s = cos_sin(angle)
        tx, ty = c * (x1 - x) + s * (y1 - y), c * (y1 - y) - s * (x1 - x)
        a, b = stumpff(1, w * w), w * stumpff(2, w * w)
        n = a * a + b * b
        return [(a * tx + b * ty) / n, (a * ty - b * tx) / n, w]


class Floating(JointModel):
    """q = (x, y, z, qw, qx, qy, qz), a unit quaternion; v = the body's own twist, angular first."""

    kind, nq, neutral = "floating", 7, (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    coordinates = ("length",) * 3 + ("quaternion",) * 4
    additive, velocity_names = False, ("wx", "wy", "wz", "vx", "vy", "vz")
    layout = "q = x y z, qw qx qy qz (unit quaternion, scalar first); v = body twist [w; v]"
    drawn = ()  # it has no fixed axis
    screws = tuple(motor(a, ZERO_VECTOR) for a in AXES) + tuple(motor(ZERO_VECTOR, a) for a in AXES)

    def motion(self, q: Sequence[Scalar]) -> Pose:
        return Pose(Quaternion(*q[3:]).rotation, Vector3(*q[:3]))

    def quaternion(self, q: Sequence[Scalar]) -> Quaternion:
        return displaced(Quaternion(*q[3:]), Vector3(*q[:3]))

    def written(self) -> tuple[Written, ...]:
        return (Written("floating"),)

    def integrate(self, q: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
        """The dual quaternion of q times exp(twist / 2)."""
        step = Quaternion.exp(self.twist(v) / 2)
        r, p = Quaternion(*q[3:]), Vector3(*q[:3])
        return [*(p + r.rotation @ Pose.from_quaternion(step).position), *(r * step.real).normalized]

    def difference(self, q0: Sequence[Scalar], q1: Sequence[Scalar]) -> list[Scalar]:
        X0, X1 = self.motion(q0), self.motion(q1)
        r = Quaternion(*q0[3:]).conjugate * Quaternion(*q1[3:])
        twist = displaced(r, X0.rotation.T @ (X1.position - X0.position)).log * 2
        return [*twist.real, *twist.dual]


class Spherical(JointModel):
    """Turns about a point.  q = (w, x, y, z), a unit quaternion; v = the body's angular velocity in its own axes."""

    kind, nq, neutral = "spherical", 4, (1.0, 0.0, 0.0, 0.0)
    coordinates = ("quaternion",) * 4
    screws = tuple(motor(a, ZERO_VECTOR) for a in AXES)
    additive, velocity_names = False, ("wx", "wy", "wz")
    layout = "q = qw qx qy qz (unit quaternion, scalar first); v = body rate [w]"

    def motion(self, q: Sequence[Scalar]) -> Pose:
        return Pose(Quaternion(*q).rotation)

    def quaternion(self, q: Sequence[Scalar]) -> Quaternion:
        return displaced(Quaternion(*q), ZERO_VECTOR)

    def written(self) -> tuple[Written, ...]:
        raise ArgumentError(
            "is spherical, and URDF has no such joint; three revolute joints at one point move alike, but have other "
            "coordinates, and a singular position"
        )

    def integrate(self, q: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
        """q times exp(w / 2)."""
        return [*(Quaternion(*q) * Quaternion.exp(Vector3(*v) / 2)).normalized]

    def difference(self, q0: Sequence[Scalar], q1: Sequence[Scalar]) -> list[Scalar]:
        return [*(Quaternion(*q0).conjugate * Quaternion(*q1)).log * 2]


def spherical() -> Spherical:
    """A ball joint.

    Returns
    -------
    Spherical
        q = (w, x, y, z), v the angular velocity in the moving frame.

    References
    ----------
    Lynch & Park (2017), 2.2.1.

    Examples
    --------
    >>> from dualpin.model import spherical
    >>> spherical().nq, spherical().nv
    (4, 3)
    """
    return Spherical()
