"""Comparison of two robots: their differences, and the effect on terms."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ArgumentError, DualpinWarning
from ...io.urdf import load
from ...model.robot import Robot
from ..identification import base_parameters
from .compare import Pair, changes
from .home import Home, carried
from .matching import matched
from .results import COORDINATES, DIFFERENT, DYNAMICS, FRAMES, IDENTICAL, RENAMED, Change, Diff, TermChange
from .terms import LARGE, comparable, terms

__all__ = ["Change", "Diff", "TermChange", "diff"]
ORDER = ("base", "gravity", "joint", "body", "limit", "link")
MOST = 60
"""Degrees of freedom up to which base parameters are found: the time grows with their cube."""


def diff(
    a: str | Path | Robot, b: str | Path | Robot, samples: int = 64, seed: int = 0, *, floating: bool = False
) -> Diff:
    """Compare two robots: kinematics, bodies, limits, names, frames, and what differs in terms.

    Joints are matched by name and, where names differ, by their place in the tree.  Screws and bodies are
    compared at zero configuration in one common frame, so that frames of links, merged links and the place of
    the base do not matter.  Moved zeros and reversed axes are recognised.

    Parameters
    ----------
    a, b : str, Path or Robot
        Names, files (URDF, xacro, MJCF) or robots.
    samples, seed : int
        Random states at which terms are compared.
    floating : bool
        Give the bases of files six degrees of freedom.

    Returns
    -------
    Diff
        ``.verdict``, ``.same``, ``.changes``, ``.terms`` (the largest change of poses, gravity, torque and M, and
        the state where it is), ``.base_parameters`` that differ, ``.to_html()``.

    Raises
    ------
    UrdfError, ArgumentError

    Notes
    -----
    Two robots of the same kinematics have the same dynamics exactly if their base parameters are equal (Gautier &
    Khalil 1990): other masses without an effect on torques are "same dynamics, other parameters".

    Examples
    --------
    >>> import dualpin as dp
    >>> arm = dp.load("ur5")
    >>> dp.diff(arm, arm).verdict
    'identical'
    >>> found = dp.diff(arm, arm.with_gravity((0, 0, -1.62)))
    >>> found.verdict, found.changes[0].says
    ('different', '(0, 0, -9.81) in a, (0, 0, -1.62) m/s^2 in b')
    """
    if not isinstance(samples, (int, np.integer)) or samples < 1:
        raise ArgumentError(f"diff: samples is {samples!r}; a whole number from 1 expected")
    names, robots = [], []
    for x in (a, b):
        names.append(x.name if isinstance(x, Robot) else str(x))
        robots.append(x if isinstance(x, Robot) else _loaded(x, floating))
    one, other = (Home(r) for r in robots)
    pair = Pair(one, other, matched(one, other))
    found = Diff(
        names[0], names[1], changes=sorted(changes(pair), key=lambda c: (not c.counts, ORDER.index(c.about), -c.amount))
    )
    found.reason = comparable(pair)
    if not found.reason:
        found.terms = {t.term: t for t in terms(pair, int(samples), int(seed))}
    found.joints = {m.a.joint.name: m.b.joint.name for m in pair.matching.joints}
    found.joints |= {j.name: None for j in robots[0] if j.name not in found.joints}
    renamed = {c.a: c.b for c in found.changes if c.about == "link" and c.what == "renamed"}
    found.links = {k: k if k in other.links else renamed.get(k) for k in one.links}
    found.verdict = _verdict(found)
    if found.verdict == DIFFERENT and not found.reason and not pair.matching.rerooted:
        found.base_parameters = _base_parameters(pair)
    found.trees = _tree(robots[0], found, 0), _tree(robots[1], found, 1)
    return found


def _loaded(name: str | Path, floating: bool) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        return load(name, floating)


def _verdict(found: Diff) -> str:
    real = [c for c in found.changes if c.counts]
    if not found.changes:
        return IDENTICAL
    if not real:
        frames = any(c.what in ("re-framed", "moved") or c.what.startswith("only in") for c in found.changes)
        return FRAMES if frames else RENAMED
    if {(c.about, c.what) for c in real} <= {("body", "mass"), ("body", "centre of mass"), ("body", "tensor")}:
        torques = [found.terms[t] for t in ("gravity", "rnea", "crba") if t in found.terms]
        if torques and all(t.scaled < LARGE for t in torques):
            return DYNAMICS
    if {c.what for c in real} <= {"other zero", "turned round"}:
        return COORDINATES
    return DIFFERENT


def _base_parameters(pair: Pair) -> dict[str, list[float]]:
    """The base parameters of a, and their values in b."""
    robot = pair.a.robot
    if robot.nv > MOST or robot.coupled or pair.b.robot.coupled:
        return {}
    mine, theirs = [], []
    for e in pair.a.edges:
        X = np.linalg.inv(pair.a.poses[e.outer])
        other = pair.matching.bodies[e.outer]
        mine.append(carried(pair.a.bodies[e.outer], X))
        theirs.append(carried(pair.b.bodies[other], X @ pair.matching.motions[other]))
    base = base_parameters(robot)
    x, y = (base.values(np.concatenate(p)) for p in (mine, theirs))
    size = float(np.abs(x).max(initial=0.0))
    return {n: [float(u), float(w)] for n, u, w in zip(base.names, x, y, strict=True) if abs(u - w) > LARGE * size}


def _tree(robot: Robot, found: Diff, side: int) -> list[dict[str, Any]]:
    """The joints of a robot in their order, each with how deep it is and what was found about it."""
    names = found.joints if side == 0 else {v: k for k, v in found.joints.items() if v}
    rows = []
    for j in robot:
        mine = j.name if side == 0 else names.get(j.name)
        about = [c for c in found.changes if c.item in (mine, j.name) and c.about in ("joint", "body", "limit")]
        rows.append({
            "name": j.name, "kind": j.kind, "depth": sum(1 for _ in j.chain) - 1, "other": names.get(j.name),
            "counts": any(c.counts for c in about) or not names.get(j.name), "says": [c.says for c in about],
        })  # fmt: skip
    return rows
