"""Matrices of which a code's own answers to other terms are the source: wrong where these are.

C of Christoffel's symbols of its M, derivatives of its rnea and aba, a regressor of its torques.  What explains the
source is differentiated numerically.  Each block of derivatives is looked at by itself: a code that differentiates its
rnea by q may put d tau/dv together of its C and take d tau/da from its M.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ....algorithms.regressor import inertial_parameters
from ...subjects.convention import PARAMETERS, parameter_names
from ...subjects.layout import product
from ..apart import elsewhere
from ..case import Case, View
from ..hypothesis import Hypothesis, Story
from ..stories import united
from .dynamics import SUMS
from .register import RULES

STENCIL = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
"""Weights of central differences of sixth order."""
STEP = 2e-3
"""Of all inputs: for a light joint's acceleration, of 1e3 rad/s^2, differences leave out 1e-9 and round 1e-10."""
MOST = 12
"""Degrees of freedom up to which predictions are differentiated."""
SOURCES = {
    "rnea_derivatives": ("rnea", "coriolis", "crba"),
    "aba_derivatives": ("aba", "rnea", "crba", "minv", "coriolis", "rnea_derivatives"),
}
"""What derivatives may be made of."""


def _differentiable(case: Case) -> bool:
    """Few joints on a fixed base, whose velocities are the rates of their positions."""
    free = sum(j.mimic is None for j in case.robot)
    return not case.floating and case.robot.nv <= MOST and case.robot.nq == free


def _columns(case: Case) -> list[int]:
    """Where the subject's columns are among dualpin's."""
    names = [j.name for j in case.robot if j.mimic is None]
    return [names.index(name) for name in case.how.v]


def _differences(case: Case, of: str, by: str, story: Story, states: Mapping[str, np.ndarray]) -> np.ndarray:
    """(n, ..., column): the derivatives of what a story predicts by each entry of one input."""
    steps = [s * k for k in STENCIL for s in (1, -1)]
    weights = [np.sign(k) * STENCIL[abs(k)] / STEP for k in steps]
    n, nv = states["v"].shape
    many = {k: np.repeat(y, len(steps) * nv, axis=0) for k, y in states.items()}
    moved = states[by][:, None, None, :] + STEP * np.array(steps)[None, :, None, None] * np.eye(nv)
    y = elsewhere(case, {**many, by: moved.reshape(-1, nv)}).predict(of, story)
    if y is None:
        raise ValueError(f"no {of}")
    found = np.einsum("s,ns...->n...", weights, y.reshape(n, len(steps), nv, *y.shape[1:]))
    return np.moveaxis(found, 1, -1)[..., _columns(case)]


# --- the Coriolis matrix of a wrong mass matrix ---------------------------------------------------


def by_symbols(case: Case, story: Story) -> Hypothesis | None:
    """C from Christoffel's symbols of the mass matrix that a story predicts.

    References: Siciliano et al., Robotics (2009), equation 7.45.
    """
    if not _differentiable(case) or any(h.made_of for h in story):
        return None

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        dM, v = _differences(view.case, "crba", "q", story, view.states), view.case.sent["v"]
        rate, by_q = np.einsum("nijk,nk->nij", dM, v), np.einsum("nijk,nj->nik", dM, v)
        return np.asarray(0.5 * (rate + by_q - np.swapaxes(by_q, -1, -2)))

    says = "it is made of M by Christoffel's symbols, and differs as crba does"
    return Hypothesis(
        "follows", says, ("coriolis",), "answer", act, "repair crba first", cost=1.3, made_of=("crba",),
        variant=" and ".join(map(str, story)),
    )  # fmt: skip


# --- derivatives ----------------------------------------------------------------------------------


