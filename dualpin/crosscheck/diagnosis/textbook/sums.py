"""What is put together from right parts: tau = M a + C v + g - J^T f, its inverse, and the derivatives of both.

    a = M^-1 (tau - C v - g + J^T f)
    da = M^-1 (dtau - (d tau / dq) dq - (d tau / dv) dv),  the derivatives of tau taken at that a

References: Featherstone, Rigid Body Dynamics Algorithms (2008), section 6.1; Carpentier and Mansard, Analytical
derivatives of rigid body dynamics algorithms, RSS (2018), equation 9.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .assembly import solved
from .steps import Steps

REFERENCES = ("world", "local", "local_world_aligned")
DAMPED = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""What people add to the diagonal of a matrix before they invert it."""
TERMS = ("bias", "rnea", "rnea_f_ext", "minv", "aba", "aba_f_ext", "coriolis", "rnea_derivatives", "aba_derivatives")
BY_Q = "the derivative by q"
STEPS = (1e-2, 1e-3, 1e-4, 1e-5)
"""Of finite differences so coarse that their error is more than rounding."""


def run(view: View, term: str, steps: Steps) -> np.ndarray | None:
    """The term (runs, samples, ...)."""
    if term in ("bias", "rnea", "rnea_f_ext"):
        return _inverse(view, term, steps)
    if term == "coriolis":
        return _coriolis(view, steps)
    if term in ("aba", "aba_f_ext"):
        return _forward(view, term, steps)
    if term == "minv":
        return _inverted(view, steps)
    return _rnea_derivatives(view, steps) if term == "rnea_derivatives" else _aba_derivatives(view, steps)


def _parts(view: View) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """M, M a, C v and g."""
    M, g = view.compute("crba")[None], view.compute("gravity")[None]
    return M, product(M, view.states["a"][None]), view.compute("bias")[None] - g, g


def _pushed(view: View, steps: Steps) -> np.ndarray:
    """J^T f of each frame."""
    f = view.states["f_ext"][None, :, None, :]
    asked = view.layout.how.reference

    def torques(reference: str, w: float = 1.0, u: float = 1.0) -> np.ndarray:
        J = view.compute("jacobian", reference)[None]
        return product(transposed(J), f * np.array([w, w, w, u, u, u]))

    others: dict[str, Callable[[], np.ndarray]] = {
        f"J^T f with the {r} Jacobian": partial(torques, r) for r in REFERENCES if r != asked
    }  # fmt: skip
    others |= {
        "J^T f without the moment": lambda: torques(asked, 0.0),
        "J^T f without the force": lambda: torques(asked, 1.0, 0.0),
    }
    others["J^T f with moment and force in each other's place"] = lambda: product(
        transposed(view.compute("jacobian", asked)[None]), f[..., [3, 4, 5, 0, 1, 2]]
    )
    return np.asarray(steps.pick("what the external force adds", torques(asked), **others))


def _inverse(view: View, term: str, steps: Steps) -> np.ndarray:
    _, Ma, Cv, g = _parts(view)
    if term == "bias":
        return np.asarray(steps.add("the bias forces", **{"C v": Cv, "g": g}))
    terms = {"M a": Ma, "C v": Cv, "g": g}
    if term == "rnea_f_ext":
        terms = {k: x[:, :, None] for k, x in terms.items()} | {"-J^T f": -_pushed(view, steps)}
    return np.asarray(steps.add("tau = M a + C v + g", **terms))


def _inverted(view: View, steps: Steps) -> np.ndarray:
    """M^-1, with what else is taken for it."""
    M = view.compute("crba")[None]
    one = np.eye(M.shape[-1])
    others: dict[str, Callable[[], np.ndarray]] = {
        "M itself": lambda: M,
        "the inverse of its diagonal": lambda: solved(M * one, one[None, None]),
        "the inverse of its upper triangle": lambda: solved(np.triu(M), one[None, None]),
        "the inverse of its lower triangle": lambda: solved(np.tril(M), one[None, None]),
        "the diagonal of the inverse": lambda: solved(M, one[None, None]) * one,
        "one over each entry": lambda: 1.0 / np.where(M == 0, np.nan, M),
        "L^-1 L^-T, of M = L L^T": lambda: _cholesky(M),
        "L^-1 of M = L L^T": lambda: np.linalg.inv(np.linalg.cholesky(M)),
        "L^-1 L^-1, of M = L L^T": lambda: np.linalg.matrix_power(np.linalg.inv(np.linalg.cholesky(M)), 2),
    }  # fmt: skip
    for k in DAMPED:
        others[f"that of M with {k:g} added on the diagonal"] = partial(solved, M + k * one, one[None, None])
        others[f"(M^T M + {k:g})^-1 M^T"] = partial(solved, transposed(M) @ M + k * one, transposed(M))
    return np.asarray(steps.pick("the inverse of M", solved(M, one[None, None]), **others))


