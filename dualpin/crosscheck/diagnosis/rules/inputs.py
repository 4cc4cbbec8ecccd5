"""Inputs in each other's place, positions that are wrapped, and alike limbs that are exchanged."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.convention import BASE_V
from ...subjects.layout import product, rotations, transposed
from ..case import Case, States, View
from ..description import Description
from ..hypothesis import Hypothesis, reordered
from .register import ALL, WEIGHED, proposer, rule

MOTION = ("frame_velocity", "jacobian_dot", "frame_acceleration")
SWAPS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "v and a": ("v", "a", ("rnea", "frame_acceleration", "rnea_f_ext", "joint_torque_regressor", "rnea_derivatives")),
    "v and tau": ("v", "tau", ("aba", "aba_f_ext", "aba_derivatives")),
    "q and v": ("q", "v", (*MOTION, "kinetic_energy", "bias", "rnea", "aba", "coriolis")),
    "q and a": ("q", "a", ("frame_acceleration", "rnea")),
    "q and tau": ("q", "tau", ("aba",)),
}  # fmt: skip


def _with(others: Callable[[States], States]) -> Callable[[View, str], np.ndarray]:
    """The term of other inputs; its answer is still compared where the given ones lead."""
    return lambda view, term: view.compute(term, view.layout.how.reference, **others(view.states))


@proposer("inputs_swapped", "two inputs are in each other's place", "pass q, v, a (or tau) in the order of the call")
def inputs_swapped(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str) -> Hypothesis:
        a, b, terms = SWAPS[words]
        act = _with(lambda s: {a: s[b], b: s[a]})
        return replace(h, terms=terms, place="formula", act=act, values=words, cost=1.1)

    alike = case.robot.nq == case.robot.nv
    return [one(words) for words in SWAPS if alike or "q" not in words]


INSTEAD: dict[str, tuple[str, Callable[[States], np.ndarray], tuple[str, ...]]] = {
    "v in the place of a": ("a", lambda s: s["v"], ("rnea", "frame_acceleration")),
    "a in the place of v": ("v", lambda s: s["a"], ("rnea", "frame_acceleration")),
    "a with the other sign": ("a", lambda s: -s["a"], ("rnea", "frame_acceleration")),
    "v with the other sign": ("v", lambda s: -s["v"], ("frame_velocity", "jacobian_dot", "coriolis")),
    "tau with the other sign": ("tau", lambda s: -s["tau"], ("aba",)),
}


@proposer("input_instead", "an input is another, or has the other sign", "pass the input that it is a function of")
def input_instead(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str) -> Hypothesis:
        what, made, terms = INSTEAD[words]
        act = _with(lambda s: {what: made(s)})
        return replace(h, terms=terms, place="formula", act=act, values=words, cost=1.15)

    return [one(words) for words in INSTEAD]


@rule(
    "wrapped", "positions of sliding joints are wrapped to (-pi, pi], as angles are", "wrap angles alone", ALL, "state",
    cost=1.1, when=lambda case: any(p.slides for p, _ in case.parts()),
)  # fmt: skip
def wrapped(view: View) -> States:
    q = view.states["q"].copy()
    for j in view.case.robot:
        if j.mimic is None and j.model.additive and j.model.coordinates == ("length",):
            q[:, j.q] = np.pi - np.mod(np.pi - q[:, j.q], 2 * np.pi)
    return {**view.states, "q": q}


@proposer(
    "stale_base", "forces on the base are in the axes that it had in an earlier call", "set the state in each call",
)  # fmt: skip
def stale_base(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """World axes, turned by the attitude of a state that was sent before."""

    def one(words: str, earlier: Callable[[np.ndarray], np.ndarray]) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            R = rotations(view.states["q"][:, 3:7])
            turn, out, columns = earlier(R) @ transposed(R), x.copy(), list(view.layout.how.v)
            for three in (BASE_V[:3], BASE_V[3:]):
                at = [columns.index(name) for name in three]
                out[:, at] = product(turn, x[:, at])
            return out

        return replace(h, terms=WEIGHED[:3], place="answer", act=act, values=words, cost=1.2)

    world = case.how.angular == case.how.linear == "world"
    earlier = {"the first": lambda R: R[:1], "the one before": lambda R: np.concatenate([R[:1], R[:-1]])}
    return [one(words, of) for words, of in earlier.items()] if case.floating and world else []


@proposer("limbs", "two limbs of the same structure stand in each other's place", "list the joints by their names")
def limbs(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """Left and right arms or legs, exchanged in all columns."""
    here = [n for n in case.how.v if n in {p.joint for p, _ in case.parts()}]
    out = []
    for a, b in _alike(case.description, set(here)):
        if len(a) > 1:  # single joints have a rule of their own
            there = dict(zip([*a, *b], [*b, *a], strict=True))
            act = reordered(here, [there.get(n, n) for n in here])
            out.append(replace(h, terms=ALL, place="word", act=act, items=(a[0], b[0]), cost=1.5))
    return out if len(out) <= MOST else []


MOST = 60  # pairs of limbs that are tried


def _alike(d: Description, moving: set[str]) -> list[tuple[list[str], list[str]]]:
    """Pairs of disjoint subtrees with as many joints of the same kinds in the same order, the largest first."""
    under: dict[str, list[str]] = {}
    kinds = {p.joint: p.type for p in d.parts}
    for p in reversed(d.parts):
        own = [p.joint] if p.joint in moving else []
        under[p.joint] = own + [j for c in d.parts if c.parent == p.link for j in under[c.joint]]
    whole: dict[tuple[str, ...], list[str]] = {}
    for joints in under.values():
        if joints:
            whole.setdefault(tuple(joints), joints)
    pairs = [
        (a, b) for a, b in itertools.combinations(whole.values(), 2)
        if not set(a) & set(b) and [kinds[j] for j in a] == [kinds[j] for j in b]
    ]  # fmt: skip
    return sorted(pairs, key=lambda pair: -len(pair[0]))
