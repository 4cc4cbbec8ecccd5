"""Conventions: columns, rows, axes, and what the sent numbers are taken for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ....model.joints import JointModel
from ...subjects.convention import BASE_V
from ...subjects.questions import QUESTIONS
from ..case import Case, States, View
from ..description import Description
from ..hypothesis import Hypothesis, Wording, reordered
from ..textbook.lists import by_levels
from ..textbook.lumps import listed
from .register import ALL, PUSHED, SIX, proposer, rule

OF_FRAMES = (*SIX, "frame_acceleration", *PUSHED)
OF_A_FRAME = "Jacobians, twists and wrenches of a frame"
SAY = "say so in the subject's Convention"
LINEAR = ("body", "world", "origin")
SEEN = {
    "world": "about the origin of the world", "local": "in the frame's own axes",
    "local_world_aligned": "at the frame, in world axes",
}  # fmt: skip
STANDS = {
    "body": "in its own axes", "world": "in world axes", "origin": "of the point at the origin of the world"
}  # fmt: skip


def _saying(h: Hypothesis, terms: tuple[str, ...], **words: Any) -> Hypothesis:
    def act(w: Wording) -> Wording:
        return replace(w, how=replace(w.how, **words))

    return replace(h, terms=terms, place="word", act=act)


@rule(
    "rows",
    "six-vectors have their other part first",
    f"{SAY} (rows=)",
    (*OF_FRAMES, "centroidal_momentum_matrix"),
    "word",
)
def rows(w: Wording) -> Wording:
    r = w.how.rows
    return replace(w, how=replace(w.how, rows=(*r[3:], *r[:3])))


@proposer(
    "reference_*", "Jacobians are of another reference", f"{SAY} (reference=)",
    {f"reference_{r}": f"{OF_A_FRAME} are {seen}" for r, seen in SEEN.items()},
)  # fmt: skip
def reference(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(_saying(h, OF_FRAMES, reference=r), key=f"reference_{r}", says=f"{OF_A_FRAME} are {seen}")
        for r, seen in SEEN.items() if r != case.how.reference
    ]  # fmt: skip


@proposer(
    "angular_*", "the base's angular velocity is in other axes", f"{SAY} (angular=)",
    {f"angular_{x}": f"the base's angular velocity is {STANDS[x]}" for x in LINEAR[:2]},
)  # fmt: skip
def angular(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(_saying(h, ALL, angular=x), key=f"angular_{x}", says=f"the base's angular velocity is {STANDS[x]}")
        for x in LINEAR[:2] if case.floating and x != case.how.angular
    ]  # fmt: skip


@proposer(
    "linear_*", "the base's linear velocity is another", f"{SAY} (linear=)",
    {f"linear_{x}": f"the base's linear velocity is {STANDS[x]}" for x in LINEAR},
)  # fmt: skip
def linear(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(_saying(h, ALL, linear=x), key=f"linear_{x}", says=f"the base's linear velocity is {STANDS[x]}")
        for x in LINEAR if case.floating and x != case.how.linear
    ]  # fmt: skip


@proposer(
    "base_at_com", "the base's velocity is that of its centre of mass", "give the velocity of the base link's origin"
)
def base_at_com(h: Hypothesis, case: Case) -> list[Hypothesis]:
    base = case.description.base
    if not case.floating or base is None or not base.com.any():
        return []
    point = tuple(float(x) for x in base.com)
    return [replace(h, terms=ALL, place="word", act=lambda w: replace(w, point=point))]


@proposer("quaternion", "the quaternion is read in the other order", f"{SAY} (q=): qw qx qy qz, or qx qy qz qw")
def quaternion(h: Hypothesis, case: Case) -> list[Hypothesis]:
    if not case.floating:
        return []

    def act(w: Wording) -> Wording:
        q = list(w.how.q)
        first = min(q.index(n) for n in ("qw", "qx", "qy", "qz"))
        scalar_first = q[first] == "qw"
        q[first : first + 4] = ["qx", "qy", "qz", "qw"] if scalar_first else ["qw", "qx", "qy", "qz"]
        return replace(w, how=replace(w.how, q=tuple(q)))

    last = "last" if case.how.q.index("qw") < case.how.q.index("qx") else "first"
    return [replace(h, says=f"the quaternion's scalar is {last}", terms=ALL, place="word", act=act)]


@rule(
    "base_order",
    "the base's velocity has its other part first",
    f"{SAY} (v=)",
    ALL,
    "word",
    when=lambda case: case.floating,
)
def base_order(w: Wording) -> Wording:
    v = w.how.v
    start = min(v.index(n) for n in BASE_V)
    base = v[start : start + 6]
    return replace(w, how=replace(w.how, v=(*v[:start], *base[3:], *base[:3], *v[start + 6 :])))


@proposer("order", "joints are in another order", f"{SAY} (q=, v=): names decide, so list them as the subject has them")
def order(h: Hypothesis, case: Case) -> list[Hypothesis]:
    here = [n for n in case.how.v if n in {p.joint for p, _ in case.parts()}]
    found: dict[tuple[str, ...], Hypothesis] = {tuple(here): h}
    for words, names in orders(case.description, here).items():
        if len(names) == len(here):
            act = reordered(here, names)
            found.setdefault(tuple(names), replace(h, says=f"joints are {words}", terms=ALL, place="word", act=act))
    whole = list(found.values())[1:]
    return whole + (_swapped(h, here) if len(here) <= MOST_SWAPPED else [])


MOST_SWAPPED = 12  # joints of which every pair is tried in each other's place


def _swapped(h: Hypothesis, here: Sequence[str]) -> list[Hypothesis]:
    """Two joints in each other's place."""
    out = []
    for i, a in enumerate(here):
        for b in here[i + 1 :]:
            names = [{a: b, b: a}.get(n, n) for n in here]
            act = reordered(here, names)
            out.append(
                replace(
                    h,
                    says="two joints stand in each other's place",
                    terms=ALL,
                    place="word",
                    act=act,
                    items=(a, b),
                    cost=1.6,
                )
            )
    return out


