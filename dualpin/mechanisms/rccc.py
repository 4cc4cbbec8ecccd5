"""The RCCC linkage: the loop of one revolute and three cylindrical joints, whose positions have a closed form.

Dual angles of both kinds: theta_i + eps s_i at the joints, alpha_i + eps a_i along the links.  Joint 1 is driven
(s_1 fixed).  What holds of any loop (closure, screws, continuation, velocities) is done by `Loop`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from .. import algebra
from ..algebra.arguments import AssumptionError, dual_array, finite
from ..algebra.displacements import stacked
from ..algebra.newton import NewtonResult
from ..arguments import is_symbol
from ..dual import Dual, acos, atan2, cos, cos_sin, sin, sqrt, stack
from ..errors import ArgumentError, DualDivisionError, ShapeError, nearest
from ..spatial import UZ, Matrix3, Rotation, skew
from .loop import Loop
from .loop_data import dual_angles

ROWS = (0, 1, 2, 1, 2, 2), (0, 0, 0, 1, 1, 2)  # entries of the loop matrix that fix a displacement
START = np.radians(100.0)


@dataclass(frozen=True)
class Position:
    """One way in which the linkage can be assembled; dual angles in rad and m."""

    theta1: Dual
    theta2: Dual
    theta3: Dual
    theta4: Dual
    closure: float
    """max |A1 A2 A3 A4 - 1| over both parts."""


@dataclass(frozen=True)
class Iteration:
    """The result of an iterative method: the position, and the corrections of each iteration."""

    position: Position
    iterations: int
    trace: list[Dual]
    """(theta2, theta3, theta4) at each iteration, the start included."""


class RCCC:
    """A closed spatial linkage with one revolute and three cylindrical joints.

    Parameters
    ----------
    alpha_hat : Dual (4,), sequence of four Dual, or array_like (4, 2)
        Dual angles alpha_i + eps a_i of the links [rad, m]; joint i+1 follows link i.  `coefficients` also takes
        symbols.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 12 and listing 14.2; Yang & Freudenstein (1964).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> linkage = dp.mechanisms.RCCC(np.transpose([np.radians([30, 55, 45, 60]), [2, 4, 3, 5]]))
    >>> for p in linkage.solve(np.radians(40)):
    ...     print(f"{p.theta4.real:.9f} {p.theta4.dual:.9f}")
    -2.694269146 -0.150238249
    2.036355808 -1.770565941
    """

    def __init__(self, alpha_hat: Any) -> None:
        self.alpha = dual_angles("RCCC: alpha_hat", alpha_hat, 4, symbols=True)

    @cached_property
    def loop(self) -> Loop:
        """The same linkage as a loop of joints like any other; dimensions in numbers only."""
        return Loop("RCCC", self.alpha)

    def __repr__(self) -> str:
        links = ", ".join(f"{x:.6g} + {y:.6g} eps" for x, y in zip(*self.alpha.arrays, strict=True))
        return f"<RCCC alpha = {links}>"

    # the loop

    def joint_matrices(self, theta: Sequence[Dual]) -> list[Dual]:
        """A_i = Z(theta_i) X(alpha_i), each a dual array (..., 3, 3)."""
        return self.loop.joint_matrices(theta)

    def closure(self, theta: Sequence[Dual]) -> Dual:
        """A1 A2 A3 A4 - 1, zero when the loop is closed, shape (..., 3, 3)."""
        return self.loop.closure(theta)

    def coefficients(self, theta1: Any) -> tuple[Dual, Dual, Dual]:
        """A, B, C of the input-output equation  A sin(theta4) + B cos(theta4) + C = 0.

        A = s1 s3 sin(theta1),   B = -s3 (c1 s4 + s1 c4 cos(theta1)),   C = c3 (c1 c4 - s1 s4 cos(theta1)) - c2
        """
        (c1, s1), (c2, _), (c3, s3), (c4, s4) = (cos_sin(self.alpha[i]) for i in range(4))
        c, s = cos_sin(_dual(theta1))
        return s1 * s3 * s, -s3 * (c1 * s4 + s1 * c4 * c), c3 * (c1 * c4 - s1 * s4 * c) - c2

    def _need_numbers(self, who: str) -> None:
        if self.alpha.real.dtype == object:
            raise ArgumentError(f"{who}: the linkage's dimensions are symbols; only `coefficients` takes them")

    # closed form

    def solve(self, theta1: Any) -> list[Position]:
        """All positions for an input angle, in closed form.

            theta4 = atan2(A, B) -+ acos(-C / sqrt(A^2 + B^2)),
            theta2 = atan2(N31, -N32),   theta3 = atan2(N13, N23),   N = X3 Z4 X4 Z1 X1

        Parameters
        ----------
        theta1 : float or Dual
            In rad; the dual part is the fixed offset s_1 along the revolute joint.

        Returns
        -------
        list of Position
            By ascending theta4 in (-pi, pi]; empty where the linkage cannot be assembled.

        Raises
        ------
        DualDivisionError
            In a dead centre, where the two branches meet and the slides would be infinite; for dimensions
            whose joint axes 2 and 3, or 3 and 4, are parallel (sin(alpha) without a real part).
        """
        self._need_numbers("solve")
        t1 = _dual(theta1)
        if t1.shape:
            raise ShapeError(f"solve: one input angle expected, got shape {t1.shape}; sweep takes arrays")
        finite("solve: theta1", np.asarray(t1.real))
        A, B, C = self.coefficients(t1)
        size = sqrt(A * A + B * B)
        if size.real < 1e-12:
            raise DualDivisionError("solve: theta4 is not determined (A = B = 0): axes 3 and 4 are parallel")
        cosine = -C / size
        excess = abs(cosine.real) - 1
        if excess > 1e-14:
            return []
        if excess > -1e-14:
            raise DualDivisionError(f"solve: theta1 = {t1.real:.9g} is a dead centre: the branches meet")
        middle, half = atan2(A, B), acos(cosine)
        found = [self.position(t1, _wrapped(middle + sign * half)) for sign in (1, -1)]
        return sorted(found, key=lambda p: float(p.theta4.real))

    def position(self, theta1: Any, theta4: Dual) -> Position:
        """The position with these theta1 and theta4, which must satisfy the input-output equation."""
        t1 = _dual(theta1)
        N = self._left(t1, theta4).rows
        side = np.sign(np.sin(self.alpha[1].real))
        theta2 = atan2(N[2].x * side, -N[2].y * side)
        theta3 = atan2(N[0].z * side, N[1].z * side)
        return self._position(t1, theta2, theta3, theta4)

    def _left(self, theta1: Dual, theta4: Dual) -> Matrix3:
        X1, _, X3, X4 = self.loop.links
        return X3 @ Rotation.about(UZ, theta4) @ X4 @ Rotation.about(UZ, theta1) @ X1

    def _position(self, *theta: Dual) -> Position:
        defect = self.closure(theta)
        size = float(max(np.abs(defect.real).max(), np.abs(defect.dual).max()))
        t1, t2, t3, t4 = (t if t.shape else Dual(float(t.real), float(t.dual)) for t in theta)
        return Position(t1, t2, t3, t4, size)

    # iterative methods

    def method_a(self, theta1: Any, theta4: Dual | float = START, **options: Any) -> NewtonResult:
        """Newton's method on the input-output equation; the result's iterates are Table 5 of the paper."""
        A, B, C = self.coefficients(theta1)
        return algebra.newton(lambda t: A * sin(t) + B * cos(t) + C, _dual(theta4), **options)

    def method_b(
        self, theta1: Any, start: Sequence[Any] = (START,) * 3, *, check: bool = True, **options: Any
    ) -> Iteration:
        """Newton's method on the entries (3,3), (3,1), (1,1) of  X3 Z4 X4 Z1 X1 - Z3^T X2^T Z2^T = 0.

        Three entries do not fix a rotation: the method can end in a position that does not close the loop.

        Raises
        ------
        AssumptionError
            If it does, unless check is False.
        """
        t1 = _dual(theta1)
        X2 = self.loop.links[1]

        def f(x: Sequence[Dual]) -> list[Dual]:
            left = self._left(t1, x[2]).rows
            right = (Rotation.about(UZ, x[1]).T @ X2.T @ Rotation.about(UZ, x[0]).T).rows
            return [left[i].z - right[i].z if j == 2 else left[i].x - right[i].x for i, j in ((2, 2), (2, 0), (0, 0))]

        result = algebra.newton(f, [_dual(x) for x in start], **options)
        position = self._position(t1, *(_wrapped(result.x[i]) for i in range(3)))
        if check and position.closure > 1e-9:
            raise AssumptionError(
                f"method_b: theta3 = {position.theta3} solves the three equations but leaves the loop open by "
                f"{position.closure:.3g}; begin elsewhere, or use solve"
            )
        return Iteration(position, result.iterations, result.iterates)

    def method_c(
        self,
        theta1: Any,
        start: Any = (START,) * 3,
        *,
        variant: str = "C4",
        tol: float = 1e-6,
        max_iterations: int = 100,
    ) -> Iteration:
        """Newton's method on six entries of A1 A2 A3 A4 = 1, a 6 x 3 dual system  M d = v  at each step.

            column i of M:  A1 ... A_{i-1} Q A_i ... A4,  i = 2, 3, 4,      v = entries of 1 - A1 A2 A3 A4

        Parameters
        ----------
        variant : str
            "C1": normal equations, real and dual part solved one after the other; "C1-listing": the same as
            printed in listing 14.2, where the dual right-hand side holds the last iteration's correction;
            "C2": as C1 with one QR factorisation; "C3": dual QR of the normal equations; "C4": pseudo-inverse.
        tol : float
            Stop when the sum of all |d| + |d'| is below.
        """
        if variant not in VARIANTS:
            raise ArgumentError(f"method_c: variant {variant!r} is not known; {nearest(variant, VARIANTS, 'variants')}")
        t1 = _dual(theta1)
        x = Dual(*dual_array("method_c: start", start if isinstance(start, Dual) else [_dual(t) for t in start], 1))
        trace, last = [x], np.zeros(3)
        for k in range(1, max_iterations + 1):
            M, v = self._system(t1, x)
            step = VARIANTS[variant](M, v, last)
            last = step.real
            x = x + step
            trace.append(x)
            if np.abs(step.real).sum() + np.abs(step.dual).sum() < tol:
                return Iteration(self._position(t1, *(_wrapped(x[i]) for i in range(3))), k, trace)
        raise AssumptionError(f"method_c: not converged in {max_iterations} iterations; begin nearer to a position")

    def _system(self, t1: Dual, x: Dual) -> tuple[Dual, Dual]:
        """A1 ... A_{i-1} Q A_i ... A4 = [s_i] A1 A2 A3 A4, with the joint's axis s_i = A1 ... A_{i-1} z."""
        theta = [t1, x[0], x[1], x[2]]
        *_, whole = self.loop.walk(theta)
        columns = [stacked(skew(s) @ whole)[ROWS] for s in self.loop.axes(theta)[1:]]
        return stack(columns, axis=-1), (-stacked(whole) + np.eye(3))[ROWS]

    # sweeps

    def sweep(self, theta1: Any) -> Dual:
        """Closed form for an array of input angles: theta2, theta3, theta4 of both branches.

        Parameters
        ----------
        theta1 : array_like or Dual, shape (...)

        Returns
        -------
        Dual, shape (..., 2, 3)
            Axis -2: the branches theta4 = atan2(A, B) - acos(...) and + acos(...), each continuous in theta1;
            nan where the linkage cannot be assembled.
        """
        self._need_numbers("sweep")
        t1 = _dual(theta1)
        A, B, C = (Dual(*np.broadcast_arrays(*x.arrays)) for x in self.coefficients(t1))
        size = sqrt(A * A + B * B)
        cosine = -C / size
        possible = np.abs(cosine.real) < 1 - 1e-14
        middle, half = atan2(A, B), acos(Dual(np.where(possible, cosine.real, 0.0), cosine.dual))
        branches = []
        for sign in (-1, 1):
            p = self.position(t1, _wrapped(middle + sign * half))
            branches.append(stack([p.theta2, p.theta3, p.theta4], axis=-1))
        both, known = stack(branches, axis=-2), possible[..., None, None]
        return Dual(np.where(known, both.real, np.nan), np.where(known, both.dual, np.nan))

    def sweep_by_iteration(
        self, theta1: Any, *, variant: str = "C4", tol: float = 1e-6
    ) -> tuple[list[Position], list[int]]:
        """Method C at each input angle, begun at the last position; positions and numbers of iterations."""
        x: Any = (START,) * 3
        positions, counts = [], []
        for t in np.asarray(theta1, dtype=float):
            run = self.method_c(float(t), x, variant=variant, tol=tol)
            positions.append(run.position)
            counts.append(run.iterations)
            x = run.trace[-1]
        return positions, counts


