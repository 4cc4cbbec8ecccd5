"""The differences of two matched robots: joints, bodies, links, limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np

from ...model.robot import Joint
from ...spatial.inertia import Inertia
from .home import Home, carried
from .matching import Match, Matching
from .results import Change

SMALL = 1e-9
"""Relative to a length of 1 m, an angle of 1 rad, or a body's own size: rounding, also of files with ten digits."""


@dataclass(frozen=True)
class Pair:
    """Two robots with their matched parts."""

    a: Home
    b: Home
    matching: Matching


def changes(pair: Pair) -> Iterator[Change]:
    """Every difference, in the order of a's tree."""
    yield from _base(pair)
    yield from _gravity(pair)
    for m in pair.matching.joints:
        yield from _names(m)
        yield from _motion(m)
        yield from _limits(m)
    yield from _unmatched(pair)
    for node, other in pair.matching.bodies.items():
        yield from _body(pair, node, other)
    yield from _links(pair)
    yield from _order(pair)


def _base(pair: Pair) -> Iterator[Change]:
    m, ground = pair.matching, next(iter(pair.a.links), "")
    if m.rerooted:
        says = f"b stands on link {m.rerooted!r}, a on {ground!r}: what is fixed to the ground is not the same, "
        says += "and joints between them count backwards"
        yield Change("base", "other link", m.rerooted, says, ground, m.rerooted)
        return
    turn, shift = _pose(m.base)
    if turn + shift > SMALL:
        says = f"b's base stands {shift:.6g} m from a's, turned by {turn:.6g} rad"
        yield Change("base", "moved", ground, says, amount=shift + turn, counts=turn > SMALL)


def _gravity(pair: Pair) -> Iterator[Change]:
    g, h = (home.robot.gravity.array for home in (pair.a, pair.b))
    if np.abs(g - h).max() > SMALL:
        one, other = _row(g), _row(h)
        says = f"{one} in a, {other} m/s^2 in b"
        yield Change("gravity", "other", "", says, one, other, float(np.linalg.norm(g - h)))


def _names(m: Match) -> Iterator[Change]:
    j, k = m.a.joint, m.b.joint
    if m.renamed:
        yield Change("joint", "renamed", j.name, f"called {k.name!r} in b", j.name, k.name, counts=False)
    if m.sign < 0 and not m.reversed:
        yield Change("joint", "turned round", j.name, "q counts the other way round in b", "+", "-", 2.0)
    if m.sign > 0 and m.reversed:
        says = "its axis is turned round in b as well as its parent and child"
        yield Change("joint", "turned round", j.name, says, counts=False)
    if abs(m.offset) > SMALL:
        zero = f"{m.offset:.6g}"
        yield Change("joint", "other zero", j.name, f"q is {zero} here where it is 0 in b", "0", zero, abs(m.offset))
    if (j.mimic is None) != (k.mimic is None):
        yield Change("joint", "follows", j.name, f"{_leader(j)} in a, {_leader(k)} in b", _leader(j), _leader(k), 1.0)


def _leader(j: Joint) -> str:
    return f"follows {j.mimic.joint!r}" if j.mimic else "free"


def _motion(m: Match) -> Iterator[Change]:
    j, k = m.a.joint, m.b.joint
    one, other = j.kind, k.kind  # as the files call them: continuous or revolute
    words = f"{one} in a, {other} in b", one, other
    other_kind = Change("joint", "other kind", j.name, *words, 1.0)
    if m.a.screws.shape != m.screws.shape or j.model.coordinates != k.model.coordinates:
        yield other_kind
        return
    if len(m.screws) != 1:
        off = float(np.abs(m.a.screws - m.screws).max(initial=0.0))
        if off > SMALL:
            yield Change("joint", "moved", j.name, f"its motions differ by {off:.3g}", amount=off)
        return
    s, t = m.a.screws[0], m.screws[0]
    turns, turned = s[:3].any(), t[:3].any()
    if turns != turned:
        yield other_kind
        return
    u, w = (s[:3], t[:3]) if turns else (s[3:], t[3:])
    angle = float(np.arctan2(np.linalg.norm(np.cross(u, w)), u @ w))
    if angle > SMALL:
        yield Change("joint", "turned", j.name, f"its axis points {angle:.6g} rad elsewhere in b", amount=angle)
    distance = _between(s, t) if turns else 0.0
    if distance > SMALL:
        says = f"its axis lies {1e3 * distance:.6g} mm elsewhere in b"
        yield Change("joint", "moved", j.name, says, amount=distance)
    if one != other:
        yield Change("joint", "other word", j.name, *words, counts=False)


