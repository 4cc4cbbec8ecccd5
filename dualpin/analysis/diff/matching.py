"""Which joint and which body of one robot is which of another: by name, and by place in the tree where names differ.

Both trees are traversed from the same body outwards.  Equal names match first; other joints are matched by properties
that do not depend on frames: the line of the screw, the type, and the number of joints beyond.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from ...spatial.arrays import exp, to_matrix
from .home import Edge, Home, carried, moved

NEAR = 1e-6
"""Screws nearer than this are equal: files have rounded decimals."""
LOOKED = 8  # links with equal names that are tried to locate b's base
SHAPE = 4.0  # penalty for another type or other numbers of joints beyond: matched only as a last resort


@dataclass
class Match:
    """A joint of a, and the corresponding joint of b.

    Attributes
    ----------
    sign : int
        -1 if the direction of q is reversed.
    offset : float
        q_a where q_b is zero:  q_a = sign q_b + offset.
    reversed : bool
        Whether parent and child are exchanged, because b's base is another body.
    screws : ndarray (nv, 6)
        Those of b in a's world at a's zero, with a's direction.
    """

    a: Edge
    b: Edge
    sign: int = 1
    offset: float = 0.0
    reversed: bool = False
    screws: np.ndarray = field(default_factory=lambda: np.zeros((0, 6)))

    @property
    def renamed(self) -> bool:
        return self.a.joint.name != self.b.joint.name


@dataclass
class Matching:
    """Two robots side by side.

    Attributes
    ----------
    joints : list of Match
    bodies : dict
        Body of a -> body of b.
    motions : dict
        Body of b -> the pose (4, 4) in a's world of what its own world is at zero.
    base : ndarray (4, 4)
        Pose of b's world in a's.
    rerooted : str
        The base link of b, if it is another body than in a.
    """

    joints: list[Match]
    bodies: dict[int, int]
    motions: dict[int, np.ndarray]
    base: np.ndarray
    rerooted: str = ""


def matched(a: Home, b: Home) -> Matching:
    """The matching with the smallest difference, over the possible placements of b's base."""
    start = _start(a, b)
    found = [_walk(a, b, start, T) for T in _bases(a, b, start)]
    most = max(len(m.joints) for m in found)
    rests = [_rest(m) if len(m.joints) == most else float("inf") for m in found]
    # the unmoved placement, unless another fits exactly; robots with symmetric limbs have several
    first = next(i for i, rest in enumerate(rests) if rest < float("inf"))
    best = found[next((i for i, rest in enumerate(rests) if rest <= NEAR), first)]
    best.rerooted = _ground(b) if start != 0 else ""
    return best


def _ground(home: Home) -> str:
    return next((name for name, (node, _) in home.links.items() if node == 0), "")


def _start(a: Home, b: Home) -> int:
    """The body of b that holds a's ground link."""
    name = _ground(a)
    return b.links[name][0] if name in b.links else 0


def _bases(a: Home, b: Home, start: int) -> list[np.ndarray]:
    """Where b's world may be in a's: where links of one name agree, where the first two axes do, or at the same "
    "place."""
    found = []
    name = _ground(a)
    if name in b.links and b.links[name][0] == start:
        found.append(a.links[name][1] @ np.linalg.inv(b.links[name][1]))
    found.append(np.eye(4))
    shared = [k for k in a.links if k in b.links][:LOOKED]
    found += [a.links[k][1] @ np.linalg.inv(b.links[k][1]) for k in shared]
    names = [j.name for j in a.robot if j.name in b.robot.joint_names]
    for order in ((names, names), (a.robot.joint_names, b.robot.joint_names)):
        mine, theirs = (_frames(home, these) for home, these in zip((a, b), order, strict=True))
        found += [X @ np.linalg.inv(Y) for X, Y in product(mine, theirs)]
    return found


