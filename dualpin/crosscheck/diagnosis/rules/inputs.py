"""Inputs in each other's place, positions that are wrapped, and alike limbs that are exchanged."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ....model.robot import Joint
from ...subjects.convention import BASE_V, Convention
from ...subjects.layout import product, rotations, transposed
from ...subjects.questions import QUESTIONS
from ..case import Case, States, View
from ..description import Description
from ..hypothesis import Hypothesis, reordered
from .register import ALL, READINGS, WEIGHED, proposer
from .writing import orders

Change = Callable[[View, States], States]
"""Of the subject's own columns: those that are replaced."""


def passed(view: View, change: Change) -> States:
    """The states, where the subject takes other numbers in its own columns for those that it was given."""
    theirs = view.layout.states(view.states)
    return {**view.states, **view.layout.back({**theirs, **change(view, theirs)})}


def _taking(*inputs: str) -> tuple[str, ...]:
    """The terms of which these are inputs."""
    return tuple(t for t in ALL if set(inputs) <= set(QUESTIONS[t].inputs))


def _columns(how: Convention) -> tuple[np.ndarray, np.ndarray]:
    """The places of joints of one coordinate in the subject's q and v, in the order of v."""
    alike = [n for n in how.v if n in how.q]
    return np.array([how.q.index(n) for n in alike], int), np.array([how.v.index(n) for n in alike], int)


def _taken(of: str, what: str, how: Convention, theirs: States) -> np.ndarray:
    """What stands in the place of an input if another one is taken for it: positions of joints alone."""
    if "q" not in (of, what):
        return theirs[of]
    q, v = _columns(how)
    x = theirs[what].copy()
    x[:, q if what == "q" else v] = theirs[of][:, q if of == "q" else v]
    return x


SWAPS = (("v", "a"), ("v", "tau"), ("q", "v"), ("q", "a"), ("q", "tau"))


