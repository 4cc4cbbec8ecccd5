"""Orientations of links, as matrices or as unit quaternions: how they are made, multiplied and turn vectors.

    matrices:     R_j = R_p R(rpy) R(q)          x' = R x
    quaternions:  Q_j = Q_p Q(rpy) Q(q)          x' = Q x Q*,  or  x + 2 w (u x x) + 2 u x (u x x)

Arrays have the axes (runs, samples, ...), see `Steps.together`.

References: Siciliano et al., Robotics (2009), section 2.6; Kuipers, Quaternions and Rotation Sequences (1999),
chapter 5; Shepperd, Quaternion from Rotation Matrix, Journal of Guidance and Control 1 (1978).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import quaternions, rotations, transposed
from ..description import fixed_axes
from .arrays import cross
from .steps import Steps
from .turns import ONE, Turn, of_quaternion, rodrigues

Rpy = Callable[[Steps, np.ndarray, str], np.ndarray]
Quaternion = Callable[[Steps, np.ndarray, np.ndarray, str], np.ndarray]
ORIGIN, INERTIAL = "of joints", "of <inertial>"
"""Whose roll, pitch and yaw it is."""


@dataclass(frozen=True)
class Ways:
    """By matrices: of joints, of roll, pitch and yaw (by default as the file was read), of quaternions."""

    turn: Turn = rodrigues
    rpy: Rpy | None = None
    quaternion: Quaternion = of_quaternion
    own: Steps | None = None
    """Where slips are made in rotations alone."""
    in_world: tuple[bool, bool] = (False, False)
    """Whether a floating base's angular and linear velocity are given in world axes: nothing turns them then."""

    def of_rpy(self, steps: Steps, rpy: np.ndarray, rotation: np.ndarray, whose: str = ORIGIN) -> np.ndarray:
        """Of an origin, by the way of this formulation where it is that of the file's angles."""
        if self.rpy is None or np.abs(rotation - fixed_axes(rpy)).max() > 1e-14:
            return rotation[None, None]
        return self.rpy(steps, rpy, whose)

    @property
    def placing(self) -> Ways:
        """The way in which links on fixed joints are placed on their bodies when a file is read."""
        return self

    def placed(self, A: np.ndarray) -> np.ndarray:
        """What was made so, in this way."""
        return A

    def of_axis(self, steps: Steps, axis: np.ndarray, q: np.ndarray) -> np.ndarray:
        return self.turn(steps, axis, q)

    def of_quaternion(self, steps: Steps, w: np.ndarray, u: np.ndarray, whose: str) -> np.ndarray:
        return self.quaternion(steps, w, u, whose)

    def start(self) -> np.ndarray:
        """Of the root."""
        return ONE[None, None]

    def then(self, A: np.ndarray, B: np.ndarray) -> np.ndarray:
        """First A, then B in the axes that A made."""
        return np.asarray(A @ B)

    def inverse(self, A: np.ndarray) -> np.ndarray:
        return transposed(A)

    def matrix(self, A: np.ndarray) -> np.ndarray:
        """That turns vectors."""
        return A

    def seen(self, A: np.ndarray, unit: bool) -> np.ndarray:
        """The orientation in a pose that is returned, `unit` if quaternions are made unit ones before."""
        return A


PLAIN = Ways()


