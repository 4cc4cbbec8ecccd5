"""Terms that are made of other terms: wrong where these are, and only there."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product
from ..case import Case, View
from ..hypothesis import Hypothesis
from ..textbook import sums
from ..textbook.words import rows
from .dynamics import FACTORS, SUMS
from .register import RULES, proposer

PARTS = {
    "bias": ("gravity", "coriolis"),
    "rnea": ("crba", "bias", "gravity", "coriolis"),
    "aba": ("crba", "bias", "gravity", "coriolis", "minv"),
    "rnea_f_ext": ("rnea", "jacobian"),
    "aba_f_ext": ("aba", "crba", "bias", "gravity", "coriolis", "jacobian", "minv"),
    "minv": ("crba",),
    "kinetic_energy": ("crba",),
    "gravity": ("com_jacobian",),
    "centroidal_momentum_matrix": ("com", "com_jacobian"),
    "com_jacobian": ("centroidal_momentum_matrix",),
    "potential_energy": ("com",),
    "frame_velocity": ("jacobian",),
    "frame_acceleration": ("jacobian", "jacobian_dot"),
}
"""What a code may make a term of: tau = M a + C v + g, V = J v, ..."""
TWICE = (
    {"bias", "gravity"}, {"bias", "coriolis"}, {"crba", "minv"},
    *({"aba", part} for part in ("bias", "gravity", "coriolis")),
)  # fmt: skip
"""Of which one is made of the other."""
OF_PARTS = (
    "velocity_scale", "inertia_scale", "bias_sign", "bias_ignored", "diagonal_inverse", "not_inverted",
)  # fmt: skip
"""Rules about how parts are put together."""
OWN = "of the subject's own parts"


@proposer("follows", "it differs as other terms do, of which it is made, and no further", "repair those first")
def follows(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """The subject's own answers put together, in the place of right ones."""
    out = []
    for term in PARTS:
        wrong = parts_of(term, case)
        for n in range(1, len(wrong) + 1):
            for some in itertools.combinations(wrong, n):
                if not any(both <= set(some) for both in TWICE):
                    what = ", ".join(some)
                    says = f"it differs as {what} {'does' if n == 1 else 'do'}, of which it is made, and no further"
                    made = replace(
                        h, says=says, fix=f"repair {what} first", terms=(term,), place="answer", made_of=some
                    )
                    out.append(replace(made, act=_composed(case, some), cost=1.2 + 0.1 * n))
    return out + [own for rule in RULES if rule.key in OF_PARTS for g in rule.propose(case) for own in _owned(g, case)]


def follows_from(case: Case, term: str) -> list[frozenset[str]]:
    """The wrong terms, together, whose answers explain this one's."""
    rule = next(rule for rule in RULES if rule.key == "follows")
    found = [h for h in rule.propose(case) if h.key == "follows" and h.terms == (term,)]
    return [frozenset(h.made_of) for h in found if case.score(term, (h,)).right]


def parts_of(term: str, case: Case) -> tuple[str, ...]:
    """Of a wrong term: the wrong answers of which it may be made."""
    wrong = [t for t in PARTS.get(term, ()) if not _right(t, case)]
    return () if _right(term, case) else tuple(wrong)


def used(term: str, case: Case) -> tuple[str, ...]:
    """The same, and the wrong answers of which these parts may be made themselves."""
    mine = parts_of(term, case)
    return tuple(dict.fromkeys([*mine, *(p for part in mine for p in parts_of(part, case) if p != term)]))


def _right(term: str, case: Case) -> bool:
    return term not in case.wrong or not np.isfinite(case.observed[term]).all()


# --- with another mistake -------------------------------------------------------------------------


class Own(View):
    """What the subject has: states as it gets them, its own answers where these are wrong, all in its own columns."""

    def __init__(self, view: View, parts: tuple[str, ...]) -> None:
        super().__init__(view.case, view.description, view.layout, view.case.sent)
        self.parts = parts

    def compute(self, term: str, reference: str = "", **states: np.ndarray) -> np.ndarray:
        x = self.case.observed[term] if term in self.parts else self.case.predict(term)
        if x is None or states or reference not in ("", self.layout.how.reference):
            raise ValueError("what it would answer elsewhere is not known")
        return x


def _owned(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """A mistake in putting parts together, of parts that are wrong themselves."""

    def of(term: str, parts: tuple[str, ...]) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            return np.asarray(h.act(Own(view, parts), term))

        made = replace(h, place="answer", act=act, terms=(term,), variant=OWN, made_of=parts)
        return replace(made, cost=h.cost + 0.1)

    return [of(term, used(term, case)) for term in h.terms if h.place == "formula" and parts_of(term, case)]


@proposer(OWN, OWN, "compare the step with the equation of the book", rows(), late=True)
def summed(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """Slips in sums of the subject's own parts."""
    if not any(parts_of(t, case) for t in sums.TERMS):
        return []
    some = [g for rule in RULES if rule.key in (SUMS, FACTORS) for g in rule.propose(case)]
    return [own for g in some for own in _owned(g, case)]


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
            given = np.zeros(())  # the accelerations without the wrench, where they are its own
            if "aba" in parts:
                given = observed["aba"][many]
                x = x - (given - apart("aba")[many])
            forces = np.einsum("nij,n...j->n...i", M, x) - (bias[many] if bias.ndim else bias) + pushed()
            if "minv" in parts:
                return np.asarray(given + product(observed["minv"][many], forces))
            own = (observed["crba"] if "crba" in parts else M)[many]
            return np.asarray(given + np.linalg.solve(own, forces[..., None])[..., 0])
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
            linear = [case.how.rows.index(r) for r in ("vx", "vy", "vz")]
            angular = [case.how.rows.index(r) for r in ("wx", "wy", "wz")]
            out = x.copy()
            if "com" in parts:
                out[:, angular] -= cross_matrix(apart("com")) @ x[:, linear]
            out[:, linear] += view.robot_mass * apart("com_jacobian")
            return out
        if term == "com_jacobian":
            linear = [case.how.rows.index(r) for r in ("vx", "vy", "vz")]
            return x + apart("centroidal_momentum_matrix")[:, linear] / view.robot_mass
        if term == "frame_velocity":
            return x + along("jacobian", "v")
        return x + along("jacobian", "a") + along("jacobian_dot", "v")

    return act