def _cholesky(M: np.ndarray) -> np.ndarray:
    inverse = np.linalg.inv(np.linalg.cholesky(M))
    return inverse @ transposed(inverse)


def _coriolis(view: View, steps: Steps) -> np.ndarray:
    """C, with what else is made of the forces C v."""
    v, zero = view.states["v"], np.zeros_like(view.states["v"])
    g, nv = view.compute("gravity"), view.states["v"].shape[1]

    def of_unit_velocities() -> np.ndarray:
        columns = [view.compute("bias", v=zero + e) - g for e in np.eye(nv)]
        return np.stack(columns, axis=-1)[None]

    def by_v() -> np.ndarray:
        return view.compute("rnea_derivatives", a=zero)[None, :, 1]

    others: dict[str, Callable[[], np.ndarray]] = {
        "the derivative of C v by v": by_v, "half the derivative of C v by v": lambda: by_v() / 2,
        "the forces C v of unit velocities, by columns": of_unit_velocities,
        "the forces C v of unit velocities, times these": lambda: of_unit_velocities() * v[None, :, None, :],
        "C with gravity in every column": lambda: (view.compute("coriolis") + g[..., None])[None],
        "the derivative of all forces by q": lambda: view.compute("rnea_derivatives", a=zero)[None, :, 0],
    }  # fmt: skip
    return np.asarray(steps.pick("the matrix C", view.compute("coriolis")[None], **others))


def _forward(view: View, term: str, steps: Steps) -> np.ndarray:
    _, _, Cv, g = _parts(view)
    terms = {"tau": view.states["tau"][None], "-C v": -Cv, "-g": -g}
    if term == "aba_f_ext":
        terms = {k: x[:, :, None] for k, x in terms.items()} | {"J^T f": _pushed(view, steps)}
    left = steps.add("the force that accelerates, tau - C v - g", **terms)
    inverse = _inverted(view, steps)
    if term == "aba_f_ext":
        inverse = inverse[:, :, None]
    tau, rest = view.states["tau"][None], Cv + g
    if term == "aba_f_ext":
        return product(inverse, left)
    others = {
        "M^-1 tau - (C v + g), with M^-1 of tau alone": lambda: product(inverse, tau) - rest,
        "tau - M^-1 (C v + g), with M^-1 of the bias alone": lambda: tau - product(inverse, rest),
        "M^-1 (tau - C v) - g, without M^-1 of gravity": lambda: product(inverse, tau - Cv) - g,
    }  # fmt: skip
    return np.asarray(steps.pick("the acceleration M^-1 (tau - C v - g)", product(inverse, left), **others))


# --- derivatives ---------------------------------------------------------------------------------


def _rnea_derivatives(view: View, steps: Steps) -> np.ndarray:
    s, zero = view.states, np.zeros_like(view.states["v"])

    def at(**changed: np.ndarray) -> np.ndarray:
        return view.compute("rnea_derivatives", "local_world_aligned", **changed)[None]

    right = at()
    by_q, by_v, by_a = right[:, :, 0], right[:, :, 1], right[:, :, 2]
    gravity = at(v=zero, a=zero)[:, :, 0]
    others: dict[str, Callable[[], np.ndarray]] = {
        "that at a = 0": lambda: at(a=zero)[:, :, 0], "that at v = 0": lambda: at(v=zero)[:, :, 0],
        "that of gravity alone": lambda: gravity, "that without gravity": lambda: by_q - gravity,
        "0": lambda: 0 * by_q, "its transpose": lambda: transposed(by_q),
    }  # fmt: skip
    by_q = steps.pick(BY_Q, by_q, **others)
    C = view.compute("coriolis")[None]
    by_v = steps.pick(
        "the derivative by v", by_v,
        **{"C": C, "2 C": 2 * C, "half of it": by_v / 2, "twice of it": 2 * by_v, "0": 0 * by_v,
           "its transpose": transposed(by_v)},
    )  # fmt: skip
    others = {
        "M^-1": lambda: np.linalg.inv(right[:, :, 2]), "1": lambda: np.eye(by_a.shape[-1]) + 0 * by_a,
        "the diagonal of M": lambda: by_a * np.eye(by_a.shape[-1]), "0": lambda: 0 * by_a,
    }  # fmt: skip
    by_a = steps.pick("the derivative by a", by_a, **others)
    x = _stack(by_q, by_v, by_a)
    return _differences(view, steps, x, "rnea", (s["q"], s["v"], s["a"]), ("q", "v", "a"))


