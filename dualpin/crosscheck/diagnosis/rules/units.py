"""Numbers of the file that are rounded, and axes of joints with other components."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ..case import Case
from ..description import Body, Description, Part, fixed_axes
from ..hypothesis import Hypothesis
from .origins import CYCLED, PLACES
from .register import ALL, changes, joint_rule, proposer

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


@proposer(
    "axis_order", "components of <axis> are swapped, or have the other sign", "read x y z in order, with their signs"
)
def axis_order(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def edit(P: np.ndarray) -> Edit:
        return lambda d, items: d.with_parts(lambda p, _: replace(p, axis=P @ p.unit_axis) if p.axial else p)

    turns = {w: P for w, P in (PLACES | CYCLED).items() if abs(np.linalg.det(P)) > 0.5}
    return _variants(h, ALL, {w: edit(P) for w, P in turns.items()}, case, cost=1.15)


@proposer("file_digits", "numbers of the file are rounded", "read and keep all digits of the file")
def file_digits(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def edit(f: Callable[[np.ndarray], np.ndarray], numbers: bool = True) -> Edit:
        def body(b: Body) -> Body:
            rpy = f(b.rpy)
            mass, inertia = (float(f(np.array(b.mass))), f(b.inertia)) if numbers else (b.mass, b.inertia)
            return Body(mass, f(b.com), rpy, fixed_axes(rpy), inertia)

        def part(p: Part, _: Description) -> Part:
            rpy, axis = f(p.rpy), None if p.axis is None else f(p.axis)
            return replace(p, position=f(p.position), rpy=rpy, rotation=fixed_axes(rpy), axis=axis)

        return lambda d, items: d.with_bodies(body).with_parts(part)

    kept = {f"{n} decimals": edit(partial(_decimals, n)) for n in (1, 2, 3, 4, 5, 6)}
    kept |= {f"{n} decimals, of xyz, rpy and axes alone": edit(partial(_decimals, n), False) for n in (1, 2, 3)}
    given = _numbers(case.description)
    halves = [n for n in (1, 2, 3) if any((_decimals(n, x) != np.round(x, n)).any() for x in given)]
    kept |= {f"{n} decimals, halves as NumPy rounds them": edit(partial(_by_numpy, n)) for n in halves}
    kept |= {f"{n} significant digits": edit(partial(_significant, n)) for n in (3, 4, 5, 6)}
    return _variants(h, ALL, kept, case)


def _numbers(d: Description) -> list[np.ndarray]:
    """Of the file."""
    bodies = [b for b in (d.base, *(p.body for p in d.parts)) if b is not None]
    axes = [p.axis for p in d.parts if p.axis is not None]
    of_bodies = [x for b in bodies for x in (np.array(b.mass), b.com, b.rpy, b.inertia)]
    return [*(x for p in d.parts for x in (p.position, p.rpy)), *axes, *of_bodies]


def _decimals(n: int, x: np.ndarray) -> np.ndarray:
    exact = [round(float(y), n) for y in np.ravel(x)]  # as Python rounds: NumPy takes 0.05 for a half
    return np.array(exact).reshape(np.shape(x))


def _by_numpy(n: int, x: np.ndarray) -> np.ndarray:
    return np.asarray(np.round(x, n))


def _significant(n: int, x: np.ndarray) -> np.ndarray:
    step = 10.0 ** (np.floor(np.log10(np.maximum(np.abs(x), 1e-300))) - n + 1)
    return np.where(x == 0, 0.0, np.round(x / step) * step)


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
