"""Composite bodies about their centres of mass, in the axes of the world.

    m = m_1 + m_2     c = (m_1 c_1 + m_2 c_2) / m
    I = I_1 + I_2 + S(m_1, c_1 - c) + S(m_2, c_2 - c)          S(m, d) = m (d.d 1 - d d^T)
    turning: F = m z x (c - o),  N = I z     sliding: F = m z,  N = 0
    M_ij = z_i . (N_j + (c_j - o_i) x F_j)  of a turning joint i,   z_i . F_j  of a sliding one

References: Walker and Orin, Efficient dynamic computer simulation of robotic mechanisms (1982), method 3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...subjects.layout import product
from .columns import MOVING
from .products import wedge
from .steiner import outer, square
from .steps import HAVE, STANDING, Steps
from .tree import MOVERS, Link, Tree, filled, in_turn, standing_otherwise, turned_otherwise
from .walks import of_joints
from .weighted import steiners

ONE = np.eye(3)
FELT = "what a joint feels of a unit acceleration"
ALONG_MOVING = "along the axis of the joint that moves"
Lump = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Mass (..., 1), centre (..., 3) and inertia about it (..., 3, 3), in the world."""


def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
    """M (runs, samples, nv, nv)."""
    poses = tree.poses(q)
    own = [own_lump(steps, tree, k, q) for k in tree.links]
    lumps = _composites(steps, tree, own)
    axes = [(k, k.column, poses[k.number].axis(k), poses[k.number].p0, k.slides) for k in tree.links if k.moves]
    if tree.floating:
        R0, p0 = poses[0].R0, poses[0].p0
        axes += [(tree.links[0], i, R0[..., :, i % 3], p0, i > 2) for i in range(6)]
    entries: dict[tuple[int, int], np.ndarray] = {}
    walks = {words: x.astype(float)[None, None] for words, x in of_joints(tree).items()}
    for k, column, z, o, slides in axes:
        n, f = in_turn(steps, tree, k, MOVERS, *_unit(steps, z, o, slides, lumps[k.number], own[k.number]))
        for at, row, y, p, along in axes:
            found = {words: x[..., k.number, at.number] for words, x in walks.items()}
            if tree.floating and at.number == 0:  # what moves all
                found = {"": np.ones((1, 1))}
            if not any(x.any() for x in found.values()):
                continue
            counts = steps.pick(MOVING, found.pop(""), **found)
            # a wrong walk may find either of two joints from the other
            before = entries.get((row, column), 0.0) if 0 < at.number != k.number else 0.0
            x = before + counts * _felt(steps, y, p, (along, slides), lumps[k.number], n, f, z)
            entries[row, column] = entries[column, row] = x
    return filled(entries, tree.nv, q)


def own_lump(steps: Steps, tree: Tree, k: Link, q: np.ndarray) -> Lump:
    """Of a link alone."""
    pose, lead = tree.poses(q)[k.number], np.zeros(q.shape[:-1], q.dtype)[..., None]
    poses = tree.poses(q)
    arm = steps.turn("the centre of mass of a body", pose.R0, k.c + lead, **turned_otherwise(poses, k))
    ends = {"the link's origin": pose.p0, "R c": arm}
    centre = steps.add("the place of a body's centre", **ends)
    standing = steps.pick(STANDING, pose.R0, **standing_otherwise(poses, k))
    I = steps.congruent("the inertia of a body", standing, k.tensor(steps))
    return k.mass + lead, centre, I


def _composites(steps: Steps, tree: Tree, own: Sequence[Lump]) -> list[Lump]:
    """Of every link, with all that it carries."""
    parents = [k.parent for k in tree.links]
    before = [-1, *range(len(own) - 1)]
    loose = [p if k.moves or not p else -1 for k, p in zip(tree.links, parents, strict=True)]
    others = {
        "the link before in the list": lambda: _flat(_merged(Steps(), own, before)),
        "nothing, where a fixed joint carries them": lambda: _flat(_merged(Steps(), own, loose)),
    }
    flat = steps.pick("what composite bodies are merged into", _flat(_merged(steps, own, parents)), **others)
    return [(x[..., :1], x[..., 1:4], x[..., 4:].reshape(*x.shape[:-1], 3, 3)) for x in np.moveaxis(flat, -2, 0)]


def _merged(steps: Steps, own: Sequence[Lump], parents: Sequence[int]) -> list[Lump]:
    lumps = list(own)
    for k in range(len(own) - 1, 0, -1):
        if parents[k] >= 0:
            lumps[parents[k]] = _joined(steps, lumps[parents[k]], lumps[k])
    return lumps


def _flat(lumps: Sequence[Lump]) -> np.ndarray:
    """(runs, samples, links, 13)."""
    parts = [[m, c, I.reshape(*I.shape[:-2], 9)] for m, c, I in lumps]
    lead = np.broadcast_shapes(*(x.shape[:-1] for row in parts for x in row))
    rows = [np.concatenate([np.broadcast_to(x, (*lead, x.shape[-1])) for x in row], -1) for row in parts]
    return np.stack(rows, -2)