# --- one step of method C ------------------------------------------------------------------------


def _normal(M: Dual, v: Dual) -> tuple[Dual, Dual]:
    return M.T @ M, M.T @ v


def _c1(M: Dual, v: Dual, last: np.ndarray) -> Dual:
    N, u = _normal(M, v)
    d = np.linalg.solve(N.real, u.real)
    return Dual(d, np.linalg.solve(N.real, u.dual - N.dual @ d))


def _c1_listing(M: Dual, v: Dual, last: np.ndarray) -> Dual:
    N, u = _normal(M, v)
    return Dual(np.linalg.solve(N.real, u.real), np.linalg.solve(N.real, u.dual - N.dual @ last))


def _c2(M: Dual, v: Dual, last: np.ndarray) -> Dual:
    N, u = _normal(M, v)
    q, r = np.linalg.qr(N.real)
    d = np.linalg.solve(r, q.T @ u.real)
    return Dual(d, np.linalg.solve(r, q.T @ (u.dual - N.dual @ d)))


def _c3(M: Dual, v: Dual, last: np.ndarray) -> Dual:
    N, u = _normal(M, v)
    q, r = algebra.qr(N)
    return algebra.solve(r, q.T @ u)


def _c4(M: Dual, v: Dual, last: np.ndarray) -> Dual:
    return algebra.pinv(M) @ v


VARIANTS: dict[str, Callable[[Dual, Dual, np.ndarray], Dual]] = {
    "C1": _c1, "C1-listing": _c1_listing, "C2": _c2, "C3": _c3, "C4": _c4,
}  # fmt: skip


def _dual(x: Any) -> Dual:
    if isinstance(x, Dual):
        return x
    if is_symbol(x):
        return Dual(x, 0)
    y, _ = dual_array("RCCC: theta", x)
    return Dual(y, np.zeros(y.shape)) if y.shape else Dual(float(y), 0.0)


def _wrapped(t: Dual) -> Dual:
    """The same angle in (-pi, pi]."""
    turns = np.ceil((t.real - np.pi) / (2 * np.pi))
    return Dual(t.real - 2 * np.pi * turns, t.dual)