def by_derivatives(case: Case, term: str, stories: Sequence[Story]) -> Iterator[Hypothesis]:
    """Derivatives of what each of these stories predicts; the last is without a story."""
    made_of = tuple(t for t in SOURCES[term] if t in case.wrong)
    if not _differentiable(case) or not made_of:
        return
    says = f"it is made of derivatives, and differs as {', '.join(made_of)} {'does' if len(made_of) == 1 else 'do'}"
    options = _of_rnea if term == "rnea_derivatives" else _of_aba
    for story in [*stories, ()]:

        def act(view: View, term: str, x: np.ndarray, story: Story = story) -> np.ndarray:
            return _nearest(view.case.observed[term], [x, *options(view, story)])

        yield Hypothesis(
            "follows", says, (term,), "answer", act, f"repair {made_of[0]} first", cost=1.3, made_of=made_of,
            variant=" and ".join(map(str, story)),
        )  # fmt: skip


class _Told(View):
    """What a story predicts, also at other states, in the place of right answers."""

    def __init__(self, view: View, story: Story) -> None:
        super().__init__(view.case, view.description, view.layout, view.states)
        self.story, self.made = story, dict[Any, np.ndarray]()

    def compute(self, term: str, reference: str = "", **states: np.ndarray) -> np.ndarray:
        key = term, *((k, x.tobytes()) for k, x in states.items())
        if key not in self.made:
            at = {**self.states, **states}
            if term == "rnea_derivatives":
                self.made[key] = _blocks(self.case, "rnea", ("q", "v", "a"), self.story, at)
            else:
                found = elsewhere(self.case, at).predict(term, self.story)
                if found is None:
                    raise ValueError(f"no {term}")
                self.made[key] = found
        return self.made[key]


def slipped_derivatives(case: Case, term: str, stories: Sequence[Story]) -> Iterator[Hypothesis]:
    """A slip in derivatives of a wrong rnea, as the first of these stories predicts it."""
    if term != "rnea_derivatives" or "rnea" not in case.wrong or not (stories and _differentiable(case)):
        return
    made: list[_Told] = []

    def act(slip: Hypothesis, view: View, term: str, x: np.ndarray) -> Any:
        made.extend([_Told(view, stories[0])] if not made else [])
        return _nearest(view.case.observed[term], [slip.act(made[0], term), x])

    for slip in (g for rule in RULES if rule.key == SUMS for g in rule.propose(case) if term in g.terms):
        yield replace(
            slip, place="answer", act=partial(act, slip), terms=(term,), made_of=("rnea",),
            variant=" and ".join(map(str, stories[0])), cost=slip.cost + 0.1,
        )  # fmt: skip


def _nearest(observed: np.ndarray, options: Sequence[np.ndarray]) -> np.ndarray:
    """Of each block, the option that is nearest to what was answered."""
    off = [np.nan_to_num(np.abs(x - observed), nan=np.inf).max(axis=(0, 2, 3)) for x in options]
    best = np.argmin(off, axis=0)
    return np.stack([options[k][:, block] for block, k in enumerate(best)], axis=1)


def _blocks(case: Case, of: str, by: Sequence[str], story: Story, states: Mapping[str, np.ndarray]) -> np.ndarray:
    """(n, inputs, row, column)."""
    return np.stack([_differences(case, of, one, story, states) for one in by], axis=1)


def _of_rnea(view: View, story: Story) -> Iterator[np.ndarray]:
    """Its derivatives, or those by q alone, beside 2 C and M."""
    observed, found = view.case.observed, _blocks(view.case, "rnea", ("q", "v", "a"), story, view.states)
    yield found
    C, M = observed.get("coriolis", found[:, 1] / 2), observed.get("crba", found[:, 2])
    yield np.stack([found[:, 0], 2 * C, M], axis=1)


def _of_aba(view: View, story: Story) -> Iterator[np.ndarray]:
    """Its derivatives, or -M^-1 d rnea/d(q, v) at the accelerations that it answers; by v by its C or its own."""
    case, observed = view.case, view.case.observed
    if "aba" not in observed:
        return
    if story and case.score("aba", story).right:
        yield _blocks(case, "aba", ("q", "v", "tau"), story, view.states)
    states = {**view.states, "a": observed["aba"][:, np.argsort(_columns(case))]}
    M = observed["crba"] if "crba" in observed else view.compute("crba")
    inverse = (observed["minv"] if "minv" in observed else np.linalg.inv(M))[:, None]
    for of in dict.fromkeys((story, ())):
        if not of or ("rnea" in observed and case.score("rnea", of).right):
            found = -inverse @ _blocks(case, "rnea", ("q", "v"), of, states)
            yield np.concatenate([found, inverse], axis=1)
            by_v = [2 * observed["coriolis"]] if "coriolis" in observed else []
            by_v += [observed["rnea_derivatives"][:, 1]] if "rnea_derivatives" in observed else []  # whatever a is
            for D in by_v:
                yield np.concatenate([found[:, :1], -inverse @ D[:, None], inverse], axis=1)


