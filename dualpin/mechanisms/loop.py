"""Closed loops of R, P, C and H joints by dual matrices:  A1 A2 ... An = 1,  A_i = Z(theta_i) X(alpha_i).

A joint's dual angle is theta_i = sum of u_k q_k + offset_i, with units u of 1 (R), eps (P), 1 + eps h (H), or both
1 and eps (C), so no step below asks what kind a joint is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..algebra.arguments import AssumptionError, finite
from ..algebra.displacements import stacked
from ..arguments import count, numbers, real
from ..dual import Dual
from ..errors import ArgumentError, DualDivisionError, ShapeError
from ..spatial import UX, UZ, Matrix3, Quaternion, Rotation, Vector3
from .loop_data import UNITS, LoopMotion, LoopPosition, dual_angles, kinds

CLOSED = 1e-9  # of a closure, in radians and of the loop's length: more than rounding leaves, less than a mistake
RANK = 1e-9  # singular values below this part of the largest count as zero
TURN = 0.05  # largest correction of a predicted position, in radians and of the loop's length
ROUNDS = 60  # of Newton's method; from anywhere it takes ten


class Loop:
    """A single closed loop of joints with one freedom.

        A1 A2 ... An = 1,   A_i = Z(theta_i) X(alpha_i)

    Position by Newton's method on these dual equations, velocity and acceleration by differentiating them.

    Parameters
    ----------
    joints : str or sequence
        One for each link: "R", "P", "C" or ("H", pitch), pitch in m/rad; "RCCC" is short for ["R", "C", "C", "C"].
    alpha : Dual (n,), sequence of n Dual, or array_like (n, 2)
        Dual angles alpha_i + eps a_i of the links [rad, m]; joint i + 1 follows link i.
    offsets : Dual (n,) or array_like (n, 2), optional
        What is added to each joint's dual angle: the constant slide of a revolute joint is the dual part, the constant
        angle of a prismatic one the real part.
    driven : int
        Which coordinate is the input, by default the first.

    Attributes
    ----------
    names : list of str
        Of the coordinates: "theta2" an angle, "s2" a slide.

    Notes
    -----
    A spherical joint is three revolute ones whose axes meet (alpha = 90 deg, a = 0, no offsets), a universal joint two.
    An RSSR linkage so becomes a loop of seven revolute joints: one of the two balls is written as a universal joint,
    since the coupler's turning about its own axis moves nothing else.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 12, eqs 68-76, there for the RCCC linkage; Uicker, Denavit & Hartenberg (1964).

    Examples
    --------
    Bennett's linkage has four skew hinges, and moves all the same, since sin(alpha) / a is the same for all links:

    >>> import numpy as np, dualpin as dp
    >>> bennett = dp.mechanisms.Loop("RRRR", [(0.6, np.sin(0.6)), (1.1, np.sin(1.1))] * 2)
    >>> turn = bennett.follow(np.linspace(0.1, 0.1 + 2 * np.pi, 73))
    >>> bool(turn.closure.max() < 1e-12), bennett.mobility(turn.q[20])
    (True, 1)
    """

    def __init__(self, joints: Any, alpha: Any, offsets: Any = None, *, driven: int = 0) -> None:
        who = type(self).__name__
        letters = kinds(who, joints)
        self.alpha = dual_angles(f"{who}: alpha", alpha, len(letters))
        offset = Dual(np.zeros(len(letters)), 0.0) if offsets is None else offsets
        self.offsets = dual_angles(f"{who}: offsets", offset, len(letters))
        self.joints = tuple(letter for letter, _ in letters)
        self.links = [Rotation.about(UX, Dual(float(x), float(y))) for x, y in zip(*self.alpha.arrays, strict=True)]
        of = [(i, unit) for i, (letter, pitch) in enumerate(letters) for unit in UNITS.get(letter, ((1.0, pitch),))]
        self._joint_of = np.array([i for i, _ in of])
        self._units = np.array([u for _, u in of])
        self.names = [f"{'theta' if turns else 's'}{i + 1}" for i, (turns, _) in of]
        if not count(f"{who}: driven", driven) < self.nq:
            raise ArgumentError(f"{who}: driven = {driven}, a coordinate from 0 to {self.nq - 1} expected")
        self.driven = driven
        self._free = [k for k in range(self.nq) if k != driven]
        lengths = (self.alpha.dual, self.offsets.dual, self._units[:, 1] * self._units[:, 0])
        self._length = max(float(np.abs(x).max(initial=0.0)) for x in lengths) or 1.0
        # coordinates and equations in radians and in lengths of the loop, so that both count alike
        self._scale = np.where(self._units[:, 0] == 0, self._length, 1.0)

    @property
    def nq(self) -> int:
        """How many coordinates there are, the input included."""
        return len(self.names)

    def __repr__(self) -> str:
        links = ", ".join(f"{x:.6g} + {y:.6g} eps" for x, y in zip(*self.alpha.arrays, strict=True))
        return f"<{type(self).__name__} {''.join(self.joints)}: alpha = {links}>"

    # the loop

    def theta(self, q: ArrayLike) -> list[Dual]:
        """The joints' dual angles (...) of the coordinates (..., nq)."""
        x = self._coordinates("theta", q)
        parts = [np.broadcast_to(p, (*x.shape[:-1], len(self.joints))).copy() for p in self.offsets.arrays]
        for k, (i, unit) in enumerate(zip(self._joint_of, self._units, strict=True)):
            for part, u in zip(parts, unit, strict=True):
                part[..., i] += u * x[..., k]
        return [Dual(parts[0][..., i], parts[1][..., i]) for i in range(len(self.joints))]

    def _steps(self, theta: Sequence[Dual]) -> list[Rotation]:
        return [Rotation.about(UZ, t) @ link for t, link in zip(theta, self.links, strict=True)]

    def joint_matrices(self, theta: Sequence[Dual]) -> list[Dual]:
        """A_i = Z(theta_i) X(alpha_i), each a dual array (..., 3, 3)."""
        return [stacked(A) for A in self._steps(theta)]

    def closure(self, theta: Sequence[Dual]) -> Dual:
        """A1 A2 ... An - 1, zero when the loop is closed, shape (..., 3, 3)."""
        return stacked(self.walk(theta)[-1]) - np.eye(3)

    def frames(self, q: ArrayLike) -> Dual:
        """A1 ... A_{i-1}: the frame of each joint in the first one, its z the joint's axis, shape (..., n, 3, 3)."""
        walk = self.walk(self.theta(q))[:-1]
        batch = np.asarray(q).shape[:-1]
        matrices = [stacked(M) for M in walk]
        return Dual(*(np.stack([np.broadcast_to(getattr(M, part), (*batch, 3, 3)) for M in matrices], axis=-3)
                      for part in ("real", "dual")))  # fmt: skip

    def walk(self, theta: Sequence[Dual]) -> list[Rotation]:
        """1, A1, A1 A2, ..., A1 ... An."""
        walk = [Rotation.about(UZ, Dual(0.0, 0.0))]
        for A in self._steps(theta):
            walk.append(walk[-1] @ A)
        return walk

    def axes(self, theta: Sequence[Dual]) -> list[Vector3]:
        """The joints' axes as unit lines in the first frame, s_i = A1 ... A_{i-1} z."""
        return _axes(self.walk(theta))

    def _defect(self, theta: Sequence[Dual]) -> np.ndarray:
        off = self.closure(theta)
        return np.maximum(np.abs(off.real).max(axis=(-2, -1)), np.abs(off.dual).max(axis=(-2, -1)))

    # position

    def solve(self, x: Any, starts: int = 256, seed: int = 0) -> Sequence[LoopPosition]:
        """The positions for a value of the input: Newton's method from many starts, without those that do not close.

        Parameters
        ----------
        x : float
            The input coordinate [rad or m].
        starts, seed : int
            How many random starts.

        Returns
        -------
        list of LoopPosition
            In ascending order of the coordinates, angles in (-pi, pi]; empty where the loop cannot close.

        Notes
        -----
        A search that may miss positions: loops of seven revolute joints have up to 16.
        """
        value = real("solve: input", x)
        rng, many = np.random.default_rng(seed), count("solve: starts", starts, 1)
        q = rng.uniform(-np.pi, np.pi, (many, self.nq)) * self._scale
        q[:, self.driven] = value
        q = self._newton(q)
        found: list[np.ndarray] = []
        for each in self._wrapped(q[self._defect(self.theta(q)) <= CLOSED * max(1.0, self._length)]):
            if all(np.abs(self._wrapped((each - other)[None]) / self._scale).max() > 1e-6 for other in found):
                found.append(each)
        return [self._position(each) for each in sorted(found, key=lambda each: tuple(each.round(9)))]

    def follow(self, x: ArrayLike, start: Any = None) -> LoopMotion:
        """The positions along values of the input, each continued from the last.

        A step goes along the tangent and is corrected by Newton's method; where the correction is large it is
        halved, so that the motion cannot change into another one that closes too.

        Parameters
        ----------
        x : array_like (n,)
            Values of the input coordinate, in the order in which they are passed.
        start : LoopPosition or array_like (nq,), optional
            Near a position at x[0]; by default the first that `solve` finds.

        Returns
        -------
        LoopMotion

        Raises
        ------
        AssumptionError
            If the loop cannot close at x[0], or the motion ends before the last value (a dead centre).
        """
        values = numbers("follow: x", x)
        if values.ndim != 1 or not values.size or not np.isfinite(values).all():
            raise ShapeError(f"follow: finite values (n,) of the input expected, got shape {values.shape}")
        rows = [self._begin(float(values[0]), start)]
        for value in values[1:]:
            rows.append(self._advance(rows[-1], float(value)))
        q = np.array(rows)
        theta = self.theta(q)
        both = (np.stack([getattr(t, part) for t in theta], axis=-1) for part in ("real", "dual"))
        return LoopMotion(q, Dual(*both), self._defect(theta))

    def _begin(self, value: float, start: Any) -> np.ndarray:
        if start is None:
            found = self.solve(value)
            if not found:
                raise AssumptionError(f"follow: the loop cannot be closed at {self.names[self.driven]} = {value:.9g}")
            start = found[0]
        near = self.coordinates(start.theta) if isinstance(start, LoopPosition) else start
        q = self._coordinates("start", near).copy()
        if q.shape != (self.nq,):
            raise ShapeError(f"follow: start of shape ({self.nq},) expected, got {q.shape}")
        q[self.driven] = value
        return self._closed(self._newton(q), "follow: start")

    def _advance(self, q: np.ndarray, value: float) -> np.ndarray:
        step = value - q[self.driven]
        while q[self.driven] != value:
            left = value - q[self.driven]
            step = left if abs(step) >= abs(left) else step
            guess = q + self.velocity(q) * step
            guess[self.driven] = value if step == left else q[self.driven] + step
            new = self._newton(guess)
            if np.abs((new - guess) / self._scale).max() <= TURN and self._closes(new):
                q, step = new, 2 * step
            elif abs(step) > 1e-7:
                step /= 2
            else:
                at = f"{self.names[self.driven]} = {q[self.driven]:.9g}"
                raise AssumptionError(f"follow: the motion ends at {at}: a dead centre, from which it cannot go on")
        return q

    def _newton(self, q: np.ndarray) -> np.ndarray:
        """Newton's method on the closure, the input kept: S dq = -log(A1 ... An), S as in `screws`.

        The logarithm vanishes for a closed loop only; the skew part of A1 ... An also does after half a turn.
        """
        q = q.copy()
        for _ in range(ROUNDS):
            walk = self.walk(self.theta(q))
            S, gap = self._screws(walk), self._equations(Quaternion.from_rotation(walk[-1]).log * 2)
            step = -(np.linalg.pinv(S[..., self._free], RANK) @ gap[..., None])[..., 0]
            size = np.abs(step).max(axis=-1, keepdims=True, initial=0.0)
            q[..., self._free] += step / np.maximum(1.0, size) * self._scale[self._free]  # at most a radian at once
            if size.max(initial=0.0) < 1e-9:  # the next one would be its square
                break
        return q

    def _closes(self, q: np.ndarray) -> bool:
        return bool(self._defect(self.theta(q)) <= CLOSED * max(1.0, self._length))

    def _closed(self, q: np.ndarray, who: str) -> np.ndarray:
        if not self._closes(q):
            off = float(self._defect(self.theta(q)))
            raise AssumptionError(
                f"{who}: the nearest position leaves the loop open by {off:.3g}; begin elsewhere, or with `solve`"
            )
        return q

    # velocity and acceleration

    def screws(self, q: ArrayLike) -> np.ndarray:
        """The twists [w; v] that each coordinate's unit rate gives, in the first frame: shape (..., 6, nq).

        Their sum with the rates of a closed loop is zero.
        """
        S = self._screws(self.walk(self.theta(q)))
        S = np.broadcast_to(S, (*np.asarray(q).shape[:-1], 6, self.nq)) / self._scale
        return S * np.repeat([1.0, self._length], 3)[:, None]

    def mobility(self, q: ArrayLike) -> int:
        """How many freedoms the closed loop has at q: coordinates less the rank of their screws."""
        q = self._closed(self._coordinates("mobility", q), "mobility")
        s = np.linalg.svd(self._screws(self.walk(self.theta(q))), compute_uv=False)
        return self.nq - int((s > RANK * s[0]).sum())

    def velocity(self, q: ArrayLike, rate: float = 1.0) -> np.ndarray:
        """Rates of all coordinates from that of the input:  sum of s_k v_k = 0, shape (nq,).

        Raises
        ------
        DualDivisionError
            In a dead centre, or where the loop has other freedoms beside the input.
        AssumptionError
            If the loop is not closed, or does not move.
        """
        q = self._closed(self._coordinates("velocity", q), "velocity")
        return self._resolved(q, self._screws(self.walk(self.theta(q))), np.zeros(6), rate)

    def acceleration(self, q: ArrayLike, rate: float = 1.0, acceleration: float = 0.0) -> np.ndarray:
        """Accelerations of all coordinates, shape (nq,):

            sum of s_k a_k + V_{k-1} x s_k v_k = 0,    V_{k-1} = sum of s_j v_j before k

        since a screw carried by the joints before it turns with their twist.
        """
        q = self._closed(self._coordinates("acceleration", q), "acceleration")
        S = self._screws(self.walk(self.theta(q)))
        v = self._resolved(q, S, np.zeros(6), rate) / self._scale
        V, bias = np.zeros(6), np.zeros(6)
        for k in range(self.nq):
            s = S[:, k] * v[k]
            bias += np.concatenate((np.cross(V[:3], s[:3]), np.cross(V[:3], s[3:]) + np.cross(V[3:], s[:3])))
            V += s
        return self._resolved(q, S, bias, acceleration)

    def _resolved(self, q: np.ndarray, S: np.ndarray, bias: np.ndarray, driven: float) -> np.ndarray:
        """x with S x + bias = 0 and the given value of the input."""
        free = S[:, self._free]
        s = np.linalg.svd(free, compute_uv=False)
        at = f"{self.names[self.driven]} = {q[self.driven]:.9g}"
        if s.size and (s.size < free.shape[1] or s[-1] <= RANK * s[0]):
            raise DualDivisionError(
                f"{at}: the input does not fix the velocities: a dead centre, or freedoms of the loop beside the input"
            )
        right = -(S[:, self.driven] * driven / self._scale[self.driven] + bias)
        x, *_ = np.linalg.lstsq(free, right, rcond=None)
        if np.abs(free @ x - right).max() > 1e-6 * max(1.0, float(np.abs(right).max())):
            raise AssumptionError(f"{at}: the loop closes here, but its links do not let it move")
        full = np.full(self.nq, float(driven))
        full[self._free] = x * self._scale[self._free]
        return full

    # coordinates

    def coordinates(self, theta: Sequence[Dual]) -> np.ndarray:
        """The coordinates of dual angles, shape (nq,)."""
        parts = [(float(t.real - o.real), float(t.dual - o.dual)) for t, o in zip(theta, self.offsets, strict=True)]
        return np.array(
            [parts[i][0 if turns else 1] for i, (turns, _) in zip(self._joint_of, self._units, strict=True)]
        )

    def _position(self, q: np.ndarray) -> LoopPosition:
        theta = tuple(Dual(float(t.real), float(t.dual)) for t in self.theta(q))
        return LoopPosition(theta, float(self._defect(theta)))

    def _coordinates(self, who: str, q: Any) -> np.ndarray:
        x = numbers(f"{who}: q", q)
        if x.shape[-1:] != (self.nq,):
            raise ShapeError(f"{who}: q of shape (..., {self.nq}) expected ({', '.join(self.names)}), got {x.shape}")
        finite(f"{who}: q", x)
        return x

    def _wrapped(self, q: np.ndarray) -> np.ndarray:
        """Angles in (-pi, pi], but those of screws, whose turns are not the same position, and the input's."""
        turns = (self._units == (1.0, 0.0)).all(axis=1)
        turns[self.driven] = False
        return np.where(turns, q - 2 * np.pi * np.ceil((q - np.pi) / (2 * np.pi)), q)

    def _equations(self, v: Vector3) -> np.ndarray:
        """A dual vector as six real numbers, its moment in lengths of the loop: (..., 6)."""
        parts = [x.real for x in v] + [x.dual / self._length for x in v]
        return np.stack(np.broadcast_arrays(*(np.asarray(float(x) if np.ndim(x) == 0 else x) for x in parts)), axis=-1)

    def _screws(self, walk: Sequence[Matrix3]) -> np.ndarray:
        axes = _axes(walk)
        columns = [
            self._equations(axes[i] * Dual(float(turn), float(slide))) * scale
            for i, (turn, slide), scale in zip(self._joint_of, self._units, self._scale, strict=True)
        ]
        return np.stack(np.broadcast_arrays(*columns), axis=-1)


def _axes(walk: Sequence[Matrix3]) -> list[Vector3]:
    return [Vector3(*(row.z for row in M.rows)) for M in walk[:-1]]
