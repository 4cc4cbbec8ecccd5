"""Composite bodies by mass, first moment and inertia; and energies body by body.

    m^c += m_j     h^c += h + m_j p,  h = R h_j
    I^c += R I_j R^T + 2 (h.p) 1 - h p^T - p h^T + m_j (p.p 1 - p p^T)
    turning: n = I^c z, f = z x h^c     sliding: n = h^c x z, f = m^c z     H_ij = z_j . n or z_j . f, handed down by
    n = R n + p x R f,  f = R f

References: Walker and Orin, Efficient dynamic computer simulation of robotic mechanisms (1982), method 3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from ..case import View
from .link_axes import felt, own_rates
from .products import wedge
from .steps import HAVE, Steps
from .tree import MOVERS, THAT_TURN, Link, Pose, Tree, filled, in_turn, tree_of

Lump = tuple[np.ndarray, np.ndarray, np.ndarray]


def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
    """M (runs, samples, nv, nv)."""
    poses = tree.poses(q)
    lumps = [_own(steps, k, q) for k in tree.links]
    for k in reversed(tree.links[1:]):
        lumps[k.parent] = _joined(steps, tree, k, poses[k.number], lumps[k.parent], lumps[k.number])
    entries: dict[tuple[int, int], np.ndarray] = {}
    for k in (k for k in tree.links if k.moves):
        n, f = in_turn(steps, tree, k, MOVERS, *_unit(steps, k, lumps[k.number]))
        at = k
        while at.parent >= 0:
            if at.moves:
                entries[k.column, at.column] = entries[at.column, k.column] = felt(steps, at, at.z, f, n)
            n, f = _handed(steps, poses[at.number], n, f)
            at = tree.links[at.parent]
        if tree.floating:
            for i in range(3):
                entries[k.column, i] = entries[i, k.column] = n[..., i]
                entries[k.column, 3 + i] = entries[3 + i, k.column] = f[..., i]
    if tree.floating:
        m, h, I = lumps[0]
        across = cross_matrix(h)
        for i in range(3):
            for j in range(3):
                entries[i, j], entries[3 + i, 3 + j] = I[..., i, j], m[..., 0] * float(i == j)
                entries[i, 3 + j] = entries[3 + j, i] = across[..., i, j]
    return filled(entries, tree.nv, q)


def _own(steps: Steps, k: Link, q: np.ndarray) -> Lump:
    lead = np.zeros(q.shape[:-1], q.dtype)[..., None]
    terms = {"I about the centre of mass": k.tensor(steps), "m (c.c 1 - c c^T)": k.about_origin - k.I}
    I = steps.add("the inertia about a link's origin", **terms)
    m = k.mass + lead
    first = steps.pick("the mass in a link's first moment m c", m, **{"left out": 0 * m + 1})
    return m, first * k.c, I + lead[..., None]


def _joined(steps: Steps, tree: Tree, k: Link, pose: Pose, up: Lump, mine: Lump) -> Lump:
    """What a link and a child of it are as one body, about the link's origin."""
    (M, H, T), (m, h, I) = up, mine
    p, one = pose.p, np.eye(3)
    h = steps.turn("a child's first moment", pose.R, h)
    I = steps.congruent("a child's inertia", pose.R, I)
    hp, pp = (h * p).sum(-1)[..., None, None], (p * p).sum(-1)[..., None, None]
    outer = h[..., :, None] * p[..., None, :]
    mixed = {"2 (h.p) 1": 2 * hp * one, "-h p^T": -outer, "-p h^T": -transposed(outer)}
    arms = steps.add("what a child's first moment adds to the inertia", **mixed)
    last, count = k.number - 1, len(tree.links) - 1
    terms = {
        HAVE: T, "the child's I": I, "2 (h.p) 1 - h p^T - p h^T": arms,
        "m (p.p 1 - p p^T)": m[..., None] * (pp * one - p[..., :, None] * p[..., None, :]),
    }  # fmt: skip
    whole = steps.add("the composite inertia", **terms)
    m_p = steps.pick("the mass in m p", m, **{"left out": 0 * m + 1, "the link's own": k.mass + 0 * m}) * p
    moment = steps.add("the composite first moment", **{HAVE: H, "R h": h, "m p": m_p})
    moment = steps.pick("the composite first moment, with those of children,", moment, **{"the link's own alone": H})
    whole = steps.pick("the composite inertia, with those of children,", whole, **{"the link's own alone": T})
    mass = steps.add("the composite mass", **{HAVE: M, "the child's m": steps.part("the masses", m, last, count)})
    return mass, moment, whole


def _unit(steps: Steps, k: Link, lump: Lump) -> tuple[np.ndarray, np.ndarray]:
    """Moment and force for a unit acceleration of the joint."""
    m, h, I = lump
    if k.slides:
        n = steps.add("the moment of a sliding joint's unit acceleration", **{"h x z": wedge(steps, h, k.z)})
        return n, steps.add("the force of a sliding joint's unit acceleration", **{"m z": m * k.z})
    n = steps.add("the moment of a turning joint's unit acceleration", **{"I z": product(I, k.z)})
    return n, steps.add("the force of a turning joint's unit acceleration", **{"z x h": wedge(steps, k.z, h)})