def _frames(home: Home, names: list[str]) -> list[np.ndarray]:
    """Frames made of the first of some axes that turn and the next one that is not the same line, either way round."""
    edges = [home.edges[home.robot.joint(n).index] for n in names]
    axes = [e.screws[0] for e in edges if len(e.screws) == 1 and e.screws[0, :3].any()]
    for other in axes[1:]:
        frame = _common(axes[0], other)
        if frame is not None:
            turn = np.diag([1.0, -1.0, -1.0, 1.0])  # half a turn about x: z reversed
            return [frame, frame @ turn]
    return []


def _common(s: np.ndarray, t: np.ndarray) -> np.ndarray | None:
    """z along the first line, x along the common perpendicular; None for one line."""
    z, u = s[:3], t[:3]
    p, r = np.cross(z, s[3:]), np.cross(u, t[3:]) / (u @ u)
    n = np.cross(z, u)
    if np.linalg.norm(n) > NEAR:
        x = n / np.linalg.norm(n)
        foot = p + z * (np.cross(r - p, u) @ n) / (n @ n)
    else:
        d = (r - p) - z * ((r - p) @ z)
        if np.linalg.norm(d) < NEAR:
            return None
        x, foot = d / np.linalg.norm(d), p
    X = np.eye(4)
    X[:3, 0], X[:3, 1], X[:3, 2], X[:3, 3] = x, np.cross(z, x), z, foot
    return X


def _rest(m: Matching) -> float:
    return sum(apart(x.a.screws, x.screws) for x in m.joints if x.screws.shape == x.a.screws.shape)


def _walk(a: Home, b: Home, start: int, base: np.ndarray) -> Matching:
    """From the ground outwards, each joint of a with one of b's at the same body."""
    found = Matching([], {0: start}, {start: base}, base)
    used: set[int] = set()
    waiting = [0]
    while waiting:
        node = waiting.pop(0)
        mine = [e for e in a.at(node) if e.inner == node]
        motion = found.motions[found.bodies[node]]
        theirs = [e for e in b.at(found.bodies[node]) if e.joint.index not in used]
        for match in _paired(a, b, found.bodies[node], mine, theirs, motion):
            beyond = match.b.inner if match.reversed else match.b.outer
            match = _shifted(a, b, match, motion, beyond, used)
            used.add(match.b.joint.index)
            found.joints.append(match)
            found.bodies[match.a.outer] = beyond
            found.motions[beyond] = _turned(match, motion)
            waiting.append(match.a.outer)
    return found


def _paired(a: Home, b: Home, at: int, mine: list[Edge], theirs: list[Edge], motion: np.ndarray) -> list[Match]:
    """Namesakes first, then the cheapest pairs."""
    names = {e.joint.name: e for e in theirs}
    found = [_match(e, names[e.joint.name], at, motion) for e in mine if e.joint.name in names]
    taken = {(m.a.joint.name, m.b.joint.name) for m in found}
    rest = [e for e in mine if e.joint.name not in names]
    # a joint of b whose name occurs elsewhere in a is reserved for that joint
    others = [
        e for e in theirs if e.joint.name not in {x for _, x in taken} and e.joint.name not in a.robot.joint_names
    ]
    costs = []
    for e, f in product(rest, others):
        m = _match(e, f, at, motion)
        same = e.screws.shape == f.screws.shape
        cost = apart(e.screws, m.screws) if same else SHAPE
        size = abs(len(a.below(e.inner, e)) - len(b.below(at, f)))
        # joints with a common line, as front and hind hips, are distinguished by the masses beyond them
        mass = _apart_below(a, b, e, f, at, motion)
        costs.append((round((cost + SHAPE * size) / NEAR), mass, e.joint.index, f.joint.index, m))
    gone: set[tuple[str, int]] = set()
    for _, _, i, k, m in sorted(costs, key=lambda x: x[:4]):
        if ("a", i) not in gone and ("b", k) not in gone:
            gone |= {("a", i), ("b", k)}
            found.append(m)
    return found


def _apart_below(a: Home, b: Home, e: Edge, f: Edge, at: int, motion: np.ndarray) -> float:
    """How far apart the masses beyond two joints are: mass and first moment."""
    mine, theirs = a.beyond(e.inner, e), carried(b.beyond(at, f), motion)
    return float(np.linalg.norm((mine - theirs)[:4]))