def orders(d: Description, wanted: Sequence[str]) -> dict[str, list[str]]:
    """The orders in which libraries number joints."""
    named = replace(d, listed=tuple(p.joint for p in d.parts))  # siblings by name
    turned = replace(d, listed=d.listed[::-1])
    found = {
        "in alphabetical order": sorted(p.joint for p in d.parts),
        "in the order in which the file lists them": list(d.listed),
        "in the file's order, reversed": list(d.listed)[::-1],
        "depth first, siblings by name": [p.joint for p in d.parts],
        "breadth first, siblings by name": [p.joint for p in by_levels(named).parts],
        "depth first, siblings as in the file": [p.joint for p in listed(d)],
        "breadth first, siblings as in the file": [p.joint for p in by_levels(d).parts],
        "depth first, siblings in the file's order, reversed": [p.joint for p in listed(turned)],
        "in the declared order, reversed": list(wanted)[::-1],
        "in the declared order, counted from the second": [*wanted[1:], *wanted[:1]],
        "in the declared order, the last one first": [*wanted[-1:], *wanted[:-1]],
    }
    return {words: [n for n in names if n in set(wanted)] for words, names in found.items()}


@proposer(
    "axis_sign_v",
    "the sign of joint axes counts for positions, not for velocities and forces",
    "use <axis> with its sign throughout",
)
def axis_sign_v(h: Hypothesis, case: Case) -> list[Hypothesis]:
    names = {p.joint for p, _ in case.parts() if p.axial and p.unit_axis.min() < -1e-12}
    turned = tuple(n for n in case.how.v if n in names)
    if not turned:
        return []
    each = [(n,) for n in turned] if len(turned) > 1 else []
    return [
        replace(
            h, terms=ALL, place="word", act=lambda w, t=t: replace(w, turned=tuple((n, -1.0) for n in t)),
            items=t if single else (), single=single, cost=2.0 if single else 1.0,
            values="" if single else ", ".join(turned[:6]),
        )
        for t, single in [(turned, False), *((t, True) for t in each)]
    ]  # fmt: skip


# --- what the sent numbers are taken for ---------------------------------------------------------


def _angles(case: Case, q: np.ndarray, scale: float) -> np.ndarray:
    return _scaled(case, q, "angle", scale, lambda model: True)


def _scaled(case: Case, q: np.ndarray, unit: str, scale: float, of: Callable[[JointModel], bool]) -> np.ndarray:
    """q with the coordinates of one unit, of some joints, multiplied."""
    q = q.copy()
    for j in case.robot:
        if j.mimic is None and of(j.model):
            for i, what in zip(range(j.q.start, j.q.stop), j.model.coordinates, strict=True):
                if what == unit:
                    q[:, i] *= scale
    return q


@rule("degrees", "angles are read as degrees", "pass angles in the unit that the subject reads", ALL, "state")
def degrees(view: View) -> States:
    return {**view.states, "q": _angles(view.case, view.states["q"], np.pi / 180)}


@rule(
    "degrees_rates",
    "angles, their rates and accelerations are read as degrees",
    "pass them in the unit that the subject reads",
    ALL,
    "state",
)
def degrees_rates(view: View) -> States:
    s, k = view.states, np.pi / 180
    turns = view.case.per_velocity(lambda p: 1.0 if p.turns else 0.0) > 0
    scale = np.where(turns, k, 1.0)
    return {**s, "q": _angles(view.case, s["q"], k), "v": s["v"] * scale, "a": s["a"] * scale}


@rule("degrees", "all coordinates are read as degrees, lengths too", "pass lengths in metres", ALL, "state", cost=1.1,
      when=lambda case: any(p.slides for p, _ in case.parts()))  # fmt: skip
def degrees_everywhere(view: View) -> States:
    base = 7 if view.case.floating else 0
    q = view.states["q"].copy()
    q[:, base:] *= np.pi / 180
    return {**view.states, "q": q}


REVERSED = "pass angles as they are; a positive one turns by the right-hand rule, R = 1 + sin q [z] + (1 - cos q) [z]^2"