def _joined(steps: Steps, up: Lump, mine: Lump) -> Lump:
    """A link and a child of it as one body."""
    (M, C, T), (m, c, I) = up, mine
    total = steps.add("the composite mass", **{HAVE: M, "the child's m": m})
    by = steps.pick(
        "the divisor of a composite's centre", total,
        **{
            "the link's mass": M, "the child's mass": m, "2": 0 * M + 2,
            "the link's mass and twice the child's, which was added before": M + 2 * m,
        },
    )  # fmt: skip
    moments = steps.add("the first moment of a composite", **{"m c of the link": M * C, "m c of the child": m * c})
    centre = moments / np.where(by == 0, 1.0, by)
    centre = steps.pick(
        "the centre of a composite", centre, **{"the mean of both": (C + c) / 2, "the link's own": C, "the child's": c}
    )  # fmt: skip
    terms = {
        HAVE: T, "the child's I": I,
        "the link's Steiner term": _steiner(steps, "of the link", M, C - centre, m, C - c),
        "the child's Steiner term": _steiner(steps, "of the child", m, c - centre, M, c - C),
    }  # fmt: skip
    whole = steps.add("the inertia of a composite", **terms)
    whole = steps.pick("the inertia of a composite, moved to its centre,", whole, **{"without Steiner's terms": T + I})
    whole = steps.pick("the inertia of a composite, with those of children,", whole, **{"the link's own alone": T})
    kept = steps.pick("the mass of a composite, kept for what carries it,", total, **{"the link's own": M})
    centre = steps.pick("the centre of a composite, kept for what carries it,", centre, **{"the link's own": C})
    return kept, centre, whole


def _steiner(
    steps: Steps, which: str, m: np.ndarray, d: np.ndarray, other: np.ndarray, apart: np.ndarray
) -> np.ndarray:
    """m (d.d 1 - d d^T)."""
    others = {"that of the other": other, "that of both": m + other, "1": 1 + 0 * m}
    m = steps.pick(f"the mass in Steiner's term: {which}", m, **others)
    d = steps.pick(f"the arm in Steiner's term: {which}", d, **{"that between both centres": apart})
    parts = {"d.d 1": square(steps, d), "-d d^T": -outer(steps, d)}
    return m[..., None] * steps.add(f"d.d 1 - d d^T in Steiner's term: {which}", **parts)


def _unit(
    steps: Steps, z: np.ndarray, o: np.ndarray, slides: bool, lump: Lump, own: Lump
) -> tuple[np.ndarray, np.ndarray]:
    """Moment about the centre, and force, for a unit acceleration of a joint."""
    m, c, I = lump
    kind = "of a sliding joint" if slides else "of a turning joint"
    m = steps.pick(f"the mass that a unit acceleration moves: {kind}", m, **{"the link's own": own[0]})
    if slides:
        n = steps.pick("the moment of a sliding joint's unit acceleration", 0 * c, **{"I z": product(I, z)})
        return n, m * z
    arms = {"from the world's origin": c, "to the link's own centre": own[1] - o}
    r = steps.pick("the arm of a unit acceleration", c - o, **arms)
    others = {
        "the link's own": own[2], "zero": 0 * I,
        "that about the joint's origin": lambda: I + steiners(m[..., 0], c - o),
        "that about the world's origin": lambda: I + steiners(m[..., 0], c),
    }  # fmt: skip
    n = product(steps.pick("the inertia that a unit acceleration turns", I, **others), z)
    a = steps.add("the acceleration of a composite's centre", **{"z x (c - o)": wedge(steps, z + 0 * r, r)})
    return n, m * a


def _felt(
    steps: Steps, z: np.ndarray, o: np.ndarray, kinds: tuple[bool, bool], lump: Lump, n: np.ndarray, f: np.ndarray,
    of_moving: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """What a joint feels of it; `kinds` say whether it slides, and whether the joint that moves does."""
    arm = steps.pick("the arm of a unit acceleration's force", lump[1] - o, **{"from the world's origin": lump[1]})
    terms = {"N": n, "(c - o) x F": wedge(steps, arm, f)}
    moment = steps.add("the moment of a unit acceleration at a joint", **terms)
    turning, sliding = (z * moment).sum(-1), (z * f).sum(-1)
    slides, other = kinds
    mistaken = {"of the kind of the joint that moves": sliding if other else turning}
    mistaken[ALONG_MOVING] = (of_moving * (f if slides else moment)).sum(-1)
    if slides:
        others = {"that of a turning one": turning, "that of both": turning + sliding}
        return np.asarray(steps.pick(f"{FELT}: of a sliding one", sliding, **others, **mistaken))
    others = {"that of a sliding one": sliding, **mistaken}
    return np.asarray(steps.pick(f"{FELT}: of a turning one", turning, **others))
