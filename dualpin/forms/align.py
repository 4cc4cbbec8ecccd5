"""Denavit-Hartenberg parameters are dual spherical coordinates.

In the frame that stands on the present axis (its z axis), the next axis is a unit line, a dual
vector on the dual unit sphere.  The step Z(theta^) X(alpha^) carries the present z axis to

    (sin alpha^ sin theta^,  -sin alpha^ cos theta^,  cos alpha^),

so that the azimuth and the polar angle of the line are the four parameters (transference):

    theta^ = theta + eps d = atan2(L_x, -L_y)        alpha^ = alpha + eps a = atan2(sqrt(L_x^2 + L_y^2), L_z)

At the poles, where the axes are parallel, the azimuth is free and is chosen; close to the poles it
is ill-conditioned, and a fixed row is put in between.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, cos, hypot, pi, sin
from math import atan2 as angle_of

from ..dual import Dual, atan2, sqrt
from ..spatial.pose import Pose
from ..spatial.vector import ZERO_VECTOR, Vector3, motor
from .chain import Axis

Step = tuple[Dual, Dual]
"""theta + eps d about and along z, then alpha + eps a about and along x."""

NONE = Dual(0.0, 0.0)
PARALLEL = 1e-14  # sine of the angle that rounding in a product of rotations leaves between parallel axes
NEAR = 0.02  # below it d grows like 1/sine and loses as many digits: then a fixed row is inserted
MEETING = 1e-13  # metres: axes this close intersect or coincide, an order above rounding of positions of metres
CLEAN = 1e-15  # rounding of one step: angles this near a multiple of 90 degrees, lengths this near 0
ON_AXIS = 1e-6  # metres: a tip this close to its last, nearly parallel axis is put on it; the tool has the rest
TIE = 1e-9  # cosine of theta below which either direction of x is as near


@dataclass(frozen=True)
class Rules:
    """What counts as parallel, as near to it, and what is rounded off."""

    near: float = NEAR
    parallel: float = PARALLEL
    angle: float = CLEAN
    length: float = CLEAN

    def cleaned(self, x: Dual) -> Dual:
        """Angles within tolerance of a multiple of 90 degrees, and lengths within tolerance of 0, exactly."""
        angle, length = x.real, x.dual
        quarter = round(angle / (pi / 2)) * (pi / 2)
        if abs(angle - quarter) <= self.angle:
            angle = quarter
        return Dual(angle + 0.0, 0.0 if abs(length) <= self.length else length)


def step(line: Vector3, rules: Rules, target: Pose | None = None) -> list[Step]:
    """The steps that carry the present z axis to `line`: one, or more if the axes are nearly parallel.

    Parameters
    ----------
    line : Vector3 of Dual
        The next axis in the present frame.
    target : Pose, optional
        Of the tip in the present frame, when `line` is its z axis: what is free is chosen to end there.
    """
    line = _floats_of(line)
    u = line.real
    if (sine := hypot(u.x, u.y)) <= rules.parallel:
        steps = [_parallel(line, target)]
    elif sine < rules.near:
        steps = _nearly_parallel(line) if target is None else _ending(line, target)
    else:
        steps = [_skew(line)]
    return [(rules.cleaned(z), rules.cleaned(x)) for z, x in steps]


def _floats_of(line: Vector3) -> Vector3:
    return motor(Vector3(*map(float, line.real)), Vector3(*map(float, line.dual)))


def _skew(line: Vector3) -> Step:
    x, y, z = line
    theta, alpha = atan2(x, -y), atan2(sqrt(x * x + y * y), z)
    c = cos(theta.real)
    if c < -TIE or (abs(c) <= TIE and alpha.dual < -MEETING):
        theta, alpha = atan2(-x, y), -alpha
    return theta, alpha


def _azimuth(x: float, y: float, meeting: float = MEETING) -> tuple[float, float]:
    """Direction of x that leads to (x, y), turned as little as possible, and the signed distance."""
    length = hypot(x, y)
    if length <= meeting:
        return 0.0, 0.0
    return (angle_of(-y, -x), -length) if x < -TIE * length else (angle_of(y, x), length)


def _parallel(line: Vector3, target: Pose | None) -> Step:
    foot, alpha = line.real.cross(line.dual), 0.0 if line.real.z > 0 else pi
    if target is not None:
        return _to_tip(foot.x, foot.y, alpha, target, MEETING)
    theta, a = _azimuth(foot.x, foot.y)
    return Dual(theta, 0.0), Dual(alpha, a)


def _to_tip(x: float, y: float, alpha: float, target: Pose, meeting: float) -> Step:
    """Along the axis to the height of the tip, then out to (x, y); if there is no way out, x is the tip's."""
    theta, a = _azimuth(x, y, meeting)
    if a == 0.0:
        tip_x, tip_y, _ = (float(row.x) for row in target.rotation.rows)
        theta = angle_of(tip_y, tip_x)
    return Dual(theta, float(target.position.z)), Dual(alpha, a)


def _ending(line: Vector3, target: Pose) -> list[Step]:
    """To the tip's origin as if the axes were parallel, then the small rotation that is left over."""
    x, y, _ = map(float, target.position)
    first = _to_tip(x, y, 0.0 if line.real.z > 0 else pi, target, ON_AXIS)
    return [first, *_nearly_parallel(_floats_of(Pose.dh(*first).inverse @ line))]


def _nearly_parallel(line: Vector3) -> list[Step]:
    """Hayati's X(alpha, a) Ry(beta), with Ry(beta) = X(-pi/2) Z(beta) X(pi/2).  (Hayati & Mirmirani 1985)"""
    u, m = line.real, line.dual
    theta, a = _azimuth(-m.y / u.z, m.x / u.z)  # where the line meets the plane z = 0
    c, s = cos(theta), sin(theta)
    ux, uy = c * u.x + s * u.y, c * u.y - s * u.x
    beta, alpha = asin(max(-1.0, min(1.0, ux))), angle_of(-uy, u.z)
    return [(Dual(theta, 0.0), Dual(alpha - pi / 2, a)), (Dual(beta, 0.0), Dual(pi / 2, 0.0))]


def ahead(axis: Axis, X: Pose) -> Vector3:
    """The axis in the frame X; a prismatic one, whose place is free, through X's origin."""
    line = X.inverse @ axis.line
    return motor(line.real, ZERO_VECTOR) if axis.letter == "P" else line


def numeric(X: Pose) -> Pose:
    """The same pose in plain floats."""
    return Pose.from_rows(X.array.tolist())


def remaining(rest: Pose, rules: Rules) -> Dual:
    """The dual angle about z that is left when the z axes agree."""
    c, s, _ = (float(row.x) for row in rest.rotation.rows)
    return rules.cleaned(Dual(float(atan2(s, c)), float(rest.position.z)))