@proposer("inputs_swapped", "two inputs are in each other's place", "pass q, v, a (or tau) in the order of the call")
def inputs_swapped(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(a: str, b: str) -> Hypothesis:
        def change(view: View, s: States) -> States:
            return {a: _taken(b, a, view.layout.how, s), b: _taken(a, b, view.layout.how, s)}

        return replace(
            h, terms=_taking(a, b), place="state", act=lambda view: passed(view, change), values=f"{a} and {b}",
            cost=1.1, of_a_call=True,
        )  # fmt: skip

    return [one(*pair) for pair in SWAPS]


@proposer("input_instead", "an input is another, or has the other sign", "pass the input that it is a function of")
def input_instead(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str, change: Change, terms: tuple[str, ...]) -> Hypothesis:
        return replace(
            h, terms=terms, place="state", act=lambda view: passed(view, change), values=words, cost=1.15,
            of_a_call=True,
        )  # fmt: skip

    def another(of: str, what: str) -> Change:
        return lambda view, s: {what: _taken(of, what, view.layout.how, s)}

    def opposite(*what: str) -> Change:
        def change(view: View, s: States) -> States:
            at = _columns(view.layout.how)[0]
            return {k: _negative(s[k], at) if k == "q" else -s[k] for k in what}

        return change

    found = [
        one(f"{of} in the place of {what}", another(of, what), _taking(of, what))
        for pair in SWAPS for of, what in (pair, pair[::-1])
    ]  # fmt: skip
    found.append(one("zero in the place of tau", lambda view, s: {"tau": 0 * s["tau"]}, _taking("tau")))
    found += [one(f"{what} with the other sign", opposite(what), _taking(what)) for what in ("q", "v", "a", "tau")]
    return [*found, one("q, v, a and tau with the other sign", opposite("q", "v", "a", "tau"), ALL)]


def _negative(q: np.ndarray, at: np.ndarray) -> np.ndarray:
    q = q.copy()
    q[:, at] *= -1
    return q


ONE_EARLY, ONE_LATE = "one column too early, the first one twice", "one column too late, the last one twice"


def _places(case: Case) -> dict[tuple[int, ...], str]:
    """Other orders of joints of one coordinate, as the subject has its columns."""
    names = [case.how.v[k] for k in _columns(case.how)[1]]
    found: dict[tuple[int, ...], str] = {}
    count = len(names)
    early, late = ([min(max(k + step, 0), count - 1) for k in range(count)] for step in (-1, 1))
    known = {words: [names.index(n) for n in some] for words, some in orders(case.description, names).items()}
    for words, order in {**known, ONE_EARLY: early, ONE_LATE: late, "the first one for all": [0] * count}.items():
        if order != list(range(count)) and len(order) == count:
            found.setdefault(tuple(order), words)
    return found


@proposer(
    "input_order", "an input is read in another order than the others and the answers",
    "count the columns of q, v, a and tau alike", late=READINGS,
)  # fmt: skip
def input_order(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(order: tuple[int, ...], words: str, inputs: tuple[str, ...]) -> Hypothesis:
        def change(view: View, s: States) -> States:
            q, v = _columns(view.layout.how)
            found = {k: s[k].copy() for k in inputs}
            for k, x in found.items():
                at = q if k == "q" else v
                x[:, at] = s[k][:, at[list(order)]]
            return found

        return replace(
            h, terms=_taking(*inputs) if len(inputs) == 1 else ALL, place="state", cost=1.15, of_a_call=True,
            act=lambda view: passed(view, change), values=f"{', '.join(inputs)}: {words}",
        )  # fmt: skip

    each = (("q",), ("v",), ("a",), ("tau",), ("q", "v", "a", "tau"))
    return [one(order, words, inputs) for order, words in _places(case).items() for inputs in each]


@proposer(
    "answer_order", "answers are written in another order than the inputs are read",
    "write joint k's torque, or column, in place k", late=READINGS,
)  # fmt: skip
def answer_order(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(order: tuple[int, ...], words: str) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            at, out = _columns(view.layout.how)[1], x.copy()
            there = at[list(order)]
            out[..., at] = x[..., there]
            if QUESTIONS[term].form in SQUARE:
                out[..., at, :] = out[..., there, :]
            return out

        return replace(h, terms=OF_JOINTS, place="answer", act=act, values=words, cost=1.15, of_a_call=True)

    return [one(order, words) for order, words in _places(case).items()]


SQUARE = ("matrix", "inverse", "coriolis")
BY_JOINTS = (*SQUARE, "force", "bias", "acceleration", "columns", "six", "six_rate")
OF_JOINTS = tuple(t for t in ALL if QUESTIONS[t].form.removeprefix("pushed_") in BY_JOINTS)
"""Terms whose last axis is that of velocities."""


ZEROS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "the lower limit": lambda low, high: low, "the upper limit": lambda low, high: high,
    "the middle between the limits": lambda low, high: (low + high) / 2,
}  # fmt: skip


@proposer(
    "zero_position", "positions of joints are counted from their limits", "take positions as they are", late=READINGS
)
def zero_position(h: Hypothesis, case: Case) -> list[Hypothesis]:
    low, high = case.robot.lower, case.robot.upper
    finite = np.isfinite(low) & np.isfinite(high)

    def one(words: str, sign: float) -> Hypothesis:
        def act(view: View) -> States:
            zero = np.where(finite, ZEROS[words](np.where(finite, low, 0.0), np.where(finite, high, 0.0)), 0.0)
            return {**view.states, "q": view.states["q"] + sign * zero}

        values = f"{words}{'' if sign < 0 else ', added'}"
        return replace(h, terms=ALL, place="state", act=act, values=values, cost=1.15)

    return [one(words, sign) for words in ZEROS for sign in (-1.0, 1.0)] if finite.any() else []


@proposer("wrapped", "positions are wrapped", "wrap angles alone, to a full turn, or take positions as they are")
def wrapped(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """Angles to half a turn, or what slides as if it were an angle."""
    free = [j for j in case.robot if j.mimic is None and j.model.additive and j.model.nv == 1]
    slides = [j for j in free if j.model.coordinates == ("length",)]

    def one(words: str, joints: Sequence[Joint], turn: float, first: float, cost: float) -> Hypothesis:
        def act(view: View) -> States:
            q = view.states["q"].copy()
            for j in joints:
                q[:, j.q] = first + np.mod(q[:, j.q] - first, turn)
            return {**view.states, "q": q}

        return replace(h, terms=ALL, place="state", act=act, values=words, cost=cost)

    groups = {"of all joints": free, "of joints that turn": [j for j in free if j not in slides]}
    half = [
        one(f"those {name}, to half a turn from {first / np.pi:g} pi", joints, np.pi, first, 1.15)
        for name, joints in groups.items() for first in (0.0, -np.pi / 2) if joints
    ]  # fmt: skip
    whole = [
        one(f"those of sliding joints, to a full turn from {first / np.pi:g} pi", slides, 2 * np.pi, first, 1.1)
        for first in (-np.pi, 0.0) if slides
    ]  # fmt: skip
    return half + whole


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
