"""Newton's and Euler's equations link by link, in the axes of the world; motions are those of `world_motions`.

    a_c = a + alpha x c + w x (w x c)         F = m a_c      N = I alpha + w x I w,  I = R I R^T
    f = F - m g + sum f_j                     n = N + c x (F - m g) + sum (n_j + r_j x f_j)

References: Siciliano et al., Robotics (2009), section 7.5; Spong et al., Robot Modeling and Control (2006), 7.6.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...subjects.layout import product, transposed
from .arrays import cross
from .link_axes import OWN_FORCE, WHOLE_FORCE, axes, centripetal, felt, gathered, moment
from .products import wedge
from .pushes import Wrenches
from .steps import HANDING, HAVE, STANDING, Steps
from .tree import Link, Pose, Tree, standing_otherwise, turned_otherwise
from .world_motions import Motion, axis_of, joined, kind, motions


def forces(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
    """tau (runs, samples, nv) of velocities and accelerations, under the gravity g."""
    poses, moving = tree.poses(q), motions(steps, tree, q, v, a)
    f, n = needed(steps, tree, poses, moving, g)
    return _inward(steps, tree, poses, [m.z for m in moving], f, n, q)


def pushed(steps: Steps, tree: Tree, q: np.ndarray, wrenches: Wrenches) -> np.ndarray:
    """tau (runs, samples, nv) of wrenches on links."""
    poses, zero = tree.poses(q), np.zeros((*q.shape[:-1], 3))
    f, n = ([wrenches[k.number][i] + zero if k.number in wrenches else zero for k in tree.links] for i in (0, 1))
    z = [axis_of(steps, k, poses[k.number], poses[k.parent], kind(k)) if k.moves else zero for k in tree.links]
    return _inward(steps, tree, poses, z, f, n, q)


def _inward(
    steps: Steps, tree: Tree, poses: list[Pose], z: list[np.ndarray], f: list[np.ndarray], n: list[np.ndarray],
    q: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """From the tips to the base: forces and moments of links, about their origins."""
    own = list(zip(f, n, strict=True))
    columns: dict[int, np.ndarray] = {}
    for k in reversed(tree.links):
        more = cross(product(poses[k.number].R0, k.c), f[k.number] - own[k.number][0])
        n[k.number] = steps.pick(OWN_FORCE, n[k.number], **{WHOLE_FORCE: n[k.number] + more})
        if k.moves:
            along = _felt_along(steps, tree, k, poses, z)
            columns[k.column] = felt(steps, k, along, f[k.number], n[k.number], own[k.number])
        if k.parent >= 0:
            _hand_on(steps, tree, k, poses, f, n, own[k.number][0])
    back = transposed(poses[0].R0)
    base = []
    if tree.floating:
        about = cross(poses[0].p0, f[0])
        moment = steps.pick("the moment that moves the base", n[0], **{"that about the world's origin": n[0] + about})
        parts = (("moment", moment), ("force", f[0]))
        base = [steps.turn(f"the base's wrench: its {what}", back, x) for what, x in parts]
    return gathered(columns, base, q)


def _felt_along(steps: Steps, tree: Tree, k: Link, poses: list[Pose], zs: list[np.ndarray]) -> np.ndarray:
    """The axis of a joint, on which force and moment are projected."""
    z, pose, on = zs[k.number], poses[k.number], poses[k.parent]
    others = {f"that of the {which} joint": zs[j.number] for which, j in tree.neighbours(k).items()}
    others |= axes(pose.R0, "of the link's frame") | axes(on.R0, "of the parent's frame")
    others |= axes(np.eye(3) + 0 * pose.R0, "of the world")
    up = tree.links[k.parent]
    of_parent = z if not up.number else zs[up.number] if up.moves else on.R0[..., 0]  # x where a file names no axis
    others |= {
        "in the link's axes, not turned into the world's": k.z + 0 * z,
        "turned by the parent's matrix": product(on.R0, k.z),
        "turned by the transposed matrix": product(transposed(pose.R0), k.z),
    }  # fmt: skip
    z = steps.pick(f"the axis along which a joint feels force or moment: {kind(k)}", z, **others)
    return np.asarray(steps.pick(f"the axis of force and moment: {kind(k)}", z, **{"that of the parent": of_parent}))


def needed(
    steps: Steps, tree: Tree, poses: list[Pose], moving: list[Motion], g: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Force and moment (about its origin) that each link needs for itself."""
    zero = 0 * moving[0].a
    f, n = [zero] * len(tree.links), [zero] * len(tree.links)
    for i, k in enumerate(tree.bodies):
        m, pose, carrier = moving[k.number], poses[k.number], moving[max(0, k.parent)]
        w, alpha = (
            steps.pick(f"the {what} of a body, in its force and moment,", x, **{"the parent's": y})
            for what, x, y in (("angular velocity", m.w, carrier.w), ("angular acceleration", m.alpha, carrier.alpha))
        )
        m = replace(m, w=w, alpha=alpha)
        local = steps.components("the centre of mass of a body, in its link's axes,", k.c)
        from_parent = pose.p0 - poses[max(0, k.parent)].p0
        c = steps.turn("the centre of mass of a body", pose.R0, local, **turned_otherwise(poses, k))
        elsewhere = {"from the parent's joint": from_parent + c, "from the world's origin": pose.p0 + c}
        c = steps.pick("the arm to the centre of mass, in its acceleration and its moment,", c, **elsewhere)
        a_c = _of_centre(steps, tree, k, poses, moving, c, m)
        down = g + zero
        other = {"added at every link": (1 + depth(tree, k)) * down}
        if tree.floating:
            other["turned with the base"] = product(poses[0].R0, down)
        mass = {what: x + zero[..., :1] for what, x in (("in m a", k.mass), ("in m g", k.mass))}
        mass = {what: steps.pick(f"the mass of a body: {what}", x, **tree.masses(k, x)) for what, x in mass.items()}
        weight = mass["in m g"] * steps.pick("gravity", down, **other)
        F = steps.add("the force of a body", **{"m a": mass["in m a"] * a_c, "-m g": -weight})
        F_added = steps.add("the force at a link, of what it carries,", **{"m (a - g)": F})
        given = steps.pick(
            "the inertia about the centre of mass", k.tensor(steps), **{"that about the link's origin": k.about_origin}
        )
        standing = steps.pick(STANDING, pose.R0, **standing_otherwise(poses, k))
        I, spun = (
            steps.congruent(f"the inertia of a body: {where}", standing, given)
            for where in ("in I alpha", "in w x I w")
        )
        up = moving[max(0, k.parent)]
        others = {"the parent's": up.w, **tree.near(k, lambda x: moving[x.number].w)}
        w = [steps.pick(f"the angular velocity in w x I w: {x}", m.w, **others) for x in ("its first", "its second")]
        w = [
            steps.mistaken(f"w in w x I w: {x}", y, alpha=m.alpha)
            for x, y in zip(("its first", "its second"), w, strict=True)
        ]
        others = {"the parent's": up.alpha, **tree.near(k, lambda x: moving[x.number].alpha)}
        alpha = steps.pick("the angular acceleration in I alpha", m.alpha, **others)
        alpha = steps.mistaken("alpha in I alpha", alpha, w=m.w, **{"the acceleration of its centre": a_c})
        for_spin = {
            "that of its principal moments, not turned": k.moments,
            "that about the link's origin, not turned": k.about_origin,
        }
        spun = steps.pick("the inertia in w x I w", spun, **for_spin)
        moments = {"I alpha": product(I, alpha), "w x I w": wedge(steps, w[0], product(spun, w[1]))}
        N = steps.add("the moment about the centre of mass", **moments)
        at = steps.pick("the point at which weight acts", c, **{"the link's origin": 0 * c})
        arms = {
            "that from the parent's joint to the link's": from_parent, "that from the parent's joint": from_parent + c,
            "that from the world's origin": pose.p0 + c, "half as long": 0.5 * c,
            "that to the centre as it is counted from the parent's origin": c - from_parent,
            "that of the world's origin to the link's": pose.p0 + 0 * c, **unturned(tree, k, poses, c),
        }  # fmt: skip
        travel = product(poses[max(0, k.parent)].R0, pose.p - k.p)
        arms["that to the centre as it is counted from the joint, before it slides"] = c - travel
        arm = steps.pick("the arm of a body's own force", c, **arms)
        own = {"N": N, "r x f": wedge(steps, arm, F) + cross(at - c, -weight)}
        total = steps.add("a body's moment about the link's origin", **own)
        f[k.number] = steps.part("the forces of bodies", F_added + zero, i, len(tree.bodies))
        n[k.number] = steps.part("the moments of bodies", total + zero, i, len(tree.bodies))
    return f, n