def _handed(steps: Steps, pose: Pose, n: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    pushed = steps.turn("the force that is handed on: in r x f", pose.R, f)
    f = steps.turn("the force that is handed on: by itself", pose.R, f)
    n = steps.turn("the moment that is handed on", pose.R, n)
    return steps.add("the moment at a joint", **{"R n": n, "r x f": wedge(steps, pose.p, pushed)}), f


def energy(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """T = sum m v_c . v_c / 2 + w . I w / 2, by velocities from link to link."""
    poses, zero = tree.poses(q), np.zeros((*q.shape[:-1], 3))
    moving = [(v[..., :3], v[..., 3:6]) if tree.floating else (zero, zero)]
    total: np.ndarray = np.zeros((1, 1))
    for k in tree.links[1:]:
        moving.append(_velocity(steps, tree, k, poses[k.number], moving, q, v))
    for i, k in enumerate(tree.carried):
        w, u = moving[k.number]
        ws = tree.near(k, lambda x: moving[x.number][0])
        us = tree.near(k, lambda x: moving[x.number][1])
        arms = {"that of the link's origin from its parent's": k.p, "that from the parent's origin": k.p + k.c}
        w_c = steps.pick(
            "the angular velocity that carries a centre of mass",
            w,
            **{"the parent's": moving[max(0, k.parent)][0]},
            **ws,
        )
        c = steps.pick("the arm in w x c", k.c, **arms)
        u = steps.pick("the velocity of the origin, in that of a body's centre", u, **us)
        at = steps.add("the velocity of the centre of mass", **{"that of the origin": u, "w x c": wedge(steps, w_c, c)})
        w = steps.pick("the angular velocity in w . I w", w, **{"the parent's": moving[max(0, k.parent)][0]}, **ws)
        m = steps.pick("the mass in m v.v / 2", k.mass + 0 * at[..., 0], **tree.masses(k, k.mass + 0 * at[..., 0]))
        I = steps.pick(
            "the inertia about the centre of mass", k.tensor(steps), **{"that about the link's origin": k.about_origin}
        )
        vv = (at * at).sum(-1)
        vv = steps.pick("v.v in the kinetic energy", vv, **{"|v|, not squared": lambda vv=vv: np.sqrt(vv)})
        terms = {"m v.v / 2": 0.5 * m * vv, "w . I w / 2": 0.5 * (w * product(I, w)).sum(-1)}
        energy = steps.add("the kinetic energy of a body", **terms)
        total = total + steps.part("the bodies whose energy counts", energy, i, len(tree.carried), alone=True)
    return total


def _velocity(
    steps: Steps, tree: Tree, k: Link, pose: Pose, moving: list[tuple[np.ndarray, np.ndarray]], q: np.ndarray,
    v: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    known, up = len(moving), moving[k.parent]

    def both(x: Link) -> np.ndarray:
        return np.concatenate(np.broadcast_arrays(*(moving[x.number] if x.number < known else up)), -1)

    start = steps.pick("the motion that a link starts from", both(tree.links[k.parent]), **tree.near(k, both))
    w_up, u_up = start[..., :3], start[..., 3:]
    back = transposed(pose.R)
    w = steps.turn("the parent's angular velocity", back, w_up)
    arms = {
        "in the link's axes": lambda: product(back, pose.p),
        "that to its centre of mass": lambda: pose.p + product(pose.R, k.c),
    }  # fmt: skip
    if k.slides:
        arms["without the joint's travel"] = lambda: k.p + 0 * pose.p
    p = steps.pick("the arm in w x p", pose.p, **arms)
    carried = steps.add("the velocity of a link's origin", **{"the parent's": u_up, "w x p": wedge(steps, w_up, p)})
    u = steps.turn("the velocity of a link's origin, found in the parent's axes,", back, carried)
    if not k.moves:
        return w, u
    z_qd = k.z * own_rates(steps, tree, k, q, v, v)[0]
    fixed, turned, slid = (w, u), (w + z_qd, u), (w, u + z_qd)
    if k.slides:
        u = steps.add("the velocity of a sliding link", **{"that of the place where it is": u, "z qd": z_qd})
    else:
        w = steps.add(f"the angular velocity of a link: {THAT_TURN}", **{"that of the parent": w, "z qd": z_qd})
    which, another, other = ("sliding", "a turning one", turned) if k.slides else ("turning", "a sliding one", slid)
    others = {f"that of {another}": other, "that of a fixed one": fixed}
    joined = {name: np.concatenate(np.broadcast_arrays(*x), -1) for name, x in others.items()}
    x = steps.pick(f"the motion of a {which} link", np.concatenate(np.broadcast_arrays(w, u), -1), **joined)
    return x[..., :3], x[..., 3:]


@dataclass(frozen=True)
class Energy:
    """The kinetic energy of bodies; `fused` as of `Tree`."""

    fused: bool = False
    by: Callable[[Steps, Tree, np.ndarray, np.ndarray], np.ndarray] = energy

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        return self.by(steps, tree_of(view, self.fused), view.states["q"][None], view.states["v"][None])
