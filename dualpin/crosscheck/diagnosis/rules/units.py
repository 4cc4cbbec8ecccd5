"""Numbers of the file taken in other units, another order, or for another item."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import permutations

import numpy as np

from ..case import Case
from ..description import Body, Description, Part, fixed_axes
from ..hypothesis import Hypothesis
from .origins import CYCLED, PLACES
from .register import ALL, INERTIAL, MASSIVE, changes, joint_rule, proposer, robot_rule

Edit = Callable[[Description, Sequence[str]], Description]


def _variants(
    h: Hypothesis, terms: tuple[str, ...], edits: dict[str, Edit], case: Case, cost: float = 1.05
) -> list[Hypothesis]:
    """One hypothesis for each edit, in words, that changes anything."""
    return [
        replace(h, place="edit", act=edit, terms=terms, values=words, cost=cost)
        for words, edit in edits.items() if changes(case.description, edit(case.description, ()))
    ]  # fmt: skip


def _snapped(rpy: np.ndarray) -> np.ndarray:
    near = np.round(rpy / (np.pi / 4)) * (np.pi / 4)
    return np.where(np.abs(rpy - near) < 1e-3, near, rpy)


@joint_rule(
    "rpy_snapped", "rpy of joints is rounded to the nearest multiple of pi/4", "take the file's numbers as they are"
)
def rpy_snapped(p: Part, d: Description) -> Part:
    return replace(p, rotation=fixed_axes(_snapped(p.rpy)))


# --- lengths and masses --------------------------------------------------------------------------

MASSES = {"1000": 1e3, "1/1000": 1e-3, "0.45359237, pounds": 0.45359237, "1/0.45359237, to pounds": 1 / 0.45359237}


@proposer("mass_units", "masses are multiplied by a number (other units)", "give <mass> in kg")
def mass_units(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def edit(k: float) -> Edit:
        return lambda d, items: d.with_bodies(lambda b: replace(b, mass=k * b.mass))

    return _variants(h, INERTIAL, {words: edit(k) for words, k in MASSES.items()}, case)


@proposer(
    "axis_order", "components of <axis> are swapped, or have the other sign", "read x y z in order, with their signs"
)
def axis_order(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def edit(P: np.ndarray) -> Edit:
        return lambda d, items: d.with_parts(lambda p, _: replace(p, axis=P @ p.unit_axis) if p.axial else p)

    turns = {w: P for w, P in (PLACES | CYCLED).items() if abs(np.linalg.det(P)) > 0.5}
    return _variants(h, ALL, {w: edit(P) for w, P in turns.items()}, case, cost=1.15)


@proposer("products_scale", "products of inertia are multiplied by a number", "ixy, ixz, iyz are the matrix's entries")
def products_scale(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def edit(k: float) -> Edit:
        def scaled(b: Body) -> Body:
            return replace(b, inertia=k * b.inertia + (1 - k) * np.diag(np.diag(b.inertia)))

        return lambda d, items: d.with_bodies(scaled, items)

    return _variants(h, MASSIVE, {"1/2": edit(0.5), "2": edit(2.0)}, case)


@proposer("file_digits", "numbers of the file are rounded", "read and keep all digits of the file")
def file_digits(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def edit(f: Callable[[np.ndarray], np.ndarray]) -> Edit:
        def body(b: Body) -> Body:
            rpy = f(b.rpy)
            return Body(float(f(np.array(b.mass))), f(b.com), rpy, fixed_axes(rpy), f(b.inertia))

        def part(p: Part, _: Description) -> Part:
            rpy, axis = f(p.rpy), None if p.axis is None else f(p.axis)
            return replace(p, position=f(p.position), rpy=rpy, rotation=fixed_axes(rpy), axis=axis)

        return lambda d, items: d.with_bodies(body).with_parts(part)

    kept = {f"{n} decimals": edit(partial(_decimals, n)) for n in (2, 3, 4, 5, 6)}
    kept |= {f"{n} significant digits": edit(partial(_significant, n)) for n in (3, 4, 5, 6)}
    return _variants(h, ALL, kept, case)


def _decimals(n: int, x: np.ndarray) -> np.ndarray:
    return np.asarray(np.round(x, n))


def _significant(n: int, x: np.ndarray) -> np.ndarray:
    step = 10.0 ** (np.floor(np.log10(np.maximum(np.abs(x), 1e-300))) - n + 1)
    return np.where(x == 0, 0.0, np.round(x / step) * step)


@proposer("moments_swapped", "moments of inertia are in each other's place", "read ixx, iyy and izz by name")
def moments_swapped(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """But for ixx and izz, which have a rule of their own, also for single links."""

    def edit(p: Sequence[int]) -> Edit:
        def moved(b: Body) -> Body:
            d = np.diag(b.inertia)
            return replace(b, inertia=b.inertia - np.diag(d) + np.diag(d[list(p)]))

        return lambda d, items: d.with_bodies(moved, items)

    names = ("ixx", "iyy", "izz")
    orders = [p for p in permutations(range(3)) if p not in ((0, 1, 2), (2, 1, 0))]
    return _variants(h, MASSIVE, {" ".join(names[k] for k in p): edit(p) for p in orders}, case)


@proposer("inertia_entry_copied", "an entry of every <inertia> is filled with another one",
          "read ixx, ixy, ixz, iyy, iyz and izz each by its own name")  # fmt: skip
def inertia_entry_copied(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def edit(to: tuple[int, int], of: tuple[int, int]) -> Edit:
        def copied(b: Body) -> Body:
            I = b.inertia.copy()
            I[to] = I[to[::-1]] = b.inertia[of]
            return replace(b, inertia=I)

        return lambda d, items: d.with_bodies(copied, items)

    moments, mixed = [(i, i) for i in range(3)], [(0, 1), (0, 2), (1, 2)]
    pairs = [pair for entries in (moments, mixed) for pair in permutations(entries, 2)]
    words = {f"{_entry(of)} stands for {_entry(to)}": edit(to, of) for to, of in pairs}
    return _variants(h, MASSIVE, words, case, cost=1.1)


def _entry(place: tuple[int, int]) -> str:
    return "i" + "".join("xyz"[k] for k in place)


def _shifted(step: int) -> Callable[[Description], Description]:
    """In the file's order, of those that have one."""

    def edit(d: Description) -> Description:
        carried = [p for p in d.parts if p.body is not None and p.body.mass > 0]
        carried.sort(key=lambda p: d.listed.index(p.joint))
        bodies = [p.body for p in carried]
        new = {p.link: bodies[(k + step) % len(bodies)] for k, p in enumerate(carried)}
        return d.with_parts(lambda p, _: replace(p, body=new[p.link]) if p.link in new else p)

    return edit