# --- regressors -----------------------------------------------------------------------------------


def by_parameters(case: Case, others: Sequence[Story]) -> Iterator[Hypothesis]:
    """A regressor whose product with the parameters of the file is what the subject's rnea answers.

    Other stories say how the file may be read.
    """
    if "rnea" not in case.wrong or case.asking.samples < 2:  # of one state it holds too easily
        return
    read = united([(), *(tuple(h for h in s if h.place == "edit") for s in others)])
    for edits in read[:SEVERAL]:
        words = "".join(f", read so that {h}," for h in edits)
        says = f"its product with the inertial parameters of the file{words} is what rnea answers"
        yield Hypothesis(
            "follows", f"{says}, and differs as rnea does", ("joint_torque_regressor",), "relation",
            partial(_same_torques, edits), "repair rnea first", cost=1.3, made_of=("rnea",),
        )  # fmt: skip


def _same_torques(edits: Story, view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    """The nearest regressor with these torques."""
    case, read = view.case, view.case.view(edits)
    p = _parameters(case, view if read is None else read)
    lacks = case.observed["rnea"] - product(observed, np.broadcast_to(p, (len(observed), len(p))))
    return np.asarray(observed + lacks[..., None] * p / (p @ p))


def _parameters(case: Case, read: View) -> np.ndarray:
    """Those of the file, in the order of the subject's columns: of links, or of bodies where it names none."""
    of_bodies = list(map(float, inertial_parameters(read.robot)))
    if not case.how.parameters:
        return np.array(of_bodies)
    told = dict(zip(parameter_names(case.robot), of_bodies, strict=True))
    d = read.description
    for link, body in ((d.root, d.base), *((p.link, p.body) for p in d.parts)):
        values = np.zeros(10)
        if body is not None:
            m, c = body.mass, body.com
            I = body.in_link + m * ((c @ c) * np.eye(3) - np.outer(c, c))
            values = np.array([m, *(m * c), I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2]])
        told |= {f"{link}.{name}": x for name, x in zip(PARAMETERS, values, strict=True)}
    return np.array([told[name] for name in case.how.parameters])


# --- what explains the source ----------------------------------------------------------------------

SEVERAL = 4  # stories of a source that are tried


def of_symbols(case: Case, term: str, others: Sequence[Story]) -> list[Story]:
    """C of the mass matrix that a story explains."""
    if term != "coriolis" or "crba" not in case.observed or case.score("crba").right:
        return []
    of_mass = [s for s in others if all("crba" in h.terms for h in s) and case.score("crba", s).right]
    return [(h,) for s in of_mass[:SEVERAL] if (h := by_symbols(case, s))]


def made_of(case: Case, term: str, others: Sequence[Story], exact: bool) -> list[Story]:
    """Matrices of what is explained of their sources; derivatives only where they are not explained `exact`ly."""
    made: list[Hypothesis] = []
    if term == "joint_torque_regressor":
        made += by_parameters(case, others)
    elif term in SOURCES and not exact:
        of = [t for t in ("aba", "rnea") if t in SOURCES[term] and t in case.wrong]
        told = [s for s in others if not any(h.made_of for h in s)]
        right = [[s for s in told if all(t in h.terms for h in s) and case.score(t, s).right] for t in of]
        sources = [s for some in right for s in some[: SEVERAL // len(of)]]
        made += [*by_derivatives(case, term, sources), *slipped_derivatives(case, term, sources)]
    return [*of_symbols(case, term, others), *((h,) for h in made)]