def _between(s: np.ndarray, t: np.ndarray) -> float:
    """Distance of b's line from the point of a's line that is nearest to the world's origin."""
    p = np.cross(s[:3], s[3:])
    r = np.cross(t[:3], t[3:])
    d = r - p
    return float(np.linalg.norm(d - t[:3] * (d @ t[:3])))


def _limits(m: Match) -> Iterator[Change]:
    j, k = m.a.joint, m.b.joint
    sign = -m.sign if m.reversed else m.sign
    pairs = list(zip(("lower", "upper"), _span(j), sorted(sign * e + m.offset for e in _span(k)), strict=True))
    pairs += [(n, getattr(j.limits, n), getattr(k.limits, n)) for n in ("velocity", "effort", "damping", "friction")]
    for name, one, other in pairs:
        if one != other and not abs(one - other) <= SMALL * max(1.0, abs(one)):
            amount = abs(one - other) if abs(one - other) < inf else 1.0
            says = f"{name} {one:g} in a, {other:g} in b"
            yield Change("limit", name, j.name, says, f"{one:g}", f"{other:g}", amount)
    mine, theirs = (np.array([float(v) for v in z.armature]) for z in (j, k))
    if mine.shape == theirs.shape:
        off = float(np.abs(mine - theirs).max(initial=0.0))
        if off > SMALL * max(1.0, float(mine.max(initial=0.0))):
            rows = _row(mine), _row(theirs)
            yield Change("body", "armature", j.name, f"armature {rows[0]} in a, {rows[1]} in b", *rows, off)


def _span(j: Joint) -> list[float]:
    """Its position limits, where it has one coordinate."""
    single = j.model.nq == 1
    return [v[0] if v and single else d for v, d in ((j.limits.lower, -inf), (j.limits.upper, inf))]


def _unmatched(pair: Pair) -> Iterator[Change]:
    mine = {m.a.joint.name for m in pair.matching.joints}
    theirs = {m.b.joint.name for m in pair.matching.joints}
    fixed = [{f.name for f in h.robot.frames if f.role == "fixed_joint"} for h in (pair.a, pair.b)]
    for home, known, others, here, there in ((pair.a, mine, fixed[1], "a", "b"), (pair.b, theirs, fixed[0], "b", "a")):
        for j in home.robot:
            if j.name not in known:
                what = f"{j.kind} in {here}, fixed in {there}" if j.name in others else f"only in {here} ({j.kind})"
                yield Change("joint", f"only in {here}", j.name, what, amount=1.0)


def _body(pair: Pair, node: int, other: int) -> Iterator[Change]:
    """Mass, centre and tensor of each moving body, in a's world: frames and merged links do not matter."""
    one = pair.a.bodies[node]
    two = carried(pair.b.bodies[other], pair.matching.motions[other])
    item = "the ground" if node == 0 else next((e.joint.name for e in pair.a.edges if e.outer == node), "")
    if node == 0 and not (one.any() or two.any()):
        return
    counts = node != 0  # links on the ground have no effect on the dynamics
    m, n = float(one[0]), float(two[0])
    (c, J), (d, K) = ((x.array for x in Inertia.from_array(ten).central) for ten in (one, two))
    if abs(m - n) > SMALL * max(abs(m), abs(n), 1e-3):
        says = f"mass {m:.6g} kg in a, {n:.6g} kg in b"
        yield Change("body", "mass", item, says, f"{m:.6g}", f"{n:.6g}", abs(m - n), counts)
    shift = float(np.linalg.norm(c - d))
    if m and n and shift > SMALL:
        says = f"centre of mass {1e3 * shift:.6g} mm elsewhere in b"
        yield Change("body", "centre of mass", item, says, _row(c), _row(d), shift, counts)
    size = max(float(np.abs(J).max()), float(np.abs(K).max()))
    off = float(np.abs(J - K).max())
    reach = m * float(c @ c)  # Steiner's terms cancel
    if off > SMALL * size + 1e-14 * reach and off > 1e-15:
        says = f"tensor differs by {off:.3g} kg m^2, of at most {size:.3g}"
        yield Change("body", "tensor", item, says, amount=off, counts=counts)


