"""Matrices half filled or turned round, other factorisations, and answers of another sign or precision."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.layout import product, transposed
from ..case import Case, View
from ..hypothesis import Hypothesis
from .register import ALL, FORCED, proposer, rule

# --- matrices ------------------------------------------------------------------------------------


def _answer(f: Callable[[np.ndarray], np.ndarray]) -> Callable[..., np.ndarray]:
    return lambda view, term, x: f(x)


SQUARE: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray], tuple[str, ...], str]] = {
    "upper": ("only the upper triangle is filled", np.triu, ("crba", "minv"), "fill the lower triangle by symmetry"),
    "lower": ("only the lower triangle is filled", np.tril, ("crba", "minv"), "fill the upper triangle by symmetry"),
    "diagonal": (
        "only the diagonal is filled", lambda x: x * np.eye(x.shape[-1]), ("crba", "minv"), "fill all of the matrix"
    ),
    "transposed": ("the matrix is transposed", transposed, ("coriolis",), "transpose it"),
    "coriolis_symmetric": (
        "only the symmetric part, dM/dt / 2", lambda x: (x + transposed(x)) / 2, ("coriolis",), "C also has a skew part"
    ),
    "coriolis_rate": ("dM/dt itself", lambda x: x + transposed(x), ("coriolis",), "C v is dM/dt v - (1/2) d(v M v)/dq"),
    "coriolis_skew": (
        "only the skew part", lambda x: (x - transposed(x)) / 2, ("coriolis",), "C also has dM/dt / 2"
    ),
}  # fmt: skip


@proposer(
    "upper, lower, ...", "the matrix is half filled or turned round", "fill all of it",
    {key: says for key, (says, *_) in SQUARE.items()},
)  # fmt: skip
def square(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(h, key=k, says=says, terms=terms, place="answer", act=_answer(f), fix=fix)
        for k, (says, f, terms, fix) in SQUARE.items()
    ]


@rule(
    "coriolis_other", "another factorisation: dM/dt - (1/2) (d(M v)/dq)^T",
    "nothing where C v is used; use Christoffel's symbols where dM/dt = C + C^T must hold", ("coriolis",), "change",
)  # fmt: skip
def coriolis_other(view: View, term: str, C: np.ndarray) -> np.ndarray:
    return C + transposed(C) - 0.5 * transposed(_momentum_by_q(view))


@rule(
    "coriolis_other",
    "another factorisation: d(M v)/dq - (1/2) (d(M v)/dq)^T",
    "nothing where C v is used; use Christoffel's symbols where dM/dt = C + C^T must hold",
    ("coriolis",),
    "change",
)
def coriolis_momentum(view: View, term: str, C: np.ndarray) -> np.ndarray:
    B = _momentum_by_q(view)
    return B - 0.5 * transposed(B)


SYMBOLS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "(dM/dt + d(M v)/dq) / 2": lambda rate, B: (rate + B) / 2,
    "(dM/dt + d(M v)/dq + (d(M v)/dq)^T) / 2": lambda rate, B: (rate + B + transposed(B)) / 2,
    "(dM/dt - (d(M v)/dq)^T) / 2": lambda rate, B: (rate - transposed(B)) / 2,
    "(dM/dt - d(M v)/dq + (d(M v)/dq)^T) / 2": lambda rate, B: (rate - B + transposed(B)) / 2,
    "d(M v)/dq": lambda rate, B: B,
    "(d(M v)/dq - (d(M v)/dq)^T) / 2": lambda rate, B: (B - transposed(B)) / 2,
    "dM/dt - d(M v)/dq / 2": lambda rate, B: rate - B / 2,
}


@proposer(
    "coriolis_symbols", "Christoffel's symbols lack a term, or one has another sign",
    "C_ij = (1/2) sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) v_k",
)  # fmt: skip
def coriolis_symbols(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str) -> Hypothesis:
        def act(view: View, term: str, C: np.ndarray) -> np.ndarray:
            return SYMBOLS[words](C + transposed(C), _momentum_by_q(view))

        return replace(h, terms=("coriolis",), place="change", act=act, values=words, cost=1.1)

    return [one(words) for words in SYMBOLS]


def _momentum_by_q(view: View) -> np.ndarray:
    """d(M v)/dq at a given v, in its tangent space."""
    from ....call import evaluate as call

    s, zero = view.states, np.zeros_like(view.states["v"])
    robot = view.case.robot if view.description is view.case.description else view.robot
    by_q = [
        call(robot, "rnea_derivatives", {"q": s["q"], "v": zero, "a": a}, engine="numpy")[:, 0] for a in (s["v"], zero)
    ]
    return np.asarray(by_q[0] - by_q[1])


@proposer(
    "same_cv", "another matrix with the same product C v",
    "nothing where only C v is used; where dM/dt - 2 C must be skew, C of Christoffel's symbols",
)  # fmt: skip
def other_products(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """And whether its symmetric part is right: dM/dt = C + C^T, as passivity needs."""
    C, right = case.observed.get("coriolis"), case.predict("coriolis")
    if C is None or right is None or C.shape != right.shape or not np.isfinite(C).all():
        return []
    off = C + transposed(C) - right - transposed(right)
    holds = bool(np.abs(off).max() <= case.tolerance * max(1.0, float(np.abs(right).max())))
    words = f"dM/dt = C + C^T {'holds' if holds else 'does not hold'} for the robot of the file"
    return [replace(h, terms=("coriolis",), place="relation", act=same_cv, values=words, cost=1.5)]


def same_cv(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    v = view.case.sent["v"]
    lacks = product(x - observed, v)
    return observed + lacks[..., None] * v[:, None, :] / (v**2).sum(-1)[:, None, None]


@rule(
    "coriolis_frozen", "that of the inertial frame, brought to the base's columns without the rate of the turning",
    "add P^T M dP/dt", ("coriolis",), "answer", when=lambda case: case.floating,
)  # fmt: skip
def coriolis_frozen(view: View, term: str, x: np.ndarray) -> np.ndarray:
    from ...subjects.layout import Layout

    C, M, s = view.compute("coriolis"), view.compute("crba"), view.states
    other = Layout(view.case.robot, replace(view.layout.how, angular="world", linear="origin"))
    P = other.matrices(s["q"], s["v"])[0] @ np.linalg.inv(view.layout.matrices(s["q"], s["v"])[0])
    return transposed(P) @ other.answer("coriolis", C, s, M) @ P


@rule(
    "sign",
    "the sign is reversed",
    "return the negative",
    ("gravity", *FORCED, "coriolis", "jacobian_dot", "potential_energy"),
    "answer",
)
def sign(view: View, term: str, x: np.ndarray) -> np.ndarray:
    return -x


@rule(
    "single_precision", "answers are rounded to single precision", "return arrays of doubles", ALL, "answer", cost=1.1
)
def answers_in_single_precision(view: View, term: str, x: np.ndarray) -> np.ndarray:
    return np.asarray(x.astype(np.float32), float)
