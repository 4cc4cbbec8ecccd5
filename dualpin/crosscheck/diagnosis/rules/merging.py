"""Mistakes in merging what fixed joints hold together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ....spatial.inertia import steiner
from ..case import Case
from ..description import Body, Description, Part, homogeneous
from ..hypothesis import Hypothesis
from .register import INERTIAL, MASSIVE, READINGS, changes, joint_rule, proposer

MERGE = "carry the inertia of a fixed link by the whole pose of its joint: R I R^T, then Steiner"


def _held(p: Part) -> bool:
    return not p.moves and p.body is not None and p.body.mass > 0


@joint_rule("fixed_dropped", "the inertia of fixed links is dropped", "count the links on fixed joints", INERTIAL)
def fixed_dropped(p: Part, d: Description) -> Part:
    return replace(p, body=None) if _held(p) else p


@joint_rule("fixed_dropped", "the inertia of fixed links that hang on fixed links is dropped",
            "count the links on fixed joints, and those behind them", INERTIAL, cost=1.05)  # fmt: skip
def fixed_behind_dropped(p: Part, d: Description) -> Part:
    on = d.part_of_link(p.parent)
    return replace(p, body=None) if _held(p) and on is not None and not on.moves else p


@joint_rule("fixed_twice", "the inertia of fixed links is counted twice", "count each link once", INERTIAL, cost=1.05)
def fixed_twice(p: Part, d: Description) -> Part:
    return _standing(p, lambda b: replace(b, mass=2 * b.mass, inertia=2 * b.inertia))


@joint_rule("fixed_points", "fixed links are merged as points, without their own tensor", "add R I R^T of each link",
            MASSIVE, cost=1.05)  # fmt: skip
def fixed_points(p: Part, d: Description) -> Part:
    return _standing(p, lambda b: replace(b, inertia=0 * b.inertia))


def _standing(p: Part, change: Callable[[Body], Body]) -> Part:
    return replace(p, body=change(p.body)) if _held(p) and p.body is not None else p


def _unturned(p: Part) -> Part:
    return _standing(p, lambda b: replace(b, com=p.rotation.T @ b.com, rotation=p.rotation.T @ b.rotation))


def _unshifted(p: Part) -> Part:
    return _standing(p, lambda b: replace(b, com=b.com - p.rotation.T @ p.position))


@joint_rule("merge_turn", "fixed links' inertia is merged without the joint's rotation", MERGE, INERTIAL)
def merge_turn(p: Part, d: Description) -> Part:
    return _unturned(p)


@joint_rule("merge_shift", "fixed links' inertia is merged without the joint's translation", MERGE, INERTIAL)
def merge_shift(p: Part, d: Description) -> Part:
    return _unshifted(p)


@joint_rule("merge_both", "fixed links' inertia is merged without the joint's placement", MERGE, INERTIAL)
def merge_both(p: Part, d: Description) -> Part:
    unshifted = _unshifted(p)
    return replace(unshifted, body=_unturned(unshifted).body)


@joint_rule(
    "merge_tensor_unturned", "fixed links' inertia tensor is merged without the joint's rotation, their centre with it",
    MERGE, MASSIVE,
)  # fmt: skip
def merge_tensor_unturned(p: Part, d: Description) -> Part:
    return _standing(p, lambda b: replace(b, rotation=p.rotation.T @ b.rotation))


@proposer(
    "merge_steiner",
    "bodies of several links are merged without Steiner's term",
    "merging adds m (r.r 1 - r r^T) of each link",
)
def merge_steiner(h: Hypothesis, case: object) -> list[Hypothesis]:
    """Inertias about their own centres are simply added: each lacks Steiner's term to the common centre."""

    def edit(d: Description, items: Sequence[str]) -> Description:
        where = d.carried()
        mass: dict[str, float] = {}
        moment: dict[str, np.ndarray] = {}
        for p in d.parts:
            if p.body is not None:
                carrier, H = where[p.link]
                mass[carrier] = mass.get(carrier, 0.0) + p.body.mass
                c = (H @ np.append(p.body.com, 1.0))[:3]
                moment[carrier] = moment.get(carrier, np.zeros(3)) + p.body.mass * c

        def part(p: Part, _: Description) -> Part:
            if p.body is None:
                return p
            carrier, H = where[p.link]
            if not mass[carrier] > 0:
                return p
            centre = (np.linalg.inv(H) @ np.append(moment[carrier] / mass[carrier], 1.0))[:3]
            lost = steiner(p.body.mass, p.body.com - centre)
            return replace(p, body=p.body.turned(p.body.in_link - lost)) if np.abs(lost).max() > 1e-13 else p

        return d.with_parts(part)

    return [replace(h, place="edit", act=edit, terms=MASSIVE)]