robot_rule("inertial_shifted", "every link has the <inertial> of the next", "count links from the same number",
           INERTIAL, cost=1.1)(_shifted(1))  # fmt: skip
robot_rule("inertial_shifted", "every link has the <inertial> of the one before", "count links from the same number",
           INERTIAL, cost=1.1)(_shifted(-1))  # fmt: skip


@proposer("axis_other", "the axis of a joint is another", "read <axis> in the joint's own frame, with its sign")
def axis_other(h: Hypothesis, case: Case) -> list[Hypothesis]:
    out = []
    for p, _ in case.parts():
        for k, sign in ((k, s) for k in range(3) for s in (1.0, -1.0)):
            axis = sign * np.eye(3)[k]
            if not p.axial or np.abs(np.abs(p.unit_axis) - np.abs(axis)).max() < 1e-12:
                continue  # the file's own; reversed has a rule of its own

            def edit(d: Description, items: Sequence[str], name: str = p.joint, axis: np.ndarray = axis) -> Description:
                return d.with_parts(lambda q, _: replace(q, axis=axis) if q.joint == name else q)

            words = f"{'-' if sign < 0 else ''}{'xyz'[k]}"
            out.append(
                replace(h, place="edit", act=edit, terms=ALL, items=(p.joint,), values=words, cost=2.2, single=True)
            )
    return out if len(out) <= MOST_AXES else []


MOST_AXES = 120
