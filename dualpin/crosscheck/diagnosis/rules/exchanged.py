"""What the file says of one joint, taken for another one's: lists that are counted from different numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from ..case import Case
from ..description import Description, Part
from ..hypothesis import Hypothesis
from .register import ALL, Family, changed, proposer

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
    "count all lists of joints from the same number, in one order", late=True,
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
