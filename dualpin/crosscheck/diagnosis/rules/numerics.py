"""Answers that are less precise than double arithmetic: few digits, finite differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ....functions import integrate
from ...subjects.layout import product, transposed
from ..case import Case, View
from ..hypothesis import Hypothesis
from .register import ALL, proposer

DIGITS = range(3, 10)


@proposer("few_digits", "answers are written with few digits", "write 17 significant digits")
def few_digits(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """What lies half-way between two of the numbers that can be written may go either way."""

    def one(n: int, words: str, unit: Callable[[np.ndarray], np.ndarray]) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
            step = unit(x)
            written = np.round(x / step) * step
            kept = np.abs(np.round(observed / step) * step - observed) <= 1e-12 * np.maximum(1.0, np.abs(observed))
            return np.where(kept & (np.abs(observed - x) <= 0.5001 * step), observed, written)

        return replace(h, place="relation", act=act, terms=ALL, values=f"{n} {words}", cost=1.2)

    def significant(n: int) -> Callable[[np.ndarray], np.ndarray]:
        return lambda x: 10.0 ** (np.floor(np.log10(np.maximum(np.abs(x), 1e-300))) - n + 1)

    found = [one(n, "significant digits", significant(n)) for n in DIGITS]
    return found + [one(n, "decimals", lambda x, n=n: np.full_like(x, 10.0**-n)) for n in DIGITS]  # type: ignore[misc]


STEPS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""Below, rounding makes more of the error than the step does, and nobody can predict it."""


@proposer(
    "finite_differences",
    "derivatives are taken by finite differences",
    "derive them exactly, or say how precise they are",
)
def finite_differences(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(step: float, central: bool) -> Hypothesis:
        def act(view: View, term: str) -> np.ndarray:
            return DIFFERENCES[term](view, step, central)

        words = f"step {step:g}, {'central' if central else 'forward'}"
        return replace(h, place="formula", act=act, terms=tuple(DIFFERENCES), values=words, cost=1.3, most=0.3)

    return [one(step, central) for step in STEPS for central in (False, True)]


def _difference(
    f: Callable[[np.ndarray], np.ndarray], view: View, v: np.ndarray, h: float, central: bool
) -> np.ndarray:
    """df/dt along v."""
    q = view.states["q"]
    after, before = (f(integrate(view.robot, q, s * v, engine="numpy")) for s in (h, -h if central else 0.0))
    return np.asarray((after - before) / (2 * h if central else h))


def _jacobian_dot(view: View, h: float, central: bool) -> np.ndarray:
    reference = view.layout.how.reference
    return _difference(lambda q: view.compute("jacobian", reference, q=q), view, view.states["v"], h, central)


def _gravity(view: View, h: float, central: bool) -> np.ndarray:
    n, nv = view.states["v"].shape
    along = (np.broadcast_to(e, (n, nv)) for e in np.eye(nv))
    return np.stack(
        [_difference(lambda q: view.compute("potential_energy", q=q), view, e, h, central) for e in along], -1
    )


def _coriolis(view: View, h: float, central: bool) -> np.ndarray:
    """Christoffel's symbols."""
    v = view.states["v"]
    along = (np.broadcast_to(e, v.shape) for e in np.eye(v.shape[1]))
    dM = np.stack([_difference(lambda q: view.compute("crba", q=q), view, e, h, central) for e in along], -1)
    rate, by_q = product(dM, v[:, None, :].repeat(dM.shape[1], 1)), np.einsum("nijk,nj->nik", dM, v)
    return np.asarray(0.5 * (rate + by_q - transposed(by_q)))


DIFFERENCES = {"jacobian_dot": _jacobian_dot, "gravity": _gravity, "coriolis": _coriolis}
