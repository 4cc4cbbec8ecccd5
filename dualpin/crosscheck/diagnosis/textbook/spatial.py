"""Spatial (six-vector) algorithms: recursive Newton-Euler, and composite rigid bodies.

    v = X v_p + S qd      a = X a_p + S qdd + v x S qd      f = I a + v x* I v
    tau = S^T f           f_p += X^T f
    I^c_p += X^T I^c X    F = I^c S      H_ii = S^T F       F = X^T F  down to the root,  H_ij = F^T S_j

Six-vectors are [angular; linear], X = [E 0; -E r x  E] brings motions from the parent's axes into the link's.

References: Featherstone, Rigid Body Dynamics Algorithms (2008), tables 5.1 and 6.2, equations 2.24, 2.31 and 2.63.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...subjects.layout import product, transposed
from .arrays import cross, inverse
from .in_place import GROWING, WHOLE, afterwards, array
from .link_axes import FIRST, RESTING, axes, gathered, own_rates, rate_in_cross, unturned
from .plucker import Coordinates, Model, brought, links, of_others, to_frame, to_parent, to_parent_inertia
from .products import applied, crf, crm, wedge
from .pushes import Wrenches
from .steps import HAVE, Steps
from .tree import MOVERS, Link, Tree, Twist, filled, in_turn, spatial

OF_FIXED = "what a fixed link hands on"


def forces(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray, of: Coordinates = links
) -> np.ndarray:
    """tau (runs, samples, nv) of velocities and accelerations, under the gravity g, in the coordinates `of`."""
    m = of(steps, tree, q)
    vs, accs = _motions(steps, tree, m, q, v, a, gravity(steps, g))
    felt = [k.mass > 0 or m.I[k.number].any() for k in tree.links]  # a slip may give an inertia to what weighs nothing
    f = [_needed(steps, tree, m.I[k.number], k, vs, accs) if felt[k.number] else 0 * vs[0] for k in tree.links]
    return _inward(steps, tree, m, f, q)


def seen(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, frames: Sequence[str], term: str,
    by_transforms: bool = False,
) -> np.ndarray:  # fmt: skip
    """Velocities or accelerations of frames (runs, samples, frames, 6), at their origins in world axes.

    Those that stand on a link are brought there by its angular velocity, or `by_transforms`.
    """
    poses, out = tree.poses(q), []
    vs, accs = _motions(steps, tree, links(steps, tree, q), q, v, a, np.zeros((1, 1, 6)))
    for number, H in (tree.stands[frame] for frame in frames):
        R, r, v_k, a_k = poses[number].R0, H[None, None, :3, 3], vs[number], accs[number]
        if by_transforms:
            X, R, r = to_frame(steps, poses[number], r, H[None, None, :3, :3]), np.eye(3)[None, None], 0 * r
            v_k = brought(steps, "the velocity of a link, at its frame in world axes,", X, v_k)
            a_k = brought(steps, "the acceleration of a link, at its frame in world axes,", X, a_k)
        (w, u), (alpha, acc) = ((x[..., :3], x[..., 3:]) for x in (v_k, a_k))
        speed = steps.add("the velocity of a frame", **{"that of the link's origin": u, "w x r": wedge(steps, w, r)})
        if term == "frame_velocity":
            linear, angular, what = speed, w, "the velocity of a frame, in its link's axes"
        else:
            terms = {"the spatial one": acc, "alpha x r": wedge(steps, alpha, r), "w x v": wedge(steps, w, speed)}
            linear, angular = steps.add("the acceleration of a frame's origin", **terms), alpha
            what = "the acceleration of a frame, in its link's axes"
        halves = ((f"{what}: its angular part", angular), (f"{what}: its linear part", linear))
        out.append(np.concatenate(np.broadcast_arrays(*(steps.turn(site, R, x) for site, x in halves)), -1))
    lead = np.broadcast_shapes(*(x.shape for x in out))
    return np.stack([np.broadcast_to(x, lead) for x in out], axis=2)


def _motions(
    steps: Steps, tree: Tree, m: Model, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Velocities and accelerations of links."""
    zero = np.zeros((*q.shape[:-1], 6), np.result_type(q, v, a))
    down = g + zero
    speed, acc = zero, -down
    if tree.floating and m.base is not None:
        speed, acc = product(m.base, v[..., :6]), product(m.base, a[..., :6]) - down
    elif tree.floating:
        speed, acc = _base(steps, m, v, a, down)
    vs, accs = [speed], [acc]
    whole = _whole(tree, m, v, speed)
    for k in tree.links[1:]:
        v_k, a_k = _next(steps, tree, k, m, vs, accs, whole, q, v, a)
        vs.append(v_k)
        accs.append(a_k)
    if m.common:
        vs, accs = afterwards(steps, "velocity", vs, lambda: whole), afterwards(steps, "acceleration", accs)
        vs = at_origins(steps, tree, q, vs)
    return vs, accs