def unturned(tree: Tree, k: Link, poses: list[Pose], c: np.ndarray) -> dict[str, np.ndarray]:
    """The centre of mass in other axes than the world's."""
    R, on = poses[k.number].R0, poses[max(0, k.parent)].R0
    return {
        "not turned into world axes": k.c + 0 * c, "turned by the transposed matrix": product(transposed(R), k.c),
        "turned by the parent's matrix": product(on, k.c),
    }  # fmt: skip


def _of_centre(
    steps: Steps, tree: Tree, k: Link, poses: list[Pose], moving: list[Motion], c: np.ndarray, m: Motion
) -> np.ndarray:  # fmt: skip
    """The acceleration of a body's centre, whose link has the motion m."""
    up = moving[max(0, k.parent)]
    ws, alphas = tree.near(k, lambda x: moving[x.number].w), tree.near(k, lambda x: moving[x.number].alpha)
    w = steps.pick("the angular velocity that carries a centre of mass", m.w, **{"the parent's": up.w}, **ws)
    alpha = steps.pick(
        "the angular acceleration that carries a centre of mass", m.alpha, **{"the parent's": up.alpha}, **alphas
    )
    from_parent = poses[k.number].p0 - poses[max(0, k.parent)].p0
    arms = {"that from the parent's joint to the link's": from_parent, "that from the parent's joint": from_parent + c}
    arms |= {"that from the world's origin": poses[k.number].p0 + c, **unturned(tree, k, poses, c)}
    c = steps.pick("the arm that carries a centre of mass", c, **arms)
    alpha = steps.mistaken("alpha in alpha x c", alpha, w=m.w)
    origin = steps.pick("the acceleration of the link's origin, in that of its centre", m.a, **{"the parent's": up.a})
    terms = {
        "that of the origin": origin, "alpha x r": wedge(steps, alpha, c),
        "w x (w x r)": centripetal(steps, "to a centre of mass", w, alpha, c, up.w),
    }  # fmt: skip
    a_c = steps.add("the acceleration of the centre of mass", **terms)
    return np.asarray(steps.pick("the acceleration in m a", a_c, **{"that of the link's origin": m.a + 0 * a_c}))