def _match(e: Edge, f: Edge, at: int, motion: np.ndarray) -> Match:
    """The pair, with b's screws counted as a's."""
    screws, back = moved(f.screws, motion), f.outer == at and f.inner != at
    if len(screws) == 1:
        sign = -1 if apart(e.screws, -screws) < apart(e.screws, screws) else 1
        # with parent and child exchanged, q acts in the opposite direction
        return Match(e, f, sign, 0.0, back, sign * screws)
    return Match(e, f, 1, 0.0, back, -screws if back else screws)


def apart(s: np.ndarray, t: np.ndarray) -> float:
    """How far two sets of screws are from each other: angles, and distances of lines in metres."""
    if s.shape != t.shape:
        return float("inf")
    return float(np.linalg.norm(s - t))


def _turned(m: Match, motion: np.ndarray) -> np.ndarray:
    """Where b's world is in a's beyond the joint, where a is at zero: b is at -offset then."""
    if not m.offset:
        return motion
    return np.asarray(to_matrix(exp(m.a.screws[0] * -m.offset)) @ motion)


def _shifted(a: Home, b: Home, m: Match, motion: np.ndarray, beyond: int, used: set[int]) -> Match:
    """The same with another zero, if that aligns the next axes or the body beyond the joint."""
    s = m.a.screws
    if s.shape != (1, 6) or apart(s, m.screws) > NEAR:
        return m
    seen = {*used, m.b.joint.index}
    mine = [e for e in a.at(m.a.outer) if e.inner == m.a.outer]
    names = {e.joint.name: e for e in b.at(beyond) if e.joint.index not in seen}
    pairs = [(e, names[e.joint.name]) for e in mine if e.joint.name in names] or (
        list(zip(mine, names.values(), strict=False)) if len(mine) == len(names) == 1 else []
    )
    best, least = m, _misfit(a, b, m, motion, beyond, pairs)
    if least <= NEAR:
        return m
    for offset in _offsets(s[0], a, b, m, motion, beyond, pairs):
        other = replace(m, offset=offset)
        misfit = _misfit(a, b, other, motion, beyond, pairs)
        if misfit < 1e-3 * least:
            best, least = other, misfit
    return best


def _misfit(a: Home, b: Home, m: Match, motion: np.ndarray, beyond: int, pairs: list[tuple[Edge, Edge]]) -> float:
    """The misalignment of the parts beyond a joint."""
    X = _turned(m, motion)
    if pairs:
        return sum(min(apart(e.screws, k * moved(f.screws, X)) for k in (1, -1)) for e, f in pairs)
    ours, theirs = a.bodies[m.a.outer], carried(b.bodies[beyond], X)
    return float(np.linalg.norm(ours - theirs) / max(np.linalg.norm(ours), 1e-300))


def _offsets(
    s: np.ndarray, a: Home, b: Home, m: Match, motion: np.ndarray, beyond: int, pairs: list[tuple[Edge, Edge]]
) -> list[float]:
    """q of a at b's zero: rotations about (or translations along) the axis of s that align a with b."""
    ours, theirs = [], []
    for e, f in pairs:
        t = moved(f.screws, motion)
        for k in (1, -1):
            for x, y in zip(e.screws, k * t, strict=False):
                ours += [x[:3], np.cross(x[:3], x[3:])]
                theirs += [y[:3], np.cross(y[:3], y[3:])]
    ten, other = a.bodies[m.a.outer], carried(b.bodies[beyond], motion)
    if ten[0] and other[0]:
        ours.append(ten[1:4] / ten[0])
        theirs.append(other[1:4] / other[0])
    z = s[:3]
    if not z.any():
        return [float((y - x) @ s[3:]) for x, y in zip(ours, theirs, strict=True)]
    p = np.cross(z, s[3:])
    found = []
    for at in (np.zeros(3), p):
        for x, y in zip(ours, theirs, strict=True):
            u, w = ((c - at) - z * ((c - at) @ z) for c in (x, y))
            if min(np.linalg.norm(u), np.linalg.norm(w)) > NEAR:
                found.append(float(np.arctan2(z @ np.cross(u, w), u @ w)))
    return found
