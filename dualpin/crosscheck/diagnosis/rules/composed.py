"""Terms that are made of other terms: wrong where these are, and only there."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ....spatial.adjoint import cross_matrix
from ..case import Case, View
from ..hypothesis import Hypothesis
from .register import proposer

PARTS = {
    "bias": ("gravity", "coriolis"),
    "rnea": ("crba", "bias", "gravity", "coriolis"),
    "aba": ("crba", "bias", "gravity", "coriolis"),
    "rnea_f_ext": ("rnea", "jacobian"),
    "aba_f_ext": ("crba", "bias", "gravity", "coriolis", "jacobian"),
    "minv": ("crba",),
    "kinetic_energy": ("crba",),
    "gravity": ("com_jacobian",),
    "centroidal_momentum_matrix": ("com",),
    "potential_energy": ("com",),
    "frame_velocity": ("jacobian",),
    "frame_acceleration": ("jacobian", "jacobian_dot"),
}
"""What a code may make a term of: tau = M a + C v + g, V = J v, ..."""


@proposer("follows", "it differs as other terms do, of which it is made, and no further", "repair those first")
def follows(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """The subject's own answers put together, in the place of right ones."""
    off = {t for t, x in case.observed.items() if np.isfinite(x).all() and not case.score(t).right}
    out = []
    for term, parts in PARTS.items():
        wrong = [p for p in parts if p in off] if term in off else []
        for n in range(1, len(wrong) + 1):
            for some in itertools.combinations(wrong, n):
                if not ({"gravity", "coriolis"} & set(some) and "bias" in some):  # of which bias is made itself
                    what = ", ".join(some)
                    says = f"it differs as {what} {'does' if n == 1 else 'do'}, of which it is made, and no further"
                    made = replace(
                        h, says=says, fix=f"repair {what} first", terms=(term,), place="answer", made_of=some
                    )
                    out.append(replace(made, act=_composed(case, some), cost=1.2 + 0.1 * n))
    return out


def _composed(case: Case, parts: tuple[str, ...]) -> Callable[[View, str, np.ndarray], np.ndarray]:
    sent, observed = case.sent, case.observed

    def apart(part: str) -> np.ndarray:
        right = case.predict(part)
        return observed[part] - right if part in parts and right is not None else np.zeros(())

    def along(part: str, what: str) -> np.ndarray:
        """What the error of a matrix does to a velocity or an acceleration."""
        D = apart(part)
        return np.einsum("n...ij,nj->n...i", D, sent[what]) if D.ndim else D

    def pushed() -> np.ndarray:
        """What the error of the Jacobians does to J^T f."""
        D = apart("jacobian")
        return np.einsum("nkij,ni->nkj", D, sent["f_ext"]) if D.ndim else D

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        bias = apart("bias") + apart("gravity") + along("coriolis", "v")
        if term == "bias":
            return x + bias
        if term == "rnea":
            return x + along("crba", "a") + bias
        if term == "rnea_f_ext":
            return x + (apart("rnea")[:, None] if "rnea" in parts else 0) - pushed()
        if term in ("aba", "aba_f_ext"):
            M = case.predict("crba")
            if M is None:
                raise ValueError("no mass matrix")
            many = (slice(None), None) if term == "aba_f_ext" else ()
            forces = np.einsum("nij,n...j->n...i", M, x) - (bias[many] if bias.ndim else bias) + pushed()
            return np.linalg.solve((observed["crba"] if "crba" in parts else M)[many], forces[..., None])[..., 0]
        if term == "minv":
            return np.linalg.inv(observed["crba"])
        if term == "kinetic_energy":
            return np.asarray(x + 0.5 * (sent["v"] * along("crba", "v")).sum(-1))
        if term == "gravity":
            weight = view.robot_mass * np.array(view.description.gravity)
            return x - np.einsum("nij,i->nj", apart("com_jacobian"), weight)
        if term == "potential_energy":
            return x - view.robot_mass * apart("com") @ np.array(view.description.gravity)
        if term == "centroidal_momentum_matrix":
            P = case.predict(term)
            linear = [case.how.rows.index(r) for r in ("vx", "vy", "vz")]
            angular = [case.how.rows.index(r) for r in ("wx", "wy", "wz")]
            out = x.copy()
            out[:, angular] -= cross_matrix(apart("com")) @ (x if P is None else P)[:, linear]
            return out
        if term == "frame_velocity":
            return x + along("jacobian", "v")
        return x + along("jacobian", "a") + along("jacobian_dot", "v")

    return act