@dataclass(frozen=True)
class Quaternions(Ways):
    """By quaternions w x y z, with slips in them alone.

    Attributes
    ----------
    products : bool
        Whether vectors are turned by products of quaternions, not by cross products.
    converted : bool
        Whether the quaternions of origins are made of matrices, not of three angles.
    """

    products: bool = False
    converted: bool = False

    def of_rpy(self, steps: Steps, rpy: np.ndarray, rotation: np.ndarray, whose: str = ORIGIN) -> np.ndarray:
        read = not rpy.any() or np.abs(rotation - fixed_axes(rpy)).max() > 1e-14
        if self.converted or read:
            return self._of_matrix(rotation[None, None], whose)
        x, y, z = (self._about(ONE[k][None, None], rpy[k][None, None], whose) for k in range(3))
        others = {"in the order of pitch, roll and yaw": lambda: self.then(z, self.then(x, y))}
        others["in the other order"] = lambda: self.then(x, self.then(y, z))
        made = self.then(z, self.then(y, x))
        return np.asarray(self.steps.pick("the product of the quaternions of roll, pitch and yaw", made, **others))

    @property
    def steps(self) -> Steps:
        assert self.own is not None
        return self.own

    def start(self) -> np.ndarray:
        return np.eye(4)[0][None, None]

    @property
    def placing(self) -> Ways:
        return PLAIN if self.converted else self

    def placed(self, A: np.ndarray) -> np.ndarray:
        return self._of_matrix(A, ORIGIN) if self.converted else A

    def of_axis(self, steps: Steps, axis: np.ndarray, q: np.ndarray) -> np.ndarray:
        return self._about(axis, q, "of a joint's angle")

    def of_quaternion(self, steps: Steps, w: np.ndarray, u: np.ndarray, whose: str) -> np.ndarray:
        return np.concatenate([w[..., None], u], -1)

    def _about(self, axis: np.ndarray, q: np.ndarray, whose: str) -> np.ndarray:
        """(cos q/2, sin q/2 a)."""
        pick = self.steps.pick
        others = {"the whole angle, which turns twice as far": q, "a quarter, which turns half as far": q / 4}
        half = pick(f"the half-angle in a quaternion: {whose}", q / 2, **others)
        c, s = np.cos(half)[..., None], np.sin(half)[..., None]
        vector = {"of the other sign": -s * axis, "q/2 a": half[..., None] * axis}
        vector = pick(f"the vector part of a quaternion: {whose}", s * axis, **vector)
        return np.asarray(
            pick(f"cosine and sine in a quaternion: {whose}", _joined(c, vector), exchanged=_joined(s, c * axis))
        )

    def _of_matrix(self, R: np.ndarray, whose: str) -> np.ndarray:
        """The quaternion of a rotation matrix, by the largest of its four entries."""
        Q = quaternions(R)
        Q = np.where(np.take_along_axis(Q, np.abs(Q).argmax(-1)[..., None], -1) < 0, -Q, Q)
        largest = np.abs(Q).argmax(-1)[..., None]
        wrong: dict[str, np.ndarray] = {}
        for signs, name in (((1, 2, 3), "the vector part"), *(((k,), "wxyz"[k]) for k in range(4))):
            other = Q * [-1.0 if k in signs else 1.0 for k in range(4)]
            wrong[f"that with the other sign of {name}"] = other
            for k in range(4):
                here = f"where {'wxyz'[k]} is the largest"
                wrong[f"that with the other sign of {name}, {here}"] = np.where(largest == k, other, Q)
        for a, b in ((1, 2), (1, 3), (2, 3)):
            to = [0, 1, 2, 3]
            to[a], to[b] = b, a
            wrong[f"that with {'wxyz'[a]} and {'wxyz'[b]} exchanged"] = Q[..., to]
        wrong["with the vector part not halved"] = Q * [1.0, 2.0, 2.0, 2.0]
        wrong["with the scalar last"] = Q[..., [1, 2, 3, 0]]
        return np.asarray(self.steps.pick(f"the quaternion of a rotation matrix: {whose}", Q, **wrong))

    def then(self, A: np.ndarray, B: np.ndarray) -> np.ndarray:
        """Hamilton's product."""
        a, u, b, v = A[..., :1], A[..., 1:], B[..., :1], B[..., 1:]
        site = "the product of two quaternions"
        scalar = self.steps.add(f"{site}: its scalar", **{"a0 b0": a * b, "-a . b": -(u * v).sum(-1, keepdims=True)})
        terms = {"a0 b": a * v, "b0 a": b * u, "a x b (the order of the factors)": cross(u, v)}
        vector = self.steps.add(f"{site}: its vector", **terms)
        return _joined(scalar, vector)

    def inverse(self, A: np.ndarray) -> np.ndarray:
        return A * [1.0, -1.0, -1.0, -1.0]

    def matrix(self, A: np.ndarray) -> np.ndarray:
        """Its columns are the turned axes."""
        if not self.products:
            u, w = cross_matrix(A[..., 1:]), A[..., :1, None]
            terms = {"v": ONE + 0 * u, "2 w u x v": 2 * w * u, "2 u x (u x v)": 2 * u @ u}
            return np.asarray(self.steps.add("a vector turned by a quaternion", **terms))
        back = self.inverse(A)
        wrong = {"not conjugated": A, "with the other sign": -back}
        wrong |= {f"not negated in {'wxyz'[k]}": back * (1.0 - 2.0 * np.eye(4)[k]) for k in (1, 2, 3)}
        back = self.steps.pick("the conjugate by which vectors are turned", back, **wrong)
        columns = []
        for k in (1, 2, 3):
            e = np.eye(4)[k] + 0 * A
            turned = self.then(self.then(A, e), back)
            other = {"Q* v Q, the other way round": lambda e=e: self.then(self.then(back, e), A)}
            columns.append(self.steps.pick("the product that turns a vector", turned, **other)[..., 1:])
        lead = np.broadcast_shapes(*(c.shape for c in columns))
        return np.stack([np.broadcast_to(c, lead) for c in columns], -1)

    def seen(self, A: np.ndarray, unit: bool) -> np.ndarray:
        return rotations(A / np.linalg.norm(A, axis=-1, keepdims=True) if unit else A)


def _joined(scalar: np.ndarray, vector: np.ndarray) -> np.ndarray:
    lead = np.broadcast_shapes(scalar.shape[:-1], vector.shape[:-1])
    return np.concatenate([np.broadcast_to(scalar, (*lead, 1)), np.broadcast_to(vector, (*lead, 3))], -1)
