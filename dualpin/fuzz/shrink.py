"""Minimise a robot that shows a difference (delta debugging; Zeller & Hildebrandt 2002)."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from .spec import GROUND, JointSpec, Spec

ORIGIN = (0.0, 0.0, 0.0)
Stage = Callable[[Spec], Iterator[Spec]]

PLAIN = JointSpec("revolute")
KINDS = {"fixed": 0, "revolute": 1}
"""Simplicity of joint types; types not listed are less simple."""

SECONDS = 60.0
"""Limits of minimising one robot."""


def shrink(spec: Spec, shows: Callable[[Spec], bool], seconds: float = SECONDS) -> Spec:
    """The smallest robot found for which `shows` is true.

    Joints are removed, in halves and one by one; the rest is simplified: no offset, no rotation, a coordinate axis,
    no products of inertia, round numbers.  A step is kept only if `shows` is still true.

    Parameters
    ----------
    spec : Spec
    shows : callable
        Of a robot; it must be true of `spec`.
    seconds : float
        After which no more steps are tried.

    Returns
    -------
    Spec

    Examples
    --------
    >>> from dualpin.fuzz import random_spec, shrink
    >>> small = shrink(random_spec(7, 3), lambda s: any(j.mass > 0 for j in s.joints))
    >>> len(small.joints)
    1
    """
    until = time.monotonic() + seconds
    before = None
    while spec != before:
        before = spec
        for stage in (_fewer, _bypassed, _plain):
            spec = _through(stage, spec, shows, until)
    return spec


def _through(stage: Stage, spec: Spec, shows: Callable[[Spec], bool], until: float) -> Spec:
    """One kind of steps, until none of them shows it any more."""
    changed = True
    while changed:
        changed = False
        for smaller in stage(spec):
            if time.monotonic() > until:
                return spec
            if _size(smaller) < _size(spec) and shows(smaller):
                spec, changed = smaller, True
                break
    return spec


def _size(spec: Spec) -> tuple[int, int, int]:
    """Joints, deviations from a simple joint, digits of all numbers.  Each step decreases it, so the search ends."""
    odd = sum(vars(j)[k] != x for j in spec.joints for k, x in vars(PLAIN).items())
    kinds = sum(KINDS.get(j.type, 2) for j in spec.joints)
    digits = sum(len(repr(x)) for j in spec.joints for x in vars(j).values()) + len(repr(spec.gravity))
    return len(spec.joints), odd + kinds, digits


def _fewer(spec: Spec) -> Iterator[Spec]:
    """Without half of the joints, or one, and their subtrees."""
    n = len(spec.joints)
    if n > 1:
        yield from (spec.without(set(half)) for half in (range(n // 2, n), range(n // 2)))
        yield from (spec.without({i}) for i in reversed(range(n)))


def _bypassed(spec: Spec) -> Iterator[Spec]:
    """Without a joint, its children attached to its parent; or with a fixed joint in its place."""
    for i, j in enumerate(spec.joints):
        if len(spec.joints) > 1:
            around = [replace(k, on=j.on) if k.on == i else k for k in spec.joints]
            yield replace(spec, joints=tuple(around)).without({i})
        if j.type != "fixed":
            free = [replace(k, leader=GROUND) if k.leader == i else k for k in spec.joints]
            yield replace(spec, joints=tuple(free)).with_joint(i, replace(j, type="fixed", leader=GROUND))


def _plain(spec: Spec) -> Iterator[Spec]:
    """With plainer numbers."""
    for i, j in enumerate(spec.joints):
        yield from (spec.with_joint(i, plainer) for plainer in _plainer(j))
    yield replace(spec, gravity=(0.0, 0.0, -9.81))
    yield replace(spec, gravity=ORIGIN)


def _plainer(j: JointSpec) -> Iterator[JointSpec]:
    """A joint and body with one thing less."""
    if j.type not in ("revolute", "fixed"):
        yield replace(j, type="revolute")
    yield replace(j, mass=0.0, com=ORIGIN, tensor=(0.0,) * 6)
    yield replace(j, leader=GROUND, multiplier=1.0, offset=0.0)
    yield replace(j, offset=0.0)
    yield replace(j, armature=0.0)
    yield replace(j, pitch=0.0)
    yield replace(j, xyz=ORIGIN)
    yield replace(j, turn=ORIGIN)
    yield replace(j, com=ORIGIN)
    for axis in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        yield replace(j, axis=axis)
    xx, _, _, yy, _, zz = j.tensor
    yield replace(j, tensor=(0.0,) * 6)
    yield replace(j, tensor=(xx, 0.0, 0.0, yy, 0.0, zz))
    yield replace(j, mass=1.0)
    for digits in (1, 2, 4):
        rounded: dict[str, Any] = {k: _rounded(x, digits) for k, x in vars(j).items() if isinstance(x, (float, tuple))}
        yield replace(j, **rounded)
        yield from (replace(j, **{k: x}) for k, x in rounded.items())


def _rounded(x: float | tuple[float, ...], digits: int) -> float | tuple[float, ...]:
    """To so many significant digits."""
    return tuple(float(f"{y:.{digits}g}") for y in x) if isinstance(x, tuple) else float(f"{x:.{digits}g}")