def _links(pair: Pair) -> Iterator[Change]:
    m, bodies = pair.matching, pair.matching.bodies
    displaced, seen = _displaced(pair), dict[int, tuple[np.ndarray, np.ndarray]]()
    for name, (node, X) in pair.a.links.items():
        if name not in pair.b.links:
            continue
        other, Y = pair.b.links[name]
        if bodies.get(node) != other:
            yield Change("link", "elsewhere", name, "it is part of another body in b", amount=1.0, counts=False)
            continue
        Z = m.motions[other] @ Y
        if node in displaced:  # its body is displaced: compare its placement relative to the other links of that body
            P, Q = seen.setdefault(node, (X, Z))
            X, Z = np.linalg.inv(P) @ X, np.linalg.inv(Q) @ Z
        turn, shift = _pose(np.linalg.inv(X) @ Z)
        if turn > SMALL or shift > SMALL:
            says = f"its frame is {1e3 * shift:.6g} mm and {turn:.6g} rad elsewhere in b"
            yield Change("link", "re-framed", name, says, amount=shift + turn, counts=False)
    lost = [k for k in pair.a.links if k not in pair.b.links]
    new = [k for k in pair.b.links if k not in pair.a.links]
    for name in list(lost):
        node, X = pair.a.links[name]
        same = [
            k
            for k in new
            if bodies.get(node) == pair.b.links[k][0]
            and sum(_pose(np.linalg.inv(X) @ m.motions[pair.b.links[k][0]] @ pair.b.links[k][1])) < SMALL
        ]
        if same:
            yield Change("link", "renamed", name, f"called {same[0]!r} in b", name, same[0], counts=False)
            lost.remove(name)
            new.remove(same[0])
    for names, home, here, there in ((lost, pair.a, "a", "b"), (new, pair.b, "b", "a")):
        for name in names:
            massive = any(k.name == name and not k.inertia.massless for k in home.robot.links)
            what = "merged into its body" if massive else "a frame without mass"
            says = f"only in {here}; in {there} {what} or left out"
            yield Change("link", f"only in {here}", name, says, counts=False)


def _displaced(pair: Pair) -> set[int]:
    """Bodies of a that are carried by a joint which lies elsewhere in b."""
    found: set[int] = set()
    for x in pair.matching.joints:  # parents come first
        if x.a.inner in found or any(True for c in _motion(x) if c.counts):
            found.add(x.a.outer)
    return found


def _order(pair: Pair) -> Iterator[Change]:
    order = [m.b.joint.index for m in sorted(pair.matching.joints, key=lambda m: m.a.joint.index)]
    if order != sorted(order):
        names = [pair.b.robot.joint_names[i] for i in order]
        says = f"q of b comes in another order: a's is {', '.join(names)}"
        yield Change("joint", "reordered", "", says, counts=False)


def _pose(X: np.ndarray) -> tuple[float, float]:
    """The angle [rad] and the distance [m] of a displacement."""
    R = X[:3, :3]
    skew = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(np.linalg.norm(skew) / 2, (np.trace(R) - 1) / 2)), float(np.linalg.norm(X[:3, 3]))


def _row(x: np.ndarray) -> str:
    return "(" + ", ".join(f"{float(v):.6g}" for v in x) + ")"