def _hand_on(
    steps: Steps, tree: Tree, k: Link, poses: list[Pose], f: list[np.ndarray], n: list[np.ndarray], own: np.ndarray
) -> None:
    """What a link hands on to its parent; `own` is the force that it needs for itself alone."""
    up, last, count = k.parent, k.number - 1, len(tree.links) - 1
    r = steps.add(
        "the arm in r x f, a difference",
        **{"the link's place": poses[k.number].p0, "the parent's place": -poses[up].p0},
    )
    on = joined(f[k.number], n[k.number])
    on = steps.pick("what a link hands on", on, nothing=0 * on)
    on = steps.part(HANDING, on, last, count)
    on = steps.summed("the force and moment that children hand on", on, **tree.alone(k, on))
    f_k, n_k = on[..., :3], on[..., 3:]
    n_k = steps.mistaken("the moment that a link hands on", n_k, **{"its force": f_k})
    pose, on_parent = poses[k.number], poses[up].p0 - poses[max(0, tree.links[up].parent)].p0
    arms = {
        "that to the child's centre of mass": lambda: r + product(pose.R0, tree.links[k.number].c),
        "that from the world's origin": lambda: pose.p0 + 0 * r,
        "that of the parent (index i in place of i + 1)": on_parent + 0 * r,
        "in the child's axes": lambda: product(transposed(pose.R0), r),
        "in the parent's axes": lambda: product(transposed(poses[up].R0), r),
        "that from the parent's centre of mass": lambda: r - product(poses[up].R0, tree.links[up].c),
    }  # fmt: skip
    r = steps.pick("the arm in r x f", r, **arms)
    whose = {
        "that of the parent": f[up] + 0 * f_k, "that of the parent, with the child's": f[up] + f_k,
        "that of the child itself, without what it carries": own + 0 * f_k,
    }  # fmt: skip
    f_r = steps.pick("the force in r x f", f_k, **whose)
    handed = steps.part("the links that hand on their force", f_k, last, count)
    handed = steps.summed("the force that children hand on", handed, **tree.alone(k, handed))
    have_f = f[up]
    f[up] = steps.add("the force at a joint", **{HAVE: f[up], "the child's f": handed})
    handed = steps.part("the links that hand on their moment", n_k, last, count)
    moments = {"the child's n": handed, "r x f": wedge(steps, r, f_r)}
    before, previous = n[up], k.number - 1
    n[up] = moment(steps, tree, k, n[up], moments)
    if previous != up:
        site, chain = "the link that a link hands its force on to", "the link before in the list, as in a chain"
        arm = poses[k.number].p0 - poses[previous].p0
        f[up], n[up] = (steps.pick(site, x[up], **{chain: y}) for x, y in ((f, have_f), (n, before)))
        f[previous] = steps.pick(site, f[previous], **{chain: f[previous] + f_k})
        n[previous] = steps.pick(site, n[previous], **{chain: n[previous] + n_k + cross(arm, f_k)})


def depth(tree: Tree, k: Link) -> int:
    """How many links it is from the base."""
    steps = 0
    while k.parent >= 0:
        k, steps = tree.links[k.parent], steps + 1
    return steps
