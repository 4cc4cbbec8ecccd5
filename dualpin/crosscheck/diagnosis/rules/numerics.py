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


def _along_each(f: Callable[[np.ndarray], np.ndarray], view: View, h: float, central: bool) -> tuple[np.ndarray, ...]:
    """f before and after a step of each velocity, and where it stands: (n, ..., nv) twice, in one evaluation."""
    q = view.states["q"]
    n, nv = len(q), view.robot.nv
    steps = np.concatenate([s * np.repeat(np.eye(nv), n, axis=0) for s in (h, -h if central else 0.0)])
    x = f(integrate(view.robot, np.tile(q, (2 * nv, 1)), steps, engine="numpy"))
    after, before = np.moveaxis(x.reshape(2, nv, n, *x.shape[1:]), 1, -1)
    return after, before


def _by_columns(term: str) -> Callable[[View, float, bool], np.ndarray]:
    def differences(view: View, h: float, central: bool) -> np.ndarray:
        after, before = _along_each(lambda q: view.compute(term, q=q), view, h, central)
        return np.asarray((after - before) / (2 * h if central else h))

    return differences


def _jacobian(view: View, h: float, central: bool) -> np.ndarray:
    """Of poses: positions, and the skew part of dR R^T."""
    if view.layout.how.reference != "local_world_aligned":
        raise ValueError("differences of poses are at the frame, in world axes")
    after, before = _along_each(lambda q: view.compute("fk", q=q), view, h, central)
    D = (after - before) / (2 * h if central else h)
    W = np.einsum("nfijv,nfkj->nfikv", D[:, :, :3, :3], view.compute("fk")[..., :3, :3])
    w = np.stack([W[:, :, 2, 1] - W[:, :, 1, 2], W[:, :, 0, 2] - W[:, :, 2, 0], W[:, :, 1, 0] - W[:, :, 0, 1]], 2) / 2
    return np.concatenate([w, D[:, :, :3, 3]], 2)


def _frame_velocity(view: View, h: float, central: bool) -> np.ndarray:
    return np.einsum("nfij,nj->nfi", _jacobian(view, h, central), view.states["v"])


def _frame_acceleration(view: View, h: float, central: bool) -> np.ndarray:
    """Of twists, while the velocity grows with the acceleration."""
    s = view.states

    def twist(k: float) -> np.ndarray:
        q = integrate(view.robot, s["q"], k * s["v"], engine="numpy")
        return view.compute("frame_velocity", view.layout.how.reference, q=q, v=s["v"] + k * s["a"])

    return np.asarray((twist(h) - twist(-h if central else 0.0)) / (2 * h if central else h))


DIFFERENCES = {
    "jacobian_dot": _jacobian_dot, "gravity": _gravity, "coriolis": _coriolis, "jacobian": _jacobian,
    "frame_velocity": _frame_velocity, "frame_acceleration": _frame_acceleration, "com_jacobian": _by_columns("com"),
}  # fmt: skip


# --- inverses ------------------------------------------------------------------------------------


@proposer(
    "damped_inverse", "the inverse of M is damped: a number is added on its diagonal",
    "solve with M itself; it has full rank",
)  # fmt: skip
def damped_inverse(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """(M + k 1)^-1, or (M^2 + k 1)^-1 M as damped least squares have it; k from the answers."""
    M, found = case.predict("crba"), []
    if M is None:
        return []
    for words, extra in DAMPED.items():
        k = _damping(case, M, extra)
        if k is not None and np.isfinite(k) and abs(k) > 1e-13:
            act = _damped(k, extra)
            terms = ("minv", "aba")
            found.append(replace(h, terms=terms, place="answer", act=act, values=f"{words}, k = {k:.6g}", cost=1.2))
    return found


DAMPED: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "(M + k 1)^-1": lambda M: np.broadcast_to(np.eye(M.shape[-1]), M.shape),
    "(M^2 + k 1)^-1 M": np.linalg.inv,
    "(M + k diag M)^-1": lambda M: M * np.eye(M.shape[-1]),
}
"""What k times is added to M."""


def _damping(case: Case, M: np.ndarray, extra: Callable[[np.ndarray], np.ndarray]) -> float | None:
    """k by least squares, of x^-1 - M = k E, or of tau - h - M a = k E a."""
    E = extra(M)
    for term in ("minv", "aba"):
        x, right = case.observed.get(term), case.predict(term)
        if x is None or right is None or not np.isfinite(x).all() or case.score(term).right:
            continue
        try:
            rest = np.linalg.inv(x) - M if term == "minv" else product(M, right - x)
        except np.linalg.LinAlgError:
            continue
        D = E if term == "minv" else product(E, x)
        return float((D * rest).sum() / (D * D).sum())
    return None


def _damped(k: float, extra: Callable[[np.ndarray], np.ndarray]) -> Callable[[View, str, np.ndarray], np.ndarray]:
    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        M = view.layout.answer("matrix", view.compute("crba"), view.states)
        inverse = np.linalg.inv(M + k * extra(M))
        return inverse if term == "minv" else product(inverse, product(M, x))

    return act
