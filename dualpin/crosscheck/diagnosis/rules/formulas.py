"""Parts of the equations of motion that are counted another number of times, and other forward dynamics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.layout import product
from ..case import Case, View
from ..hypothesis import Hypothesis
from .register import FORCED, proposer

TERMS = (*FORCED, "aba_f_ext", "coriolis")
SHARES = {"0": 0.0, "half": 0.5, "twice": 2.0, "with the other sign": -1.0}


def _accelerated(view: View, term: str, forces: np.ndarray) -> np.ndarray:
    """M^-1 of forces, and of J^T f where there is a wrench."""
    M = view.compute("crba")
    if term == "aba_f_ext":
        pushed = view.compute("rnea")[:, None] - view.compute("rnea_f_ext", view.layout.how.reference)
        M, forces = M[:, None], forces[:, None] + pushed
    return np.asarray(np.linalg.solve(M, forces[..., None])[..., 0])


def _scaled(k_a: float, k_v: float, k_g: float) -> Callable[[View, str], np.ndarray | None]:
    def act(view: View, term: str) -> np.ndarray | None:
        s, g = view.states, view.compute("gravity")
        velocity = view.compute("bias") - g
        if term == "bias":
            return k_v * velocity + k_g * g
        if term == "rnea":
            return k_a * product(view.compute("crba"), s["a"]) + k_v * velocity + k_g * g
        if term in ("aba", "aba_f_ext"):
            return _accelerated(view, term, k_a * s["tau"] - k_v * velocity - k_g * g)
        if term == "coriolis":
            return k_v * view.compute("coriolis")
        return None

    return act


@proposer("velocity_scale", "Coriolis and centrifugal forces are counted another number of times", "count them once")
def velocity_scale(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(h, terms=TERMS, place="formula", act=_scaled(1.0, k, 1.0), values=words, cost=1.05)
        for words, k in SHARES.items() if k
    ]  # fmt: skip


@proposer("inertia_scale", "M a (or, in forward dynamics, tau) is counted another number of times", "count it once")
def inertia_scale(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(h, terms=("rnea", "aba"), place="formula", act=_scaled(k, 1.0, 1.0), values=words, cost=1.05)
        for words, k in SHARES.items()
    ]


@proposer("bias_sign", "velocity and gravity terms have the other sign in forward dynamics", "a = M^-1 (tau - h)")
def bias_sign(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, terms=("aba", "aba_f_ext"), place="formula", act=_scaled(1.0, -1.0, -1.0), cost=1.05)]


def inverse_only(view: View, term: str) -> np.ndarray | None:
    """tau taken through M alone."""
    return _accelerated(view, term, view.states["tau"])


@proposer("bias_ignored", "velocity and gravity terms are left out of forward dynamics", "a = M^-1 (tau - h)")
def bias_ignored(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, terms=("aba", "aba_f_ext"), place="formula", act=inverse_only)]


@proposer("not_inverted", "the matrix itself, not its inverse", "invert it")
def not_inverted(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def act(view: View, term: str) -> np.ndarray:
        return view.compute("crba")

    return [replace(h, terms=("minv",), place="formula", act=act)]


@proposer("diagonal_inverse", "only the diagonal of M is inverted", "factorise all of M")
def diagonal_inverse(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def act(view: View, term: str) -> np.ndarray:
        d = 1.0 / np.einsum("nii->ni", view.compute("crba"))
        if term == "minv":
            return np.asarray(d[:, :, None] * np.eye(d.shape[1]))
        return np.asarray(d * (view.states["tau"] - view.compute("bias")))

    return [replace(h, terms=("minv", "aba"), place="formula", act=act)]


@proposer("coriolis_with_gravity", "gravity is in it as well as velocities", "C holds velocities only")
def bias_in_coriolis(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def act(view: View, term: str) -> np.ndarray:
        C, v, g = view.compute("coriolis"), view.states["v"], view.compute("gravity")
        return C + g[..., None] * v[:, None, :] / (v**2).sum(-1)[:, None, None]

    return [replace(h, terms=("coriolis",), place="formula", act=act, cost=1.3)]