def _aba_derivatives(view: View, steps: Steps) -> np.ndarray:
    s = view.states
    a, zero = view.compute("aba"), np.zeros_like(s["v"])

    def of_tau(**changed: np.ndarray) -> np.ndarray:
        return view.compute("rnea_derivatives", "local_world_aligned", **changed)[None]

    others = {
        "that at a = 0": lambda: of_tau(a=zero), "that at a = tau": lambda: of_tau(a=s["tau"]),
        "that at v = 0": lambda: of_tau(a=a, v=zero),
    }  # fmt: skip
    D = steps.pick("the derivative of tau", of_tau(a=a), **others)
    inverse = _inverted(view, steps)
    others = {
        "that without gravity": lambda: D[:, :, 0] - of_tau(a=zero, v=zero)[:, :, 0],
        "that of gravity alone": lambda: of_tau(a=zero, v=zero)[:, :, 0],
        "its transpose": lambda: transposed(D[:, :, 0]),
        "that at a = 0": lambda: of_tau(a=zero)[:, :, 0], "that at v = 0": lambda: of_tau(a=a, v=zero)[:, :, 0],
    }  # fmt: skip
    by_q = steps.pick(BY_Q, D[:, :, 0], **others)
    by_q = steps.add("the derivative of a by q", **{"-M^-1 d tau / dq": -inverse @ by_q})
    by_v = steps.add("the derivative of a by v", **{"-M^-1 d tau / dv": -inverse @ D[:, :, 1]})
    missing = {"without M^-1": -D[:, :, 0] + 0 * by_q}
    by_q = steps.pick("the derivative of a by q, as a product,", by_q, **missing)
    missing = {"without M^-1": -D[:, :, 1]}
    by_v = steps.pick("the derivative of a by v, as a product,", by_v, **missing)
    by_tau = steps.pick(
        "the derivative of a by tau", inverse, **{"1": np.eye(inverse.shape[-1]) + 0 * inverse, "0": 0 * inverse}
    )
    return _differences(view, steps, _stack(by_q, by_v, by_tau), "aba", (s["q"], s["v"], s["tau"]), ("q", "v", "tau"))


def _stack(*blocks: np.ndarray) -> np.ndarray:
    return np.stack(np.broadcast_arrays(*blocks), axis=2)


def _differences(
    view: View, steps: Steps, exact: np.ndarray, of: str, inputs: tuple[np.ndarray, ...], names: tuple[str, ...]
) -> np.ndarray:
    """The derivatives, or the differences of coarse steps that are taken for them (coordinates that add up only)."""
    if view.states["q"].shape != view.states["v"].shape:
        return exact

    def taken(h: float, behind: float) -> np.ndarray:
        return (moved(h) - moved(-behind)) / (h + behind)

    def moved(h: float) -> np.ndarray:
        """The term with every coordinate displaced in turn, in one call."""
        n, nv = view.states["v"].shape
        states = {}
        for k, name in enumerate(names):
            x = np.zeros((n, 3, nv, nv)) + inputs[k][:, None, None]
            x[:, k] += h * np.eye(nv)
            states[name] = x.reshape(-1, nv)
        return transposed(view.compute(of, **states).reshape(n, 3, nv, nv))[None]

    others: dict[str, Callable[[], np.ndarray]] = {}
    for h in STEPS:
        others[f"one-sided differences of step {h:g}"] = partial(taken, h, 0.0)
        others[f"central differences of step {h:g}"] = partial(taken, h, h)
    return np.asarray(steps.pick("the derivative", exact, **others))
