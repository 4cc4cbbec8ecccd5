"""What the file says of one joint or link, taken for another one's: lists that are counted from different numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ..case import Case
from ..description import Body, Description, Part, fixed_axes
from ..hypothesis import Hypothesis
from ..reading import shapes
from .register import ALL, INERTIAL, READINGS, Family, changed, changes, proposer

Taken = Callable[[Part, Part], Part]
"""Of a joint, and the one whose numbers it gets."""


def _axis(p: Part, other: Part) -> Part:
    return replace(p, axis=other.axis) if p.axial else p


def _turn(p: Part, other: Part) -> Part:
    return replace(p, rpy=other.rpy, rotation=other.rotation)


def _place(p: Part, other: Part) -> Part:
    return replace(p, position=other.position)


def _type(p: Part, other: Part) -> Part:
    return replace(p, type=other.type) if p.axial and other.axial else p


TAKEN: dict[str, Taken] = {
    "<axis>": _axis, "xyz": _place, "rpy": _turn, "xyz and rpy": lambda p, o: _turn(_place(p, o), o), "type": _type,
    "xyz, rpy and <axis>": lambda p, o: _axis(_turn(_place(p, o), o), o),
}  # fmt: skip


def _lists(d: Description) -> dict[str, list[Part]]:
    """The joints as codes list them; of those that are alike the first is told."""
    named = {p.joint: p for p in d.parts}
    filed = [named[n] for n in d.listed if n in named]
    found = {"in the file": filed, "along the tree": list(d.parts), "by name": sorted(d.parts, key=lambda p: p.joint)}
    moving = {f"{words}, of those that move": [p for p in ps if p.moves] for words, ps in found.items()}
    distinct: dict[tuple[str, ...], str] = {}
    for words, ps in (found | moving).items():
        distinct.setdefault(tuple(p.joint for p in ps), words)
    return {words: [named[n] for n in names] for names, words in distinct.items()}


def _others(d: Description) -> dict[str, dict[str, Part]]:
    """For each joint, by name, another one."""
    found: dict[str, dict[str, Part]] = {}
    for words, ps in _lists(d).items():
        for step, which in ((1, "the next one"), (-1, "the one before")):
            ring = {p.joint: ps[(k + step) % len(ps)] for k, p in enumerate(ps)}
            stops = {p.joint: ps[min(max(k + step, 0), len(ps) - 1)] for k, p in enumerate(ps)}
            found |= {f"of {which} {words}": ring, f"of {which} {words}; the last has its own": stops}
        found[f"of the first one {words}"] = {p.joint: ps[0] for p in ps}
        found[f"of the last one {words}"] = {p.joint: ps[-1] for p in ps}
    above = {p.link: p for p in d.parts}
    found["of the joint that carries its parent"] = {p.joint: above.get(p.parent, p) for p in d.parts}
    child = {p.parent: p for p in reversed(d.parts)}
    found["of the first joint on its link"] = {p.joint: child.get(p.link, p) for p in d.parts}
    return found


@proposer(
    "joint_exchanged", "joints have numbers of another joint",
    "count all lists of joints from the same number, in one order", late=READINGS,
)  # fmt: skip
def joint_exchanged(h: Hypothesis, case: Case) -> Iterable[Hypothesis]:
    for whose in _others(case.description):
        for what, take in TAKEN.items():

            def edit(d: Description, items: Sequence[str], whose: str = whose, take: Taken = take) -> Description:
                others = _others(d)[whose]
                return d.with_parts(lambda p, _: take(p, others.get(p.joint, p)))

            def items(d: Description, edit: Callable[..., Description] = edit) -> list[str]:
                return [a.joint for a, b in zip(d.parts, edit(d, ()).parts, strict=True) if changed(a, b)]

            yield from Family(h.key, f"joints have {what} {whose}", h.fix, ALL, 1.15, edit, items, singles=False)(case)


# --- links ---------------------------------------------------------------------------------------

Given = Callable[[Body, Body], Body]
"""Of a link's body, and the one whose numbers it gets."""
GIVEN: dict[str, Given] = {
    "<inertial>": lambda b, o: o, "<mass>": lambda b, o: replace(b, mass=o.mass),
    "<inertia>": lambda b, o: replace(b, inertia=o.inertia),
    "<origin> of <inertial>": lambda b, o: replace(b, com=o.com, rpy=o.rpy, rotation=o.rotation),
}  # fmt: skip
NOTHING = Body(0.0, np.zeros(3), np.zeros(3), np.eye(3), np.zeros((3, 3)))
Bodies = dict[str, Body]


