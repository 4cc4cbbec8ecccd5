"""Matrices half filled or turned round, other factorisations, and answers of another sign or precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ...subjects.convention import BASE_V
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
    "diagonal_twice": (
        "entries on the diagonal are counted twice", lambda x: x * (1 + np.eye(x.shape[-1])), ("crba", "minv"),
        "add what is mirrored off the diagonal alone",
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
    found = []
    for k, (says, f, terms, fix) in SQUARE.items():
        one = replace(h, key=k, says=says, terms=terms, fix=fix)
        found.append(replace(one, place="answer", act=_answer(f)))
        if "crba" in terms:  # and M is inverted as it is
            act = partial(_of_matrix, partial(_changed, f))
            found.append(replace(one, terms=("minv", "aba"), place="formula", act=act, variant="inverted", cost=1.1))
    return found


def _of_matrix(change: Callable[[View, np.ndarray], np.ndarray], view: View, term: str) -> np.ndarray:
    """What is made of another M."""
    M, s = change(view, view.compute("crba")), view.states
    if term == "crba":
        return M
    if term == "minv":
        return np.linalg.inv(M)
    if term == "kinetic_energy":
        return np.asarray(0.5 * (s["v"] * product(M, s["v"])).sum(-1))
    return np.linalg.solve(M, (s["tau"] - view.compute("bias"))[..., None])[..., 0]


def _changed(f: Callable[[np.ndarray], np.ndarray], view: View, M: np.ndarray) -> np.ndarray:
    return f(M)


def _in_every_column(term: str, view: View, M: np.ndarray) -> np.ndarray:
    return M + view.compute(term)[..., None]


@proposer(
    "crba_with_gravity", "gravity, or all of the bias, is in every column of M",
    "M e_k = rnea(q, 0, e_k) - rnea(q, 0, 0)",
)  # fmt: skip
def crba_with_gravity(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(
            h, says=f"{term} is in every column of M", terms=("crba", "minv", "kinetic_energy", "aba"), place="formula",
            act=partial(_of_matrix, partial(_in_every_column, term)),
        )
        for term in ("gravity", "bias")
    ]  # fmt: skip


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


Parts = dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]]
SYMBOLS: Parts = {
    "dM/dt": lambda rate, B: rate, "d(M v)/dq": lambda rate, B: B, "(d(M v)/dq)^T": lambda rate, B: transposed(B)
}  # fmt: skip
"""What Christoffel's symbols are made of: C is half of the first and the second, less half of the third."""


