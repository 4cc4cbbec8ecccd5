"""Two lines, two motors: dual angle, common perpendicular, sum, cylindroid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..dual import Dual, atan2, cos_sin, sqrt, tan
from .arguments import EPSILON, AssumptionError, length, where
from .motors import LineVector, Motor, as_motor

PARALLEL = 8 * EPSILON  # smaller sines cannot be distinguished from the rounding of two unit vectors


def dual_angle(a: Any, b: Any) -> Dual:
    """The dual angle theta + eps s from one line to another.

        sin = |E1 x E2|,   cos = E1.E2,   theta in [0, pi]

    theta is measured about the common perpendicular E1 x E2; s is the distance along it from line 1 to line 2,
    negative if the perpendicular points from 2 to 1.  For parallel lines theta is 0 or pi and s their distance.

    Parameters
    ----------
    a, b : LineVector, Motor, Dual (..., 3) or array_like (..., 6)
        Only their axes are used.

    Returns
    -------
    Dual, shape (...), in rad and m

    Raises
    ------
    AssumptionError, ShapeError
        If one has no axis (a couple, or zero), or an array has another shape.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.2.

    Examples
    --------
    >>> import dualpin as dp
    >>> l1, l2 = dp.algebra.line([0, 0, 0], [0, 0, 1]), dp.algebra.line([0, 1, 5], [1, 0, 0])
    >>> dp.algebra.dual_angle(l1, l2)
    Dual(1.5707963267948966, 1.0)
    """
    e1, e2, normal, sine = _pair("dual_angle", a, b)
    parallel = sine <= PARALLEL
    gap = e2.point - e1.point
    across = gap - (gap * e1.real).sum(axis=-1, keepdims=True) * e1.real
    s = np.where(parallel, length(across, -1), (gap * normal).sum(axis=-1))
    return Dual(np.arctan2(np.where(parallel, 0.0, sine), (e1.real * e2.real).sum(axis=-1))[()], s[()])


def common_perpendicular(a: Any, b: Any) -> tuple[LineVector, np.ndarray, np.ndarray]:
    """The common perpendicular of two lines, along E1 x E2, and its feet.

        E3 = E1 x E2 / |E1 x E2|,   P_i = q_i + h_i u_i,
        h_1 = (q_2 - q_1) x u_2 . u_3 / sin(theta),   h_2 = (q_2 - q_1) x u_1 . u_3 / sin(theta)

    with q_i the point of line i nearest to the origin; lines through the origin need no special case.

    Parameters
    ----------
    a, b : LineVector, Motor, Dual (..., 3) or array_like (..., 6)

    Returns
    -------
    line : LineVector
    foot1, foot2 : ndarray, shape (..., 3)
        The points where it meets line 1 and line 2.

    Raises
    ------
    AssumptionError
        For parallel lines, which have infinitely many.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.3, with its step 6 corrected.

    Examples
    --------
    >>> import dualpin as dp
    >>> l1, l2 = dp.algebra.line([0, 0, 0], [0, 0, 1]), dp.algebra.line([0, 1, 5], [1, 0, 0])
    >>> _, foot1, foot2 = dp.algebra.common_perpendicular(l1, l2)
    >>> foot1.tolist(), foot2.tolist()
    ([0.0, 0.0, 5.0], [0.0, 1.0, 5.0])
    """
    e1, e2, normal, sine = _pair("common_perpendicular", a, b)
    if np.any(sine <= PARALLEL):
        raise AssumptionError(
            f"common_perpendicular: the lines{where(sine <= PARALLEL)} are parallel (sine {float(np.min(sine)):.2g}) "
            "and have a whole pencil of common perpendiculars; skew or meeting lines are needed"
        )
    q1, q2 = e1.point, e2.point
    gap = q2 - q1
    # along e1: gap = h1 e1 + s normal - h2 e2, solved by crossing with e2 and with e1
    h1 = (np.cross(gap, e2.real) * normal).sum(axis=-1, keepdims=True) / sine[..., None]
    h2 = (np.cross(gap, e1.real) * normal).sum(axis=-1, keepdims=True) / sine[..., None]
    foot1, foot2 = q1 + h1 * e1.real, q2 + h2 * e2.real
    return LineVector(normal, np.cross((foot1 + foot2) / 2, normal)), foot1, foot2


def _pair(what: str, a: Any, b: Any) -> tuple[LineVector, LineVector, np.ndarray, np.ndarray]:
    """Unit lines, the unit vector along E1 x E2 (0 if parallel), and the sine of the angle."""
    e1, e2 = (as_motor(what, x).axis for x in (a, b))
    across = np.cross(e1.real, e2.real)
    sine = np.linalg.norm(across, axis=-1)
    return e1, e2, across / np.where(sine > 0, sine, 1.0)[..., None], sine


@dataclass(frozen=True)
class ScrewSum:
    """The steps of `screw_sum`, all in dual numbers; `sum` is the sum of the motors."""

    theta: Dual
    """The dual angle from the first axis to the second."""
    perpendicular: LineVector
    """E12, the common perpendicular of the axes."""
    alpha1: Dual
    """The dual angle from the first axis to the axis of the sum."""
    magnitude: Dual
    axis: LineVector
    sum: Motor


def screw_sum(a: Any, b: Any) -> ScrewSum:
    """The sum of two motors by the triangle of dual angles.

        |A| = sqrt(A1.A1 + A2.A2 + 2 A1.A2),   alpha1 = atan2(sin(theta) |A2|, |A1| + |A2| cos(theta))
        E = E1 rotated by alpha1 about E12:   T = tan(alpha1 / 2) E12,   E = E1 + 2 T / (1 + T.T) x (E1 + T x E1)

    Parameters
    ----------
    a, b : Motor, Dual (3,) or array_like (6,)
        Their axes must not be parallel.

    Returns
    -------
    ScrewSum
        ``.sum``, the angles ``.theta``, ``.alpha1`` and ``.alpha2`` between the three axes.

    Raises
    ------
    AssumptionError, DualDivisionError
        For parallel axes, couples, and sums without an axis.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 7.4.

    Examples
    --------
    >>> import dualpin as dp
    >>> s = dp.algebra.screw_sum([0, 0, 1, 0, 0, 0], [0, 1, 0, 0, 0, 1])
    >>> round(float(s.alpha1.dual), 12), round(float(s.sum.pitch), 12)
    (-0.5, 0.5)
    """
    a, b = as_motor("screw_sum", a), as_motor("screw_sum", b)
    normal, _, _ = common_perpendicular(a, b)
    theta, m1, m2, e1 = dual_angle(a, b), a.magnitude, b.magnitude, a.axis
    c, s = cos_sin(theta)
    unit = np.maximum(m1.real, m2.real)  # squares of the magnitudes could overflow
    n1, n2 = m1 / unit, m2 / unit
    size = sqrt(n1 * n1 + n2 * n2 + 2 * n1 * n2 * c) * unit
    alpha = atan2(s * n2, n1 + n2 * c)
    t = tan(alpha / 2)
    T = normal * t
    axis = e1 + T.cross(e1 + T.cross(e1)) * (2 / (1 + t * t))
    return ScrewSum(theta, normal, alpha, size, LineVector(axis.real, axis.dual), axis * size)


def motor_sum(a: Any, b: Any) -> Motor:
    """The sum of two motors; `screw_sum` shows its construction from dual angles, where that is defined.

    Parameters
    ----------
    a, b : Motor, Dual (..., 3) or array_like (..., 6)
        Broadcast together.

    Returns
    -------
    Motor

    Raises
    ------
    ShapeError
        If the last axis is not that of a motor.

    References
    ----------
    Ball (1900), ch. I; Pennestri & Stefanelli (2007), sec. 7.4.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.algebra.motor_sum([0, 0, 1, 0, 0, 0], [0, 1, 0, 0, 0, 1]).six.tolist()
    [0.0, 1.0, 1.0, 0.0, 0.0, 1.0]
    """
    return as_motor("motor_sum", a) + as_motor("motor_sum", b)


@dataclass(frozen=True)
class Cylindroid:
    """The ruled surface of all screws a S1 + b S2: two principal screws meet at right angles in its centre.

    The screw at the angle phi from the first principal one has the pitch h1 cos^2 + h2 sin^2 and meets the
    nodal line at the height (h2 - h1) sin cos.  (Ball 1900; Pluecker's conoid)
    """

    principal: tuple[Motor, Motor]
    pitches: np.ndarray
    """h1 <= h2."""
    center: np.ndarray
    nodal: LineVector
    """The line that all axes meet at right angles, directed like S1 x S2 of the principal screws."""

    def screw(self, phi: ArrayLike) -> Motor:
        """The screw at the angle phi [rad] from the first principal one, of unit size."""
        c, s = np.cos(phi), np.sin(phi)
        return self.principal[0] * c + self.principal[1] * s

    def pitch(self, phi: ArrayLike) -> np.ndarray:
        h1, h2 = self.pitches
        return h1 * np.cos(phi) ** 2 + h2 * np.sin(phi) ** 2

    def height(self, phi: ArrayLike) -> np.ndarray:
        """The position along the nodal line, from the centre [m]."""
        h1, h2 = self.pitches
        return (h2 - h1) * np.sin(phi) * np.cos(phi)


def cylindroid(a: Any, b: Any) -> Cylindroid:
    """The cylindroid of two screws.

    Principal screws make the pitch M.M' / M.M stationary:  K c = h G c  with G_ij = M_i.M_j and
    K_ij = (M_i.M_j' + M_j.M_i') / 2.

    Parameters
    ----------
    a, b : Motor, Dual (3,) or array_like (6,)

    Returns
    -------
    Cylindroid
        ``.axes`` and ``.pitches`` of the two principal screws, ``.center`` where they meet.

    Raises
    ------
    AssumptionError
        If the directions are parallel (their screws fill a plane pencil) or one is a couple.

    References
    ----------
    Ball (1900), ch. II.

    Examples
    --------
    >>> import dualpin as dp
    >>> c = dp.algebra.cylindroid([0, 0, 1, 0, 0, 0], [0, 1, 0, 0, 0, 1])
    >>> c.pitches.round(12).tolist(), c.center.round(12).tolist()
    ([-0.5, 0.5], [0.5, 0.0, 0.0])
    """
    screws = [as_motor("cylindroid", x) for x in (a, b)]
    G, K = (np.array([[getattr(x.dot(y), part).item() for y in screws] for x in screws]) for part in ("real", "dual"))
    size = np.sqrt(np.outer(np.diag(G), np.diag(G)))
    if not np.all(size > 0) or np.linalg.det(G) <= PARALLEL * size[0, 1] ** 2:
        raise AssumptionError("cylindroid: two screws of finite pitch with directions that are not parallel are needed")
    L = np.linalg.cholesky(G)
    Li = np.linalg.inv(L)
    h, c = np.linalg.eigh(Li @ (K / 2) @ Li.T)  # K holds both products
    c = Li.T @ c
    s1, s2 = (screws[0] * c[0, i] + screws[1] * c[1, i] for i in (0, 1))
    nodal, foot1, foot2 = common_perpendicular(s1, s2)
    return Cylindroid((s1, s2), h, (foot1 + foot2) / 2, nodal)
