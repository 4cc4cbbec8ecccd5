"""Right code whose answers are disturbed in ways that no hypothesis covers: nothing can be named, only located."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import dualpin as dp
from dualpin.crosscheck.subjects import QUESTIONS

Disturbance = Callable[..., np.ndarray]


def _entries(seed: int, shape: tuple[int, ...], share: float = 1.0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.where(rng.random(shape) < share, rng.normal(size=shape), 0.0)


def _weights(M: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    A = _entries(1, M.shape)
    return M + 0.1 * (A + A.T) * np.cos(q[0] + 2 * q[1])


def _one_moment(tau: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    return tau * np.where(np.arange(tau.shape[-1]) == 2, np.cos(q[2]), 1.0)


def _entries_mixed(x: np.ndarray, *_: Any) -> np.ndarray:
    order = np.arange(x.size)
    np.random.default_rng(2).shuffle(order)
    return x.ravel()[order].reshape(x.shape)


def _two_entries_exchanged(J: np.ndarray, *_: Any) -> np.ndarray:
    out = J.copy()
    out[1, 2], out[4, 0] = J[4, 0], J[1, 2]
    return out


def _noise(x: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    return x * (1 + 0.3 * np.sin(1e4 * q.sum() + np.arange(x.size)).reshape(x.shape))


def _swaying(H: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    out = H.copy()
    out[:3, 3] += 0.02 * np.array([np.sin(q[0] * q[1]), np.cos(3 * q[2]), q[1] ** 2])
    return out


def _twisted(H: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    out, x = H.copy(), 0.1 * np.sin(2 * q[1] + q[0])
    out[:3, :3] = np.array([[np.cos(x), -np.sin(x), 0], [np.sin(x), np.cos(x), 0], [0, 0, 1]]) @ H[:3, :3]
    return out


def _breathing(x: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    return x * (1 + 0.1 * np.sin(q[0] + q[1] * q[2]))


def _coupled(x: np.ndarray, q: np.ndarray, v: np.ndarray, *_: Any) -> np.ndarray:
    out = x.copy()
    out[1] += 0.3 * v[0] * v[2] * np.sin(q[1])
    return out


def _random_in_velocity(C: np.ndarray, q: np.ndarray, v: np.ndarray, *_: Any) -> np.ndarray:
    return C + 0.1 * _entries(3, C.shape) * v.sum()


def _leaning(g: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    return g + 0.2 * _entries(4, g.shape) * np.sin(q[0] + q[1])


def _wandering(c: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    return c + 0.01 * np.array([np.sin(q[0] * q[2]), np.cos(q[1]), q[0] ** 2])


def _lively(T: np.ndarray, q: np.ndarray, v: np.ndarray, *_: Any) -> np.ndarray:
    return T + 0.1 * v[0] ** 2 * np.cos(q[1]) ** 2


def _one_entry(x: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    out = x.copy()
    out[1, 0] *= 1 + np.sin(q[0])
    return out


def _rows_leak(A: np.ndarray, q: np.ndarray, *_: Any) -> np.ndarray:
    out = A.copy()
    out[3] += 0.1 * q[0] * A[4]
    return out


DISTURBED: dict[str, tuple[Disturbance, tuple[str, ...]]] = {
    "a matrix that turns with q is added to M": (_weights, ("crba",)),
    "the moment of one joint is multiplied by cos q": (_one_moment, ("rnea",)),
    "the moment of one joint is multiplied by cos q, in all forces": (_one_moment, ("rnea", "bias", "gravity")),
    "entries of Jacobians are mixed": (_entries_mixed, ("jacobian",)),
    "two entries of Jacobians are exchanged": (_two_entries_exchanged, ("jacobian",)),
    "noise in the forces": (_noise, ("rnea",)),
    "noise in M": (_noise, ("crba",)),
    "poses sway": (_swaying, ("fk",)),
    "poses twist": (_twisted, ("fk",)),
    "the rate of the Jacobian breathes": (_breathing, ("jacobian_dot",)),
    "forces breathe": (_breathing, ("rnea", "bias")),
    "a product of velocities is added to a force": (_coupled, ("bias", "rnea")),
    "C has a random part in proportion to velocities": (_random_in_velocity, ("coriolis",)),
    "gravity's torques lean": (_leaning, ("gravity",)),
    "the centre of mass wanders": (_wandering, ("com",)),
    "the kinetic energy has a term of its own": (_lively, ("kinetic_energy",)),
    "an entry of M^-1 breathes": (_one_entry, ("minv",)),
    "an entry of M breathes": (_one_entry, ("crba",)),
    "a row of the momentum leaks into another": (_rows_leak, ("centroidal_momentum_matrix",)),
    "accelerations breathe": (_breathing, ("aba",)),
}
"""What is done to the answers to some terms."""


def _not_moved(q: np.ndarray) -> np.ndarray:
    return np.where(np.arange(len(q)) == 1, 0.0, q)


def _slipping(q: np.ndarray) -> np.ndarray:
    return q + 0.05 * np.sin(3 * q)


def _leaking(q: np.ndarray) -> np.ndarray:
    return q + 0.1 * np.roll(q, 1)


def _geared(q: np.ndarray) -> np.ndarray:
    return np.where(np.arange(len(q)) == 2, 1.1 * q, q)


MOVED: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "a joint does not move": _not_moved, "joints slip": _slipping, "joints move their neighbours": _leaking,
    "positions of one joint are off by a gear": _geared,
}  # fmt: skip
"""What is done to the positions, for all terms."""


def perturbed(robot: dp.Robot, what: str) -> dict[str, Callable[..., np.ndarray]]:
    """A subject of dualpin's answers, some of them disturbed, or all of displaced positions."""
    disturb, disturbed = DISTURBED.get(what, (None, ()))
    move = MOVED.get(what, lambda q: q)

    def answering(term: str) -> Callable[..., np.ndarray]:
        question = QUESTIONS[term]
        function = getattr(dp, question.source if term != "fk" else "fk")

        def answer(*given: Any) -> np.ndarray:
            states, frame = (given[:-1], given[-1]) if question.framed else (given, None)
            options = {**question.options("local_world_aligned"), "frame": frame} if question.framed else {}
            x = np.asarray(function(robot, move(states[0]), *states[1:], **options), float)
            return disturb(x, *states) if disturb and term in disturbed else x

        return answer

    return {term: answering(term) for term in QUESTIONS if term not in LEFT_OUT}


LEFT_OUT = {"rnea_f_ext", "aba_f_ext", "joint_torque_regressor", "rnea_derivatives", "aba_derivatives"}
"""Terms that are not one array of one state."""