@proposer(
    "coriolis_symbols", "Christoffel's symbols lack a term, or one has another sign, factor or index",
    "C_ij = (1/2) sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) v_k",
)  # fmt: skip
def coriolis_symbols(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """How often each part is counted is estimated, and taken for a multiple of one half."""

    def made(counts: Sequence[float]) -> Hypothesis:
        def act(view: View, term: str, C: np.ndarray) -> np.ndarray:
            rate, B = C + transposed(C), _momentum_by_q(view)
            return np.asarray(sum(k * part(rate, B) for k, part in zip(counts, SYMBOLS.values(), strict=True)))

        words = " + ".join(f"{k:g} {name}" for k, name in zip(counts, SYMBOLS, strict=True) if k).replace("+ -", "- ")
        return replace(
            h, terms=("coriolis",), place="change", act=act, values=f"{_miscounted(counts)}, C = {words}", cost=1.1
        )

    x = case.observed.get("coriolis")
    if x is None or not np.isfinite(x).all():
        return []
    zero, *parts = case.predictions("coriolis", [(made(k),) for k in ((0.0, 0.0, 0.0), *np.eye(3).tolist())])
    if zero is None or zero.shape != x.shape or any(p is None for p in parts):
        return []
    A = np.stack([(p - zero).ravel() for p in parts if p is not None], axis=1)
    counts = np.round(2 * np.linalg.lstsq(A, (x - zero).ravel(), rcond=None)[0]) / 2
    return [made(counts.tolist())] if counts.any() and np.abs(counts).max() <= 2 else []


def _miscounted(counts: Sequence[float]) -> str:
    """Which of the terms of Christoffel's sum counts otherwise, in words."""
    ratios = {name: 2 * k * sign for (name, sign), k in zip(TERMS_OF_SYMBOLS.items(), counts, strict=True)}
    if set(ratios.values()) == {2.0}:
        return "without the factor 1/2"
    words = {0.0: "is left out", -1.0: "has the other sign", 2.0: "is counted twice"}
    wrong = {name: words.get(k, f"is counted {k:g} times") for name, k in ratios.items() if k != 1}
    return " and ".join(f"{name} {how}" for name, how in wrong.items()) or "with all its terms"


TERMS_OF_SYMBOLS = {"dM_ij/dq_k": 1.0, "dM_ik/dq_j": 1.0, "dM_jk/dq_i": -1.0}
"""The same parts as sums over k, and their signs."""


SQUARES = {
    "centrifugal terms, products of a velocity with itself, are left out": (0.0, 1.0),
    "centrifugal terms, products of a velocity with itself, are counted twice": (2.0, 1.0),
    "mixed terms, products of two velocities, are left out": (1.0, 0.0),
    "mixed terms, products of two velocities, are counted twice": (1.0, 2.0),
    "mixed terms, products of two velocities, are counted half": (1.0, 0.5),
}
"""How often each kind counts."""
MOST_SYMBOLS = 12
"""Degrees of freedom up to which the symbols are found one velocity at a time."""


@proposer(
    "coriolis_squares", "centrifugal or mixed terms, v_k^2 or v_j v_k, count another number of times",
    "h_i = sum_jk c_ijk v_j v_k, over all j and k",
)  # fmt: skip
def coriolis_squares(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """Codes that list centrifugal and Coriolis terms apart: c_ikk v_k^2 beside 2 c_ijk v_j v_k."""
    if case.robot.nv > MOST_SYMBOLS:
        return []

    def squares(view: View) -> np.ndarray:
        """c_ikk v_k, (n, i, k)."""
        v, unit = view.states["v"], np.eye(case.robot.nv)
        columns = [view.compute("coriolis", v=np.broadcast_to(e, v.shape))[:, :, k] for k, e in enumerate(unit)]
        return np.stack(columns, axis=-1) * v[:, None, :]

    out = []
    for says, (own, mixed) in SQUARES.items():

        def matrix(view: View, term: str, C: np.ndarray, own: float = own, mixed: float = mixed) -> np.ndarray:
            return mixed * C + (own - mixed) * squares(view)

        def force(view: View, own: float = own, mixed: float = mixed) -> np.ndarray:
            C = (mixed - 1) * view.compute("coriolis") + (own - mixed) * squares(view)
            return product(C, view.states["v"])

        out.append(replace(h, says=says, terms=("coriolis",), place="change", act=matrix, cost=1.1))
        out.append(replace(h, says=says, terms=FORCED, place="force", act=force, cost=1.1))
    return out


def _momentum_by_q(view: View) -> np.ndarray:
    """d(M v)/dq at a given v, in its tangent space."""
    from ....call import evaluate as call

    s, zero = view.states, np.zeros_like(view.states["v"])

    def make() -> np.ndarray:
        robot = view.case.robot if view.description is view.case.description else view.robot
        by_q = [
            call(robot, "rnea_derivatives", {"q": s["q"], "v": zero, "a": a}, engine="numpy")[:, 0]
            for a in (s["v"], zero)
        ]
        return np.asarray(by_q[0] - by_q[1])

    return view.once("d(M v)/dq", make)


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


def _diagonal(K: np.ndarray) -> np.ndarray:
    return K * np.eye(K.shape[-1])


def _unit(K: np.ndarray) -> np.ndarray:
    """The inverse of L with ones on its diagonal."""
    L = np.linalg.inv(K)
    return np.asarray(np.linalg.inv(L - _diagonal(L) + np.eye(L.shape[-1])))


FACTORS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "stand in the other order (L^-1 L^-T of M = L L^T)": lambda K: K @ transposed(K),
    "are L^-1 twice (M = L L^T)": lambda K: K @ K,
    "are L^-T twice (M = L L^T)": lambda K: transposed(K @ K),
    "lack L^-T: L^-1 alone (M = L L^T)": lambda K: K,
    "lack L^-1: L^-T alone (M = L L^T)": transposed,
    "are D^-1 L^-1, D the diagonal of L: the second substitution reads L, not L^T": lambda K: _diagonal(K) @ K,
    "are L^-T D^-1, D the diagonal of L: the first substitution reads L^T, not L": lambda K: (
        transposed(K) @ _diagonal(K)
    ),
    "are found by a second substitution that does not divide by the diagonal of L": lambda K: transposed(_unit(K)) @ K,
    "are found by a first substitution that does not divide by the diagonal of L": lambda K: transposed(K) @ _unit(K),
}
"""What may be made of K = L^-1, which depends on the order of the columns: these act on the subject's."""


@proposer("inverse_factors", "the factors of the inverse are wrong", "M^-1 = L^-T L^-1, with M = L L^T")
def inverse_factors(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            M = np.linalg.inv(x) if term == "minv" else view.case.predict("crba")
            if M is None:
                raise ValueError("no mass matrix")
            inverse = FACTORS[words](np.linalg.inv(np.linalg.cholesky(M)))
            return inverse if term == "minv" else product(inverse, product(M, x))

        says = f"the factors of the inverse {words}"
        return replace(h, says=says, terms=("minv", "aba"), place="answer", act=act)

    return [one(words) for words in FACTORS]


@rule(
    "uncoupled_base", "the blocks of M between the base and the joints are zero", "fill them", ("crba",), "answer",
    when=lambda case: case.floating,
)  # fmt: skip
def uncoupled_base(view: View, term: str, x: np.ndarray) -> np.ndarray:
    of_base = np.isin(view.layout.how.v, BASE_V)
    return np.asarray(x * (of_base[:, None] == of_base[None, :]))


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
