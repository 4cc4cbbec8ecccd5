"""Analytical Jacobians in the place of geometric ones: rates of angles or quaternions, not angular velocities.

References: Siciliano et al., Robotics (2009), section 3.6; Murray, Li and Sastry (1994), section 2.4.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, quaternions, transposed
from ..case import Case, View
from ..hypothesis import Hypothesis
from .register import proposer

ONE = np.eye(3)
Rates = Callable[[np.ndarray], np.ndarray]
"""Of rotations (..., 3, 3): the matrix that makes rates of an angular velocity in world axes."""


def _angles(order: str, R: np.ndarray) -> np.ndarray:
    """The angles (..., 3) of R = R_a R_b R_c, a, b, c the axes in that order."""
    i, j, k = ("xyz".index(a) for a in order)
    if i == k:  # as z y z
        k = 3 - i - j
        s = 1.0 if (j - i) % 3 == 1 else -1.0
        first, last = np.arctan2(R[..., j, i], -s * R[..., k, i]), np.arctan2(R[..., i, j], s * R[..., i, k])
        return np.stack([first, np.arccos(np.clip(R[..., i, i], -1, 1)), last], -1)
    s = 1.0 if (j - i) % 3 == 1 else -1.0
    first, last = np.arctan2(-s * R[..., j, k], R[..., k, k]), np.arctan2(-s * R[..., i, j], R[..., i, i])
    return np.stack([first, np.arcsin(np.clip(s * R[..., i, k], -1, 1)), last], -1)


def _turned(axis: int, angles: np.ndarray) -> np.ndarray:
    K = cross_matrix(ONE[axis])
    s, c = np.sin(angles)[..., None, None], np.cos(angles)[..., None, None]
    return np.asarray(ONE + s * K + (1 - c) * (K @ K))


def euler_matrix(order: str, R: np.ndarray) -> np.ndarray:
    """E with w = E (rates of the angles in R = R_a R_b R_c): its columns are e_a, R_a e_b, R_a R_b e_c."""
    i, j, k = ("xyz".index(a) for a in order)
    first, middle, _ = np.moveaxis(_angles(order, R), -1, 0)
    A = _turned(i, first)
    B = A @ _turned(j, middle)
    return np.stack([np.broadcast_to(ONE[i], A.shape[:-1]), A[..., j], B[..., k]], -1)


def _euler(order: str, f: Callable[[np.ndarray], np.ndarray], reverse: bool = False) -> Rates:
    def rates(R: np.ndarray) -> np.ndarray:
        E = f(euler_matrix(order, R))
        return E[..., ::-1, :] if reverse else E

    return rates


def rotation_vector(R: np.ndarray) -> np.ndarray:
    """J^-1 with d(rotation vector)/dt = J^-1 w: 1 - [x] / 2 + (1/a^2 - (1 + cos a) / (2 a sin a)) [x]^2."""
    u = quaternions(R)
    u = np.where(u[..., :1] < 0, -u, u)
    length = np.linalg.norm(u[..., 1:], axis=-1)
    a = 2 * np.arctan2(length, u[..., 0])
    x = u[..., 1:] * (a / np.maximum(length, 1e-300))[..., None]
    a = np.maximum(a, 1e-6)
    K, k = cross_matrix(x), 1 / a**2 - (1 + np.cos(a)) / (2 * a * np.sin(a))
    return np.asarray(ONE - K / 2 + k[..., None, None] * (K @ K))


def _quaternion(factor: float) -> Rates:
    """Of the vector part: u' = (w 1 - [u]) omega / 2."""

    def rates(R: np.ndarray) -> np.ndarray:
        q = quaternions(R)
        return np.asarray(factor * (q[..., 0, None, None] * ONE - cross_matrix(q[..., 1:])))

    return rates


ORDERS = {"roll, pitch and yaw": "zyx", "Euler's angles x y z": "xyz", "Euler's angles z y z": "zyz"}
RATES: dict[str, Rates] = {
    "rates of a rotation vector": rotation_vector, "rates of a quaternion's vector part": _quaternion(0.5),
    "rates of a quaternion's vector part, twice": _quaternion(1.0),
}  # fmt: skip
for _words, _order in ORDERS.items():
    RATES |= {
        f"rates of {_words}": _euler(_order, np.linalg.inv, _order == "zyx"),
        f"rates of {_words}, in the other order": _euler(_order, np.linalg.inv, _order != "zyx"),
        f"multiplied by E of {_words}, which makes angular velocities of rates": _euler(_order, lambda E: E),
        f"multiplied by E^T of {_words}": _euler(_order, transposed),
    }


@proposer(
    "analytical_jacobian", "angular rows are rates of angles or of a quaternion, not the angular velocity",
    "multiply them by the matrix E that makes angular velocities of these rates",
)  # fmt: skip
def analytical(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """In the place of the Jacobian at the frame, in world axes."""

    def one(words: str) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            E, out = RATES[words](view.compute("fk")[..., :3, :3]), x.copy()
            out[:, :, :3] = product(E, x[:, :, :3]) if x.ndim == 3 else E @ x[:, :, :3]
            return out

        return replace(h, terms=("jacobian", "frame_velocity"), place="change", act=act, values=words, cost=1.1)

    return [one(words) for words in RATES] if case.how.reference == "local_world_aligned" else []