def _chained(breadth: bool, names: tuple[str, ...]) -> Callable[[Description, Sequence[str]], Description]:
    """Fixed links of one body placed one after another, as if each were fixed to the last; `names` order siblings."""

    def edit(d: Description, items: Sequence[str]) -> Description:
        place = {name: k for k, name in enumerate(names)}
        below: dict[str, list[Part]] = {}
        for p in sorted(d.parts, key=lambda p: place.get(p.joint, place.get(p.link, 0))):
            if not p.moves:
                below.setdefault(p.parent, []).append(p)
        new: dict[str, Body] = {}
        for start in (p.link for p in d.parts if p.moves):
            true, chain, todo = {start: np.eye(4)}, np.eye(4), list(below.get(start, []))
            while todo:
                p = todo.pop(0)
                true[p.link], chain = true[p.parent] @ p.pose, chain @ p.pose
                if p.body is not None:
                    H = np.linalg.inv(true[p.link]) @ chain @ homogeneous(p.body.rotation, p.body.com)
                    new[p.link] = replace(p.body, rotation=H[:3, :3], com=H[:3, 3])
                todo = todo + below.get(p.link, []) if breadth else below.get(p.link, []) + todo
        return d.with_parts(lambda p, _: replace(p, body=new[p.link]) if p.link in new else p)

    return edit


@proposer(
    "chained", "fixed links of one body are placed one after another, as if in a chain",
    "place each fixed link on its own parent",
)  # fmt: skip
def chained(h: Hypothesis, case: Case) -> list[Hypothesis]:
    orders = {"links": case.description.links, "joints": case.description.listed}
    return [
        replace(
            h, place="edit", act=_chained(breadth, names), terms=INERTIAL,
            values=f"{'breadth' if breadth else 'depth'} first, in the order of the file's {what}",
        )
        for what, names in orders.items() for breadth in (False, True)
    ]  # fmt: skip


# --- frames of <inertial> ------------------------------------------------------------------------

Frame = Callable[[np.ndarray, np.ndarray, Body], Body]
"""Of a joint's rotation and xyz, and the body of the link that it carries."""


def _at(com: np.ndarray, rotation: np.ndarray, b: Body) -> Body:
    return replace(b, com=com, rotation=rotation)


FRAMES: dict[str, Frame] = {
    "in the frame that the joint's origin is given in": lambda R, x, b: _at(R.T @ (b.com - x), R.T @ b.rotation, b),
    "in the axes that the joint's origin is given in": lambda R, x, b: _at(R.T @ b.com, R.T @ b.rotation, b),
    "with xyz counted from where the joint's origin is counted from": lambda R, x, b: _at(
        b.com - R.T @ x, b.rotation, b
    ),
    "with the joint's xyz taken from its own": lambda R, x, b: _at(b.com - x, b.rotation, b),
    "with the joint's xyz added to its own": lambda R, x, b: _at(b.com + x, b.rotation, b),
    "moved by the joint's origin once more": lambda R, x, b: _at(R @ b.com + x, R @ b.rotation, b),
    "turned by the joint's rpy once more": lambda R, x, b: _at(R @ b.com, R @ b.rotation, b),
    "with its tensor turned by the joint's rpy once more": lambda R, x, b: _at(b.com, R @ b.rotation, b),
    "with its tensor in the axes that the joint's origin is given in": lambda R, x, b: _at(b.com, R.T @ b.rotation, b),
    "with its xyz turned by the joint's rpy once more": lambda R, x, b: _at(R @ b.com, b.rotation, b),
    "with its xyz in the axes that the joint's origin is given in": lambda R, x, b: _at(R.T @ b.com, b.rotation, b),
    "with the joint's rpy in the place of its own": lambda R, x, b: _at(b.com, R, b),
    "with the joint's xyz in the place of its own": lambda R, x, b: _at(x, b.rotation, b),
    "with the joint's origin in the place of its own": lambda R, x, b: _at(x, R, b),
}
WHICH: dict[str, Callable[[Part], bool]] = {
    "": lambda p: True, " (of links that joints move)": lambda p: p.moves, " (of fixed links)": lambda p: not p.moves,
}  # fmt: skip


@proposer(
    "inertial_frame", "<inertial> is taken in another frame", "xyz and rpy of <inertial> are given in the link's frame",
    late=READINGS,
)  # fmt: skip
def inertial_frame(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """The frame of a link is that of the joint that carries it."""
    d, found = case.description, list[Hypothesis]()
    for words, change in FRAMES.items():
        for of, chosen in WHICH.items():

            def edit(
                d: Description, items: Sequence[str], change: Frame = change, chosen: Callable[[Part], bool] = chosen
            ) -> Description:
                def part(p: Part, _: Description) -> Part:
                    b = p.body
                    return p if b is None or not chosen(p) else replace(p, body=change(p.rotation, p.position, b))

                return d.with_parts(part)

            if changes(d, edit(d, ())):
                values, cost = words + of, 1.1 + 0.05 * bool(of)
                found.append(replace(h, place="edit", act=edit, terms=INERTIAL, values=values, cost=cost))
    return found
