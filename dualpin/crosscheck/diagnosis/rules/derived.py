"""Derivatives and regressors of which a code's own answers to other terms are made: wrong where these are.

A code that differentiates its rnea, or puts d tau/dv together of its C and d tau/da of its M, makes every mistake of
these again.  Each block is looked at by itself, since each may be made in a way of its own.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....algorithms.regressor import inertial_parameters
from ...subjects.convention import PARAMETERS, parameter_names
from ...subjects.layout import product
from ..apart import elsewhere
from ..case import Case, View
from ..hypothesis import Hypothesis, Story
from .composed import MOST, STENCIL

STEP = 2e-3
"""Of all inputs: for a light joint's acceleration, of 1e3 rad/s^2, differences leave out 1e-9 and round 1e-10."""
INPUTS = {"rnea": ("q", "v", "a"), "aba": ("q", "v", "tau")}
PARTS = {"rnea_derivatives": ("rnea", "coriolis", "crba"), "aba_derivatives": ("aba", "rnea", "crba", "coriolis")}
"""What derivatives may be made of: the function itself first."""


def by_derivatives(case: Case, term: str, stories: list[Story]) -> Iterator[Hypothesis]:
    """Derivatives of what a story predicts, of few joints on a fixed base; the last is without one."""
    names = [j.name for j in case.robot if j.mimic is None]
    made_of = tuple(t for t in PARTS[term] if t in case.wrong)
    if case.floating or case.robot.nv > MOST or case.robot.nq != len(names) or not made_of:
        return
    says = f"it is made of derivatives, and differs as {', '.join(made_of)} {'does' if len(made_of) == 1 else 'do'}"
    for story in [*stories, ()]:

        def act(view: View, term: str, x: np.ndarray, story: Story = story) -> np.ndarray:
            made = _of_rnea if term == "rnea_derivatives" else _of_aba
            return _nearest(view.case.observed[term], [x, *made(view, names, story)])

        yield Hypothesis(
            "follows", says,
            (term,), "answer", act, f"repair {made_of[0]} first", cost=1.3, made_of=made_of,
            variant=" and ".join(map(str, story)),
        )  # fmt: skip


def _nearest(observed: np.ndarray, options: list[np.ndarray]) -> np.ndarray:
    """Of each block, the option that is nearest to what was answered."""
    off = [np.nan_to_num(np.abs(x - observed), nan=np.inf).max(axis=(0, 2, 3)) for x in options]
    best = np.argmin(off, axis=0)
    return np.stack([options[best[k]][:, k] for k in range(len(best))], axis=1)


def _of_rnea(view: View, names: list[str], story: Story) -> list[np.ndarray]:
    case = view.case
    S = _differences(case, "rnea", story, view.states, names)
    C, M = case.observed.get("coriolis", S[:, 1] / 2), case.observed.get("crba", S[:, 2])
    return [S, np.stack([S[:, 0], 2 * C, M], axis=1)]


def _of_aba(view: View, names: list[str], story: Story) -> list[np.ndarray]:
    """Of its own function, or M^-1 (tau - rnea) differentiated at the accelerations that it answers."""
    case = view.case
    if "aba" not in case.observed:
        return []
    own = bool(story) and case.score("aba", story).right
    out = [_differences(case, "aba", story, view.states, names)] if own else []
    a = case.observed["aba"][:, [case.how.v.index(name) for name in names]]
    inverse = np.linalg.inv(case.observed["crba"] if "crba" in case.observed else view.compute("crba"))[:, None]
    for of in dict.fromkeys([story, ()]):
        if not of or ("rnea" in case.observed and case.score("rnea", of).right):
            S = _differences(case, "rnea", of, {**view.states, "a": a}, names)
            out.append(np.concatenate([-inverse @ S[:, :2], inverse], axis=1))
    if "coriolis" in case.observed:
        halves = -2 * inverse[:, 0] @ case.observed["coriolis"]
        out.append(np.stack([out[-1][:, 0], halves, inverse[:, 0]], axis=1))
    return out


def _differences(
    case: Case, of: str, story: Story, states: dict[str, np.ndarray], names: list[str]
) -> np.ndarray:  # fmt: skip
    """(n, inputs, row, column) by central differences of the sixth order."""
    steps = [s * k for k in STENCIL for s in (1, -1)]
    weights = [np.sign(k) * STENCIL[abs(k)] / STEP for k in steps]
    n, nv = states["v"].shape
    many = {k: np.repeat(y, len(steps) * nv, axis=0) for k, y in states.items()}
    blocks = []
    for key in INPUTS[of]:
        moved = states[key][:, None, None, :] + STEP * np.array(steps)[None, :, None, None] * np.eye(nv)
        y = elsewhere(case, {**many, key: moved.reshape(-1, nv)}).predict(of, story)
        if y is None:
            raise ValueError(f"no {of}")
        blocks.append(np.einsum("s,nsji->nij", weights, y.reshape(n, len(steps), nv, nv)))
    return np.stack(blocks, axis=1)[..., [names.index(name) for name in case.how.v]]


def by_parameters(case: Case) -> Iterator[Hypothesis]:
    """A regressor whose product with the parameters of the file is what the subject's rnea answers."""
    if "rnea" in case.wrong:
        says = "its product with the inertial parameters of the file is what rnea answers, and differs as rnea does"
        yield Hypothesis(
            "follows", says, ("joint_torque_regressor",), "relation", _same_torques, "repair rnea first", cost=1.3,
            made_of=("rnea",),
        )  # fmt: skip


def _same_torques(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    """The nearest regressor with these torques."""
    case = view.case
    p = _parameters(case)
    lacks = case.observed["rnea"] - product(observed, np.broadcast_to(p, (len(observed), len(p))))
    return np.asarray(observed + lacks[..., None] * p / (p @ p))


def _parameters(case: Case) -> np.ndarray:
    """Those of the file, in the order of the subject's columns: of links, or of bodies where it names none."""
    of_bodies = list(map(float, inertial_parameters(case.robot)))
    if not case.how.parameters:
        return np.array(of_bodies)
    told = dict(zip(parameter_names(case.robot), of_bodies, strict=True))
    d = case.description
    for link, body in ((d.root, d.base), *((p.link, p.body) for p in d.parts)):
        values = np.zeros(10)
        if body is not None:
            m, c = body.mass, body.com
            I = body.in_link + m * ((c @ c) * np.eye(3) - np.outer(c, c))
            values = np.array([m, *(m * c), I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2]])
        told |= {f"{link}.{name}": x for name, x in zip(PARAMETERS, values, strict=True)}
    return np.array([told[name] for name in case.how.parameters])