def _bodies(d: Description) -> Bodies:
    """Of every link, with those that have none."""
    return {link: b or NOTHING for link, b in ((d.root, d.base), *((p.link, p.body) for p in d.parts))}


def _neighbours(d: Description) -> dict[str, dict[str, str]]:
    """For each link another one, by lists of all links, of those with mass, and along the tree."""
    bodies, found = _bodies(d), dict[str, dict[str, str]]()
    named = {p.joint: p.link for p in d.parts}
    of_joints = [named[j] for j in d.listed if j in named]
    lists = {"in the file": [x for x in d.links if x in bodies], "of joints in the file": of_joints,
             "along the tree": [d.root, *(p.link for p in d.parts)]}  # fmt: skip
    lists |= {f"{words}, of those that weigh something": [x for x in links if bodies[x].mass > 0]
              for words, links in lists.items()}  # fmt: skip
    for words, links in lists.items():
        if len(links) > 1:
            found[f"of the next link {words}"] = dict(zip(links, [*links[1:], links[0]], strict=True))
            found[f"of the link before {words}"] = dict(zip(links, [links[-1], *links[:-1]], strict=True))
            found[f"of the first link {words}"] = dict.fromkeys(links, links[0])
            found[f"of the last link {words}"] = dict.fromkeys(links, links[-1])
    parents = {p.link: p.parent for p in d.parts}
    found["of their parents"] = parents
    found["of their first children"] = {parents[link]: link for link in reversed(of_joints)}
    found["of their last children"] = {parents[link]: link for link in of_joints}
    return found


def _handed(others: dict[str, str], give: Given, d: Description) -> Description:
    bodies = _bodies(d)
    return _given(d, {link: give(bodies[link], bodies[other]) for link, other in others.items()})


def _given(d: Description, new: Bodies) -> Description:
    parts = tuple(replace(p, body=new[p.link]) if p.link in new else p for p in d.parts)
    return replace(d, base=new.get(d.root, d.base), parts=parts)


@proposer(
    "inertial_shifted", "links have the <inertial> of other links, or part of it", "count links from the same number",
    late=READINGS,
)  # fmt: skip
def inertial_shifted(h: Hypothesis, case: Case) -> list[Hypothesis]:
    d, found, seen = case.description, list[Hypothesis](), list[dict[str, str]]()
    for whose, others in _neighbours(d).items():
        if others in seen:
            continue
        seen.append(others)
        for what, give in GIVEN.items():
            if changes(d, _handed(others, give, d)):
                act = partial(_edited, others, give)
                says = f"links have {what} {whose}"
                found.append(replace(h, says=says, place="edit", act=act, terms=INERTIAL, cost=1.15))
    return found


def _edited(others: dict[str, str], give: Given, d: Description, items: Sequence[str]) -> Description:
    return _handed(others, give, d)


SHOWN: dict[str, Callable[[Body, np.ndarray, np.ndarray], Body]] = {
    "xyz and rpy": lambda b, xyz, rpy: replace(b, com=xyz, rpy=rpy, rotation=fixed_axes(rpy)),
    "xyz": lambda b, xyz, rpy: replace(b, com=xyz),
    "rpy": lambda b, xyz, rpy: replace(b, rpy=rpy, rotation=fixed_axes(rpy)),
}


@proposer(
    "inertial_of_shape", "the <origin> of a shape is taken for that of <inertial>",
    "look for <origin> in <inertial> itself, not among all of the link", late=READINGS,
)  # fmt: skip
def inertial_of_shape(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """Of <visual> or <collision>, the first or the last; a link without such keeps its own."""

    def one(tag: str, which: int, what: str) -> Hypothesis | None:
        origins = {link: some[which] for link, some in every[tag].items() if some}

        def edit(d: Description, items: Sequence[str]) -> Description:
            return _given(d, {x: SHOWN[what](b, *origins[x]) for x, b in _bodies(d).items() if b.mass and x in origins})

        if not changes(case.description, edit(case.description, ())):
            return None
        values = f"{what} of the {'last' if which else 'first'} <{tag}>"
        return replace(h, place="edit", act=edit, terms=INERTIAL, values=values, cost=1.1)

    every = shapes(case.asking)
    found = [one(tag, which, what) for tag in every for which in (0, -1) for what in SHOWN]
    return [x for x in found if x is not None]
