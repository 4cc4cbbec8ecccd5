"""Newton's and Euler's equations link by link, in the axes of the world.

    turning:  w = w_p + z qd     alpha = alpha_p + w_p x z qd + z qdd
    sliding:  w = w_p            alpha = alpha_p
    a = a_p + alpha_p x r + w_p x (w_p x r)   (+ 2 w_p x z qd + z qdd of a sliding link)
    a_c = a + alpha x c + w x (w x c)         F = m a_c      N = I alpha + w x I w,  I = R I R^T
    f = F - m g + sum f_j                     n = N + c x (F - m g) + sum (n_j + r_j x f_j)

References: Siciliano et al., Robotics (2009), section 7.5; Spong et al., Robot Modeling and Control (2006), 7.6.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...subjects.layout import product, transposed
from .link_axes import gathered, of_joint
from .steps import HAVE, Steps, cross
from .tree import Link, Pose, Tree


@dataclass
class Motion:
    """Of a link's frame, in world axes; z is the axis of its joint."""

    w: np.ndarray
    alpha: np.ndarray
    a: np.ndarray
    z: np.ndarray


def forces(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
    """tau (runs, samples, nv) of velocities and accelerations, under the gravity g."""
    poses, moving = tree.poses(q), motions(steps, tree, q, v, a)
    f, n = _bodies(steps, tree, poses, moving, g)
    columns: dict[int, np.ndarray] = {}
    for k in reversed(tree.links):
        if k.moves:
            others = {f"that of the {which} joint": moving[j.number].z for which, j in tree.neighbours(k).items()}
            z = steps.pick("the axis along which a joint feels force or moment", moving[k.number].z, **others)
            columns[k.column] = felt(steps, k, z, f[k.number], n[k.number])
        if k.parent >= 0:
            _hand_on(steps, tree, k, poses, f, n)
    back = transposed(poses[0].R0)
    return gathered(columns, [product(back, n[0]), product(back, f[0])] if tree.floating else [], q)


def accelerations(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, frames: Sequence[str]
) -> np.ndarray:
    """(runs, samples, frames, 6): alpha, and the acceleration of the frame's origin."""
    poses, moving, out = tree.poses(q), motions(steps, tree, q, v, a), []
    for number, offset in (tree.frames[f] for f in frames):
        m = moving[number]
        out.append(at_frame(steps, m.w, m.alpha, m.a, product(poses[number].R0, offset)))
    lead = np.broadcast_shapes(*(x.shape for x in out))
    return np.stack([np.broadcast_to(x, lead) for x in out], axis=2)


def at_frame(steps: Steps, w: np.ndarray, alpha: np.ndarray, a: np.ndarray, r: np.ndarray) -> np.ndarray:
    """alpha and the acceleration of a point of a link."""
    terms = {"that of the link's origin": a, "alpha x r": cross(alpha, r), "w x (w x r)": cross(w, cross(w, r))}
    return np.concatenate(np.broadcast_arrays(alpha, steps.add("the acceleration of a frame", **terms)), -1)


def motions(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> list[Motion]:
    poses = tree.poses(q)
    zero = np.zeros((*q.shape[:-1], 3), np.result_type(q, v, a))
    moving = [Motion(zero, zero, zero, zero)]
    if tree.floating:
        R, w, linear = poses[0].R0, v[..., :3], v[..., 3:6]
        terms = {"the given acceleration": a[..., 3:6], "w x v": cross(w, linear)}
        acc = product(R, steps.add("the acceleration of the base", **terms))
        moving = [Motion(product(R, w), product(R, a[..., :3]), acc, zero)]
    for k in tree.links[1:]:
        moving.append(_next(steps, tree, k, poses, moving, v, a))
    return moving


def _next(
    steps: Steps, tree: Tree, k: Link, poses: list[Pose], moving: list[Motion], v: np.ndarray, a: np.ndarray
) -> Motion:
    which = "of fixed links" if not k.moves else "of sliding links" if k.slides else "of turning links"
    up, pose, on = moving[k.parent], poses[k.number], poses[k.parent]
    known = len(moving)

    def others(of: Callable[[Motion], np.ndarray]) -> dict[str, np.ndarray]:
        return tree.near(k, lambda x: of(moving[x.number] if x.number < known else up))

    ws, alphas = others(lambda x: x.w), others(lambda x: x.alpha)
    w = steps.pick("the parent's angular velocity: in that of the link", up.w, **ws)
    alpha = steps.pick("the parent's angular acceleration: in that of the link", up.alpha, **alphas)
    r = pose.p0 - on.p0
    if k.moves:
        z = steps.turn(f"the joint's axis: {which}", pose.R0, k.z)
        qd, qdd = (of_joint(steps, tree, k, x, what) for x, what in ((v, "velocity"), (a, "acceleration")))
        z_qd, z_qdd = z * qd, z * qdd
        turning = cross(
            steps.pick("the parent's angular velocity: in w x z qd", up.w, **ws),
            z * of_joint(steps, tree, k, v, "velocity", "in w x z qd"),
        )
    if k.slides:
        r = steps.pick("the arm to a sliding link", r, **{"without its travel": product(on.R0, k.p)})
    elif k.moves:
        w = steps.add("the angular velocity of a turning link", **{"the parent's": w, "z qd": z_qd})
        rates = {"the parent's": alpha, "w x z qd": turning, "z qdd": z_qdd}
        alpha = steps.add("the angular acceleration of a turning link", **rates)
    site = f"that carries a link's origin: {which}"
    w_r = steps.pick(f"the angular velocity {site}", up.w, **{"the link's own": w}, **ws)
    alpha_r = steps.pick(f"the angular acceleration {site}", up.alpha, **{"the link's own": alpha}, **alphas)
    arms = {
        "that to its centre of mass": r + product(pose.R0, k.c), "that from the world's origin": pose.p0 + 0 * r,
        "in the parent's axes": product(transposed(on.R0), r),
    }  # fmt: skip
    r = steps.pick(f"the arm to a link's origin: {which}", r, **arms)
    up_a = steps.pick("the parent's acceleration", up.a, **others(lambda x: x.a))
    terms = {"the parent's": up_a, "alpha x r": cross(alpha_r, r), "w x (w x r)": cross(w_r, cross(w_r, r))}
    acc = steps.add(f"the acceleration of a link's origin: {which}", **terms)
    if k.slides:
        terms = {"that of the place where it is": acc, "2 w x z qd": 2 * turning, "z qdd": z_qdd}
        acc = steps.add("the acceleration of a sliding link", **terms)
    return Motion(w, alpha, acc, z if k.moves else up.z)


def _bodies(
    steps: Steps, tree: Tree, poses: list[Pose], moving: list[Motion], g: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Force and moment (about its origin) that each link needs for itself."""
    zero = 0 * moving[0].a
    f, n = [zero] * len(tree.links), [zero] * len(tree.links)
    for i, k in enumerate(tree.bodies):
        m, pose = moving[k.number], poses[k.number]
        c = steps.turn("the arm to the centre of mass", pose.R0, k.c)
        a_c = _of_centre(steps, tree, k, poses, moving, c)
        down = g + zero
        other = {"added at every link": (1 + depth(tree, k)) * down}
        if tree.floating:
            other["turned with the base"] = product(poses[0].R0, down)
        mass = {what: x + zero[..., :1] for what, x in (("in m a", k.mass), ("in m g", k.mass))}
        mass = {what: steps.pick(f"the mass of a body: {what}", x, **tree.masses(k, x)) for what, x in mass.items()}
        weight = mass["in m g"] * steps.pick("gravity", down, **other)
        F = steps.add("the force of a body", **{"m a": mass["in m a"] * a_c, "-m g": -weight})
        given = steps.pick(
            "the inertia about the centre of mass", k.tensor(steps), **{"that about the origin": k.about_origin}
        )
        I, spun = (
            steps.congruent(f"the inertia of a body: {where}", pose.R0, given) for where in ("in I alpha", "in w x I w")
        )
        others = tree.near(k, lambda x: moving[x.number].w)
        w = [steps.pick(f"the angular velocity in w x I w: {x}", m.w, **others) for x in ("its first", "its second")]
        for_spin = {
            "that of its principal moments, not turned": k.moments,
            "that about the link's origin, not turned": k.about_origin,
        }
        spun = steps.pick("the inertia in w x I w", spun, **for_spin)
        moments = {"I alpha": product(I, m.alpha), "w x I w": cross(w[0], product(spun, w[1]))}
        N = steps.add("the moment about the centre of mass", **moments)
        at = steps.pick("the point at which weight acts", c, **{"the link's origin": 0 * c})
        from_parent = pose.p0 - poses[max(0, k.parent)].p0
        arms = {
            "that from the parent's joint to the link's": from_parent, "that from the parent's joint": from_parent + c,
            "that from the world's origin": pose.p0 + c, "half as long": 0.5 * c,
        }  # fmt: skip
        arm = steps.pick("the arm of a body's own force", c, **arms)
        own = {"N": N, "r x f": cross(arm, F) + cross(at - c, -weight)}
        total = steps.add("a body's moment about the link's origin", **own)
        f[k.number] = steps.part("the forces of bodies", F + zero, i, len(tree.bodies))
        n[k.number] = steps.part("the moments of bodies", total + zero, i, len(tree.bodies))
    return f, n


def _of_centre(steps: Steps, tree: Tree, k: Link, poses: list[Pose], moving: list[Motion], c: np.ndarray) -> np.ndarray:
    """The acceleration of a body's centre."""
    m, up = moving[k.number], moving[max(0, k.parent)]
    ws, alphas = tree.near(k, lambda x: moving[x.number].w), tree.near(k, lambda x: moving[x.number].alpha)
    w = steps.pick("the angular velocity that carries a centre of mass", m.w, **{"the parent's": up.w}, **ws)
    alpha = steps.pick(
        "the angular acceleration that carries a centre of mass", m.alpha, **{"the parent's": up.alpha}, **alphas
    )
    from_parent = poses[k.number].p0 - poses[max(0, k.parent)].p0
    arms = {"that from the parent's joint to the link's": from_parent, "that from the parent's joint": from_parent + c}
    c = steps.pick("the arm that carries a centre of mass", c, **arms)
    terms = {"that of the origin": m.a, "alpha x r": cross(alpha, c), "w x (w x r)": cross(w, cross(w, c))}
    return np.asarray(steps.add("the acceleration of the centre of mass", **terms))


def felt(steps: Steps, k: Link, z: np.ndarray, f: np.ndarray, n: np.ndarray) -> np.ndarray:
    """What a joint feels of a force and a moment at its link's origin."""
    moment, push = (z * n).sum(-1), (z * f).sum(-1)
    if k.slides:
        return np.asarray(steps.pick("what a sliding joint feels", push, **{"the moment along its axis": moment}))
    return np.asarray(steps.pick("what a turning joint feels", moment, **{"the force along its axis": push}))


def _hand_on(steps: Steps, tree: Tree, k: Link, poses: list[Pose], f: list[np.ndarray], n: list[np.ndarray]) -> None:
    up, last, count = k.parent, k.number - 1, len(tree.links) - 1
    r = poses[k.number].p0 - poses[up].p0
    on = np.concatenate(np.broadcast_arrays(f[k.number], n[k.number]), -1)
    on = steps.pick("what a link hands on", on, nothing=0 * on)
    on = steps.pick("the children that hand on force and moment", on, **tree.alone(k, on))
    f_k, n_k = on[..., :3], on[..., 3:]
    pose, on_parent = poses[k.number], poses[up].p0 - poses[max(0, tree.links[up].parent)].p0
    arms = {
        "that to the child's centre of mass": lambda: r + product(pose.R0, tree.links[k.number].c),
        "that from the world's origin": lambda: pose.p0 + 0 * r,
        "that of the parent (index i in place of i + 1)": on_parent + 0 * r,
        "in the child's axes": lambda: product(transposed(pose.R0), r),
    }  # fmt: skip
    r = steps.pick("the arm in r x f", r, **arms)
    handed = steps.part("the links that hand on their force", f_k, last, count)
    handed = steps.pick("the children that hand on their force", handed, **tree.alone(k, handed))
    f[up] = steps.add("the force at a joint", **{HAVE: f[up], "the child's f": handed})
    handed = steps.part("the links that hand on their moment", n_k, last, count)
    n[up] = steps.add("the moment at a joint", **{HAVE: n[up], "the child's n": handed, "r x f": cross(r, f_k)})


def depth(tree: Tree, k: Link) -> int:
    """How many links it is from the base."""
    steps = 0
    while k.parent >= 0:
        k, steps = tree.links[k.parent], steps + 1
    return steps