@proposer("angles_scale", "angles are multiplied by a number", "pass angles in radians, as the joint turns")
def angles_scale(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str, k: float) -> Hypothesis:
        def act(view: View) -> States:
            return {**view.states, "q": _angles(view.case, view.states["q"], k)}

        return replace(h, terms=ALL, place="state", act=act, values=words, cost=1.1, fix=REVERSED if k < 0 else h.fix)

    coarse = {f"{k} / pi": float(k) / np.pi for k in ("3", "3.14", "3.1416", "3.14159")}
    scales = {"-1": -1.0, "1/2": 0.5, "2": 2.0, "180/pi": 180 / np.pi, **coarse}
    return [one(words, k) for words, k in scales.items()]


@rule(
    "millimetres", "positions of sliding joints are read as millimetres", "pass lengths in metres", ALL, "state",
    when=lambda case: any(p.slides for p, _ in case.parts()),
)  # fmt: skip
def millimetres(view: View) -> States:
    q = _scaled(view.case, view.states["q"], "length", 1e-3, lambda model: model.additive)  # not of bases that move
    return {**view.states, "q": q}


@rule(
    "v_ignored",
    "velocities are ignored",
    "pass v, and use it",
    tuple(t for t in ALL if "v" in QUESTIONS[t].inputs),
    "state",
    cost=0.95,  # plainer than a step without velocities, where other terms do use them
    of_a_call=True,
)
def v_ignored(view: View) -> States:
    return {**view.states, "v": 0 * view.states["v"]}


@rule("a_ignored", "accelerations are ignored", "pass a, and use it",
      tuple(t for t in ALL if "a" in QUESTIONS[t].inputs), "state")  # fmt: skip
def a_ignored(view: View) -> States:
    return {**view.states, "a": 0 * view.states["a"]}


@proposer("clipped", "positions are cut", "take positions as they are passed")
def clipped(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """To the file's limits, or to others."""
    low, high = case.robot.lower, case.robot.upper
    found: dict[str, tuple[Any, Any]] = {"to the file's limits": (low, high)} if (low > -np.inf).any() else {}
    if not case.floating:
        found |= {f"to -{words} .. {words}": (-x, x) for words, x in (("1", 1.0), ("pi/2", np.pi / 2), ("pi", np.pi))}

    def one(words: str, ends: tuple[Any, Any]) -> Hypothesis:
        def act(view: View) -> States:
            return {**view.states, "q": np.clip(view.states["q"], *ends)}

        return replace(h, terms=ALL, place="state", act=act, values=words, cost=1.1)

    return [one(words, ends) for words, ends in found.items()]


@rule("q_ignored", "positions are ignored", "pass q, and use it", ALL, "state", cost=1.2)
def q_ignored(view: View) -> States:
    n = len(view.states["q"])
    return {**view.states, "q": np.broadcast_to(view.robot.neutral, (n, view.robot.nq)).copy()}


@rule(
    "q_ignored", "positions of joints are ignored", "pass q, and use it", ALL, "state", cost=1.1,
    when=lambda case: case.floating,
)  # fmt: skip
def q_of_joints_ignored(view: View) -> States:
    q = view.states["q"].copy()
    q[:, 7:] = view.robot.neutral[7:]
    return {**view.states, "q": q}


@proposer("single_precision", "the states are rounded to single precision", "pass arrays of doubles")
def states_in_single_precision(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def rounded(*which: str) -> Callable[[View], States]:
        return lambda view: {
            k: np.asarray(x, np.float32).astype(float) if not which or k in which else x for k, x in view.states.items()
        }

    whole = replace(h, terms=ALL, place="state", cost=1.1, act=rounded())
    parts = {"positions alone": "q", "velocities alone": "v"}
    return [whole] + [replace(whole, values=words, act=rounded(k), cost=1.15) for words, k in parts.items()]


def _mimics(case: Case) -> bool:
    return not case.robot.coupled and bool(case.description.mimics)


@proposer(
    "mimic", "joints with <mimic> follow their leader", "pass the followers' coordinates as they are, or say mimic=True"
)
def mimic(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str) -> Hypothesis:
        def act(view: View) -> States:
            q = view.states["q"].copy()
            for name, (leader, k, b) in case.description.mimics.items():
                multiplier, offset = FOLLOWING[words](k, b)
                q[:, case.robot.joint(name).q] = multiplier * q[:, case.robot.joint(leader).q] + offset
            return {**view.states, "q": q}

        return replace(h, terms=ALL, place="state", act=act, values=words)

    return [one(words) for words in FOLLOWING] if _mimics(case) else []


FOLLOWING: dict[str, Callable[[float, float], tuple[float, float]]] = {
    "": lambda k, b: (k, b),
    "without the offset": lambda k, b: (k, 0.0),
    "without the multiplier": lambda k, b: (1.0, b),
    "without multiplier and offset": lambda k, b: (1.0, 0.0),
    "divided by the multiplier": lambda k, b: (1 / (k or 1.0), b),
    "with the other sign of the multiplier": lambda k, b: (-k, b),
    "with the other sign of the offset": lambda k, b: (k, -b),
    "with the offset multiplied too": lambda k, b: (k, k * b),
}
"""Multiplier and offset with which a joint follows another."""