def _whole(tree: Tree, m: Model, v: np.ndarray, base: np.ndarray) -> np.ndarray:
    """The velocity of the base and those of all joints."""
    return base + sum(m.S[k.number] * v[..., k.column, None] for k in tree.links if k.moves)


def _base(steps: Steps, m: Model, v: np.ndarray, a: np.ndarray, down: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """In its own axes."""
    up = brought(steps, "gravity, in world axes,", m.X[0], -down, plain=True)
    speed = v[..., :6] + 0 * down
    # the rate of the base's spatial velocity has no w x v: what is given is the rate of its columns
    acc = steps.add("the acceleration of the base", **{"the given acceleration": a[..., :6], "-g": up})
    halves = {"that with its halves exchanged": speed[..., [3, 4, 5, 0, 1, 2]], RESTING: 0 * speed}
    speed = steps.pick("the velocity of a floating base", speed, **halves)
    turning = np.concatenate([0 * v[..., :3], cross(v[..., :3], v[..., 3:6])], -1)
    halves = {
        "that with its halves exchanged": a[..., [3, 4, 5, 0, 1, 2]] + up, RESTING: up,
        "that of its origin, with w x v": acc + turning,
    }  # fmt: skip
    return speed, steps.pick("the acceleration of a floating base", acc, **halves)


def pushed(steps: Steps, tree: Tree, q: np.ndarray, wrenches: Wrenches, of: Coordinates = links) -> np.ndarray:
    """tau (runs, samples, nv) of wrenches on links."""
    m = of(steps, tree, q)
    return _inward(steps, tree, m, on_links(steps, tree, m, q, wrenches), q)


def on_links(steps: Steps, tree: Tree, m: Model, q: np.ndarray, wrenches: Wrenches) -> list[np.ndarray]:
    """What wrenches add to the force of each link."""
    poses, zero = tree.poses(q), np.zeros((*q.shape[:-1], 6))

    def on(k: Link) -> np.ndarray:
        if k.number not in wrenches:
            return zero
        push, pose = wrenches[k.number], poses[k.number]
        back = transposed(pose.R0)
        X = m.to_frame(steps, k, pose, push)
        others = {
            "by the inverse of X, as a motion": lambda: inverse(steps.few(X)),
            "by X^-T, the inverse of what is right": lambda: transposed(inverse(steps.few(X))),
            "into the link's axes alone": lambda: spatial([[back, 0 * back], [0 * back, back]]),
        }
        x = steps.turn("the wrench on a link, X^T f,", transposed(X), push.given, **others)
        if m.common:  # codes add p x f to the moment, without X
            p, force = pose.p0 + push.at, x[..., 3:]
            off = wedge(steps, p + 0 * force, force) - cross(p, force)
            x = np.concatenate(np.broadcast_arrays(x[..., :3] + off, force), -1)
        return x

    return [on(k) for k in tree.links]


def _inward(steps: Steps, tree: Tree, m: Model, f: list[np.ndarray], q: np.ndarray) -> np.ndarray:
    """From the tips to the base: forces of links."""
    columns, own = dict[int, np.ndarray](), list(f)
    for k in reversed(tree.links):
        if k.moves:
            columns[k.column] = _along(steps, tree, m, k, f[k.number], own[k.number])
        if k.parent >= 0:
            X, beside = m.X[k.number], of_others(tree, m, k)
            handed = to_parent(steps, "the force that is handed on, X^T f,", X, f[k.number], beside)
            if not k.moves:
                handed = steps.pick(f"{OF_FIXED}: its force", handed, nothing=0 * handed)
            handed = steps.summed("the force that children hand on", handed, **tree.alone(k, handed))
            handed = steps.part("the links that hand on their force", handed, k.number - 1, len(tree.links) - 1)
            whole = steps.add("the force at a joint", **{HAVE: f[k.parent], "the child's X^T f": handed})
            hand_on(steps, k, "force", f, whole, handed)
    base = f[0] if m.base is None else product(transposed(m.base), f[0])
    return gathered(columns, [base] if tree.floating else [], q)


def hand_on(
    steps: Steps, k: Link, what: str, of_links: list[np.ndarray], whole: np.ndarray, handed: np.ndarray
) -> None:  # fmt: skip
    """Give the parent the sum of both; slips give what is handed on to the link before."""
    up, before = k.parent, k.number - 1
    if before != up:
        site, chain = f"the link that a link hands its {what} on to", "the link before in the list, as in a chain"
        whole = steps.pick(site, whole, **{chain: of_links[up]})
        of_links[before] = steps.pick(site, of_links[before], **{chain: of_links[before] + handed})
    of_links[up] = whole


def _next(
    steps: Steps, tree: Tree, k: Link, m: Model, vs: list[np.ndarray], accs: list[np.ndarray], whole: np.ndarray,
    q: np.ndarray, v: np.ndarray, a: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    X = m.X[k.number]
    v_up, a_up = start(steps, tree, k, vs), start(steps, tree, k, accs, "acceleration")
    if m.common:
        v_up = steps.pick(array("velocity"), v_up, **{GROWING: vs[-1]})
        a_up = steps.pick(array("acceleration"), a_up, **{GROWING: accs[-1]})
    v_k = next_velocity(steps, tree, k, m, v_up, v)
    a_k = brought(steps, "the parent's acceleration", X, a_up, beside=of_others(tree, m, k))
    if k.number in tree.first and X is not None:
        wrong = unturned(k, tree.poses(q)[k.number], accs[0][..., 3:])
        a_k = steps.pick(FIRST, a_k, **{what: np.concatenate([0 * x, x], -1) for what, x in wrong.items()})
    if not k.moves:
        return v_k, a_k
    S_qdd = m.axis(steps, k, "in S qdd") * own_rates(steps, tree, k, q, v, a)[1]
    S_qd = m.axis(steps, k, "in v x S qd") * rate_in_cross(steps, tree, k, q, v, a)
    v_c = steps.pick("the velocity in v x S qd", v_k, **{"the parent's, in its axes": v_up})
    if m.common:
        v_c = steps.pick(array("velocity"), v_c, **{WHOLE: whole})
    turning = crm(steps, "v x S qd", v_c, S_qd)
    terms = {"X a of the parent": a_k, "v x S qd": turning, "S qdd": S_qdd}
    return v_k, steps.add(f"the acceleration of a link: {_rank(tree, k)}", **terms)


def _rank(tree: Tree, k: Link) -> str:
    """Codes often write the first link's equations apart."""
    return "whose parent rests" if k.number in tree.first else "whose parent moves"


def next_velocity(steps: Steps, tree: Tree, k: Link, m: Model, v_up: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The velocity of a link, of its parent's."""
    v_k = brought(steps, "the parent's velocity", m.X[k.number], v_up, beside=of_others(tree, m, k))
    if not k.moves:
        return v_k
    S_qd = m.axis(steps, k, "in S qd") * v[..., k.column, None]
    terms = {"X v of the parent": v_k, "S qd": S_qd}
    return np.asarray(steps.add(f"the velocity of a link: {_rank(tree, k)}", **terms))


def velocities(steps: Steps, tree: Tree, m: Model, v: np.ndarray, zero: np.ndarray) -> list[np.ndarray]:
    """Of all links; `zero` has their shape."""
    twists = tree.twists(v)
    if twists is not None:
        return _in_coordinates(steps, tree, m, twists)
    base = v[..., :6] if m.base is None or not tree.floating else product(m.base, v[..., :6])
    vs = [base + zero if tree.floating else zero]
    for k in tree.links[1:]:
        vs.append(next_velocity(steps, tree, k, m, start(steps, tree, k, vs), v))
    whole = {WHOLE: _whole(tree, m, v, vs[0])} if m.common else {}
    return [steps.pick(array("velocity"), x, **whole) for x in vs] if whole else vs


def _in_coordinates(steps: Steps, tree: Tree, m: Model, twists: list[Twist]) -> list[np.ndarray]:
    """Given twists, about the world's origin or in the links' axes."""
    found = []
    for (w, u), pose in zip(twists, tree.known, strict=True):
        back = transposed(pose.R0)
        halves = (w, u - wedge(steps, w, pose.p0)) if m.common else (product(back, w), product(back, u))
        found.append(np.concatenate(np.broadcast_arrays(*halves), -1))
    return found


def at_origins(steps: Steps, tree: Tree, q: np.ndarray, vs: list[np.ndarray]) -> list[np.ndarray]:
    """Velocities about the world's origin, once they are handed on; slips take those of the links' own origins."""
    found = []
    for v, pose in zip(vs, tree.poses(q), strict=True):
        w_p = cross(v[..., :3], pose.p0)
        others = {"that of the link's origin": v[..., 3:] + w_p, "with the other sign of p x w": v[..., 3:] + 2 * w_p}
        u = steps.pick("the linear part of a velocity about the world's origin", v[..., 3:], **others)
        found.append(np.concatenate(np.broadcast_arrays(v[..., :3], u), -1))
    return found


def start(steps: Steps, tree: Tree, k: Link, found: list[np.ndarray], what: str = "velocity") -> np.ndarray:
    """What the parent has, of links so far."""
    up = found[k.parent]
    others = tree.near(k, lambda x: found[x.number] if x.number < len(found) else up)
    return np.asarray(steps.pick(f"the motion that a link starts from: its {what}", up, **others))


def _needed(
    steps: Steps, tree: Tree, I: np.ndarray, k: Link, vs: list[np.ndarray], accs: list[np.ndarray]
) -> np.ndarray:
    v_k, v_up = vs[k.number], vs[max(0, k.parent)]
    others = {"the parent's": v_up, **tree.near(k, lambda x: vs[x.number])}
    first, second = (steps.pick(f"the velocity in v x* I v: {x}", v_k, **others) for x in ("its first", "its second"))
    first, second = (
        steps.mistaken(f"v in v x* I v: {x}", y, a=accs[k.number])
        for x, y in (("its first", first), ("its second", second))
    )
    spin = crf(steps, "v x* I v", first, applied(steps, "the momentum I v", I, second))
    inside = {"I (v x* v), with I before the product": lambda: product(I, crf(Steps(), "", first, second))}
    spin = steps.pick("v x* I v", spin, **inside)
    others = {"the parent's": accs[max(0, k.parent)], **tree.near(k, lambda x: accs[x.number])}
    a_k = steps.pick("the acceleration in I a", accs[k.number], **others)
    a_k = steps.mistaken("a in I a", a_k, v=v_k)
    f = steps.add("the force of a body", **{"I a": applied(steps, "I a", I, a_k), "v x* I v": spin})
    heavy = tree.bodies
    return np.asarray(steps.part("the forces of bodies", f, heavy.index(k), len(heavy)) if k.mass > 0 else f)


def _along(steps: Steps, tree: Tree, m: Model, k: Link, f: np.ndarray, own: np.ndarray | None = None) -> np.ndarray:
    """S^T f; `own` is the force that the link itself needs."""
    half, other = (f[..., 3:], f[..., :3]) if k.slides else (f[..., :3], f[..., 3:])
    S = m.axis(steps, k, "in S^T f")
    z = S[..., 3:] if k.slides else S[..., :3]
    right = (S * f).sum(-1)
    others = {"taken from the other half of f": (z * other).sum(-1), "zero": 0 * right}
    if own is not None:
        alone = (S * own).sum(-1) + 0 * right
        others |= {"that of the links beyond alone": right - alone, "that of its own link alone": alone}
    site = f"the force along a joint's axis, S^T f: of {'sliding' if k.slides else 'turning'} joints"
    felt = steps.pick(site, right, **others)
    if m.X[k.number] is None:
        along = {f"that of the {which} joint": (m.S[j.number] * f).sum(-1) for which, j in tree.neighbours(k).items()}
    else:
        along = {words: (z * half).sum(-1) for words, z in axes(np.eye(3)[None, None], "of the link's frame").items()}
        along |= {f"that of the {which} joint": (j.z * half).sum(-1) for which, j in tree.neighbours(k).items()}
    return np.asarray(steps.pick("the axis along which a joint feels force or moment", felt, **along))


def composites(steps: Steps, tree: Tree, m: Model, own: list[np.ndarray]) -> list[np.ndarray]:
    """The inertia of every link with all that it carries; `own` are theirs alone."""
    I = list(own)
    for k in reversed(tree.links[1:]):
        whole = steps.pick("the inertia of a child", I[k.number], **{"its own, without its children's": own[k.number]})
        x = to_parent_inertia(steps, "a child's inertia, X^T I X,", m.X[k.number], whole)
        x = steps.summed("the inertia that children hand on", x, **tree.alone(k, x))
        if not k.moves:
            x = steps.pick(f"{OF_FIXED}: its composite inertia", x, nothing=0 * x)
        x = steps.part("the links that hand on their inertia", x, k.number - 1, len(tree.links) - 1)
        sum_of_both = steps.add("the composite inertia", **{HAVE: I[k.parent], "X^T I X of the child": x})
        hand_on(steps, k, "inertia", I, sum_of_both, x)
    return I


def of_composite(steps: Steps, k: Link, m: Model, I: list[np.ndarray], own: list[np.ndarray]) -> np.ndarray:
    """F = I^c S."""
    S = m.S[k.number] + 0 * I[k.number][..., 0]
    own_I = {"the link's own": own[k.number]}
    return applied(steps, "F = I S", steps.pick("the composite inertia in F = I S", I[k.number], **own_I), S)


def mass(steps: Steps, tree: Tree, q: np.ndarray, of: Coordinates = links) -> np.ndarray:
    """H (runs, samples, nv, nv) by composite rigid bodies."""
    m = of(steps, tree, q)
    own = [I + np.zeros((*q.shape[:-1], 6, 6)) for I in m.I]
    I = composites(steps, tree, m, own)
    entries: dict[tuple[int, int], np.ndarray] = {}
    base = I[0] if m.base is None else transposed(m.base) @ I[0] @ m.base
    for k in (k for k in tree.links if k.moves):
        (F,) = in_turn(steps, tree, k, MOVERS, of_composite(steps, k, m, I, own))
        entries[k.column, k.column] = _along(steps, tree, m, k, F)
        step, at = "of the first step", k
        while at.parent >= 0:
            site = f"the force F of composite bodies, carried down as X^T F: {step}"
            turned = to_parent(steps, site, m.X[at.number], F)
            others = {
                "that of the next link down": lambda x=m.X[at.parent], y=F: _carried(x, y),
                "that of the first link, in every step": lambda x=m.X[k.number], y=F: _carried(x, y),
            }  # fmt: skip
            F = steps.pick(
                "X in X^T F, by which a force is handed down,", turned, **others if m.X[0] is not None else {}
            )
            far, step, at = step != "of the first step", "of further steps", tree.links[at.parent]
            if at.moves:
                of_column = {"that of the joint whose column it is": m.S[k.number]}
                S = steps.pick("S in an entry of H, S_j^T F,", m.S[at.number], **of_column)
                felt = (S * F).sum(-1)
                wrong = {"left out, so that only neighbours are coupled": felt * (not far)}
                felt = steps.pick("an entry of H beyond the parent", felt, **wrong)
                entries[k.column, at.column] = entries[at.column, k.column] = felt
        if tree.floating:
            F = F if m.base is None else product(transposed(m.base), F)
            for i in range(6):
                entries[k.column, i] = entries[i, k.column] = F[..., i]
    if tree.floating:
        entries |= {(i, j): base[..., i, j] for i in range(6) for j in range(6)}
    return filled(entries, tree.nv, q)


def _carried(X: np.ndarray, F: np.ndarray) -> np.ndarray:
    return product(transposed(X), F) if X.shape[-1] == F.shape[-1] else F


def gravity(steps: Steps, g: np.ndarray) -> np.ndarray:
    """As a six-vector."""
    others = {"in the angular rows": np.concatenate([g, 0 * g], -1), "in both halves": np.concatenate([g, g], -1)}
    return np.asarray(steps.pick("gravity as a six-vector", np.concatenate([0 * g, g], -1), **others))
