"""Joints that do not move as their type and <axis> say: not at all, otherwise, or by another share."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ...subjects.questions import QUESTIONS
from ..case import Case, States, View
from ..description import Description, Part
from ..hypothesis import Hypothesis, Wording
from .register import ALL, Family, changed, proposer

Chosen = Callable[[Part], bool]
TYPE = (
    "handle every type of joint: continuous ones turn as revolute ones do, prismatic ones slide, fixed ones stand still"
)
LENGTH = "divide <axis> by its length, wherever it is used"
X, Y, Z = np.eye(3)


def _of(*types: str) -> Chosen:
    return lambda p: p.type in types


GROUPS: dict[str, Chosen] = {
    "continuous joints": _of("continuous"), "revolute joints": _of("revolute"), "prismatic joints": _of("prismatic"),
    "continuous and prismatic joints": _of("continuous", "prismatic"),
    "joints that turn, revolute and continuous,": _of("revolute", "continuous"),
    "joints without <axis>": lambda p: p.axial and p.axis is None,
    "joints that follow others": lambda p: p.axial and p.mimic is not None,
}  # fmt: skip
"""Joints that a code may treat in a way of their own."""


def _families(h: Hypothesis, case: Case, of: str, change: Callable[[Part], Part], cost: float) -> Iterable[Hypothesis]:
    """A change of the joints of each group, of all of them and of each, where others move as they should."""
    for words, chosen in GROUPS.items():

        def edit(d: Description, items: Sequence[str], chosen: Chosen = chosen) -> Description:
            return d.with_parts(lambda p, _: change(p) if chosen(p) else p, items)

        def items(d: Description, chosen: Chosen = chosen) -> list[str]:
            found = [p.joint for p in d.parts if chosen(p) and p.axial]
            return found if len(found) < sum(p.moves for p in d.parts) else []

        yield from Family(h.key, of.format(words), h.fix, ALL, cost, edit, items, singles=" and " not in words)(case)


@proposer("joint_still", "joints of a type do not move, as if they were fixed", TYPE)
def still(h: Hypothesis, case: Case) -> Iterable[Hypothesis]:
    yield from _families(h, case, "{} do not move, as if they were fixed", lambda p: replace(p, rate=0.0), 1.0)
    for kind in ("planar", "floating"):
        names = [p.joint for p, _ in case.parts() if p.type == kind]
        if names:
            says = f"{kind} joints do not move, as if they were fixed"
            yield replace(h, says=says, terms=ALL, place="formula", act=partial(_without, names))


def _without(names: Sequence[str], view: View, term: str) -> np.ndarray:
    """A term where these joints, of several coordinates each, are in their neutral position and have no columns."""
    s, question = _held(names, view, ("q", "v", "a")), QUESTIONS[term]
    x = view.compute(term, view.layout.how.reference, **{k: s[k] for k in question.inputs if k in s}).copy()
    if question.form in ("plain", "twist"):
        return x
    at = [k for j in view.robot if j.name in names for k in range(j.v.start, j.v.stop)]
    x[..., at] = 0.0
    if question.form in ("matrix", "coriolis"):
        x[..., at, :] = 0.0
    return x


def _held(names: Sequence[str], view: View, what: Sequence[str]) -> States:
    """The states, with these joints in their neutral position, or at rest."""
    s = {k: x.copy() for k, x in view.states.items()}
    for j in (j for j in view.robot if j.name in names and j.mimic is None):
        for k in what:
            s[k][:, j.q if k == "q" else j.v] = j.model.neutral if k == "q" else 0.0
    return s


INPUTS = {"positions": ("q",), "positions and velocities": ("q", "v"), "positions, velocities and accelerations":
          ("q", "v", "a"), "velocities": ("v",)}  # fmt: skip


@proposer(
    "joint_unread",
    "positions or velocities of some joints are not used, as if they were zero",
    "use those of all joints",
)
def unread(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str, names: Sequence[str], what: str, cost: float, alone: bool = False) -> Hypothesis:
        return replace(
            h, says=f"{what} of {words} are not used, as if they were zero", terms=ALL, place="state", cost=cost,
            act=lambda view: _held(names, view, INPUTS[what]), items=tuple(names) if alone else (), single=alone,
        )  # fmt: skip

    own = [p for p, _ in case.parts()]
    found = []
    kinds = {**GROUPS, "planar joints": _of("planar"), "floating joints": _of("floating")}
    for what in INPUTS:
        for words, chosen in kinds.items():
            names = [p.joint for p in own if chosen(p)]
            if names and len(names) < len(own):
                found.append(one(words, names, what, 1.1))
        if what != "velocities" and len(own) <= MOST:
            found += [one("a joint", [p.joint], what, 2.1, alone=True) for p in own]
    return found


MOST = 40  # joints of which each is tried alone


# --- another kind of motion ----------------------------------------------------------------------


def _slides(p: Part, axis: np.ndarray | None = None) -> Part:
    return replace(p, type="prismatic", axis=p.axis if axis is None else axis)


def _turns(p: Part, axis: np.ndarray | None = None) -> Part:
    return replace(p, type="revolute", axis=p.axis if axis is None else axis)


def _about(p: Part, axis: np.ndarray) -> Part:
    return replace(p, axis=axis)


OTHERWISE: dict[str, tuple[Chosen, Callable[..., Part]]] = {
    "continuous joints slide": (_of("continuous"), _slides),
    "revolute joints slide": (_of("revolute"), _slides),
    "joints that turn, revolute and continuous, slide": (_of("revolute", "continuous"), _slides),
    **{
        f"{words}, <axis> ignored": (chosen, partial(change, axis=axis))
        for name, axis in (("x", X), ("z", Z))
        for words, chosen, change in (
            (f"prismatic joints turn about {name}", _of("prismatic"), _turns),
            (f"continuous joints slide along {name}", _of("continuous"), _slides),
            (f"continuous joints turn about {name}", _of("continuous"), _about),
            (f"revolute joints turn about {name}", _of("revolute"), _about),
            (f"prismatic joints slide along {name}", _of("prismatic"), _about),
        )
    },
}  # fmt: skip


@proposer("joint_type", "joints of a type move otherwise, as those of another", TYPE)
def otherwise(h: Hypothesis, case: Case) -> Iterable[Hypothesis]:
    for words, (chosen, change) in OTHERWISE.items():

        def edit(
            d: Description, items: Sequence[str], chosen: Chosen = chosen, change: Callable[..., Part] = change
        ) -> Description:
            return d.with_parts(lambda p, _: change(p) if chosen(p) else p, items)

        def items(d: Description, edit: Callable[..., Description] = edit) -> list[str]:
            return [a.joint for a, b in zip(d.parts, edit(d, ()).parts, strict=True) if changed(a, b)]

        yield from Family(h.key, words, h.fix, ALL, 1.1, edit, items, singles=False)(case)


# --- axes of another length ----------------------------------------------------------------------


LENGTHS: dict[str, Callable[[np.ndarray], float]] = {
    "is not divided by its length": lambda a: float(np.linalg.norm(a)),
    "is divided by its length squared": lambda a: 1.0 / float(np.linalg.norm(a)),
    "is divided by the sum of its components": lambda a: float(np.linalg.norm(a) / np.abs(a).sum()),
    "is divided by its largest component": lambda a: float(np.linalg.norm(a) / np.abs(a).max()),
}


@proposer("axis_length", "<axis> is not made a unit vector", LENGTH)
def axis_length(h: Hypothesis, case: Case) -> Iterable[Hypothesis]:
    """A coordinate then moves the joint by |a| of it."""
    for words, size in LENGTHS.items():
        rates = {
            p.joint: k for p in case.description.parts
            if p.axial and p.axis is not None and abs((k := size(p.axis)) - 1.0) > 1e-12
        }  # fmt: skip
        if not rates:
            continue
        says = f"<axis> {words}"

        def edit(d: Description, items: Sequence[str], rates: dict[str, float] = rates) -> Description:
            return d.with_parts(lambda part, _: replace(part, rate=rates.get(part.joint, 1.0)))

        def word(w: Wording, rates: dict[str, float] = rates) -> Wording:
            return replace(w, turned=tuple((n, 1.0 / k) for n, k in rates.items() if n in w.how.v))

        def state(view: View, rates: dict[str, float] = rates) -> States:
            q = view.states["q"].copy()
            for j in (j for j in view.robot if j.mimic is None and j.name in rates):
                q[:, j.q] *= rates[j.name]
            return {**view.states, "q": q}

        yield replace(h, says=says, terms=ALL, place="edit", act=edit)
        yield replace(h, says=f"{says}, in velocities and forces", terms=ALL, place="word", act=word, cost=1.1)
        yield replace(h, says=f"{says}, in positions", terms=ALL, place="state", act=state, cost=1.1)
