"""Newton's and Euler's equations link by link, in the axes of the world.

    turning:  w = w_p + z qd     alpha = alpha_p + w_p x z qd + z qdd
    sliding:  w = w_p            alpha = alpha_p
    a = a_p + alpha_p x r + w_p x (w_p x r)   (+ 2 w_p x z qd + z qdd of a sliding link)
    a_c = a + alpha x c + w x (w x c)         F = m a_c      N = I alpha + w x I w,  I = R I R^T
    f = F - m g + sum f_j                     n = N + c x (F - m g) + sum (n_j + r_j x f_j)

References: Siciliano et al., Robotics (2009), section 7.5; Spong et al., Robot Modeling and Control (2006), 7.6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...subjects.layout import product, transposed
from .link_axes import gathered
from .steps import Steps, cross
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
            columns[k.column] = _felt(steps, k, moving[k.number].z, f[k.number], n[k.number])
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
        moving.append(_next(steps, k, poses[k.number], poses[k.parent], moving[k.parent], v, a))
    return moving


def _next(steps: Steps, k: Link, pose: Pose, on: Pose, up: Motion, v: np.ndarray, a: np.ndarray) -> Motion:
    which = "of fixed links" if not k.moves else "of sliding links" if k.slides else "of turning links"
    w, alpha = up.w, up.alpha
    r = pose.p0 - on.p0
    if k.moves:
        z = steps.turn(f"the joint's axis: {which}", pose.R0, k.z)
        z_qd, z_qdd = z * v[..., k.column, None], z * a[..., k.column, None]
        turning = cross(up.w, z_qd)
    if k.slides:
        r = steps.pick("the arm to a sliding link", r, **{"without its travel": product(on.R0, k.p)})
    elif k.moves:
        w = steps.add("the angular velocity of a turning link", **{"the parent's": w, "z qd": z_qd})
        rates = {"the parent's": alpha, "w x z qd": turning, "z qdd": z_qdd}
        alpha = steps.add("the angular acceleration of a turning link", **rates)
    w_r = steps.pick(f"the angular velocity that carries a link's origin: {which}", up.w, **{"the link's own": w})
    alpha_r = steps.pick(
        f"the angular acceleration that carries a link's origin: {which}", up.alpha, **{"the link's own": alpha}
    )
    terms = {"the parent's": up.a, "alpha x r": cross(alpha_r, r), "w x (w x r)": cross(w_r, cross(w_r, r))}
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
        terms = {"that of the origin": m.a, "alpha x r": cross(m.alpha, c), "w x (w x r)": cross(m.w, cross(m.w, c))}
        a_c = steps.add("the acceleration of the centre of mass", **terms)
        down = g + zero
        other = {"added at every link": (1 + depth(tree, k)) * down}
        if tree.floating:
            other["turned with the base"] = product(poses[0].R0, down)
        weight = k.mass * steps.pick("gravity", down, **other)
        F = steps.add("the force of a body", **{"m a": k.mass * a_c, "-m g": -weight})
        given = steps.pick("the inertia about the centre of mass", k.I, **{"that about the origin": k.about_origin})
        I = steps.congruent("the inertia in world axes", pose.R0, given)
        moments = {"I alpha": product(I, m.alpha), "w x I w": cross(m.w, product(I, m.w))}
        N = steps.add("the moment about the centre of mass", **moments)
        at = steps.pick("the point at which weight acts", c, **{"the link's origin": 0 * c})
        arms = {"N": N, "r x f": cross(c, F) + cross(at - c, -weight)}
        own = steps.add("a body's moment about the link's origin", **arms)
        f[k.number] = steps.part("the forces of bodies", F + zero, i, len(tree.bodies))
        n[k.number] = steps.part("the moments of bodies", own + zero, i, len(tree.bodies))
    return f, n


def _felt(steps: Steps, k: Link, z: np.ndarray, f: np.ndarray, n: np.ndarray) -> np.ndarray:
    moment, push = (z * n).sum(-1), (z * f).sum(-1)
    if k.slides:
        return np.asarray(steps.pick("what a sliding joint feels", push, **{"the moment along its axis": moment}))
    return np.asarray(steps.pick("what a turning joint feels", moment, **{"the force along its axis": push}))


def _hand_on(steps: Steps, tree: Tree, k: Link, poses: list[Pose], f: list[np.ndarray], n: list[np.ndarray]) -> None:
    up, last, count = k.parent, k.number - 1, len(tree.links) - 1
    r = poses[k.number].p0 - poses[up].p0
    on = np.concatenate(np.broadcast_arrays(f[k.number], n[k.number]), -1)
    on = steps.pick("what a link hands on", on, nothing=0 * on)
    f_k, n_k = on[..., :3], on[..., 3:]
    have = "its own and that of earlier children"
    handed = steps.part("the links that hand on their force", f_k, last, count)
    f[up] = steps.add("the force at a joint", **{have: f[up], "the child's f": handed})
    handed = steps.part("the links that hand on their moment", n_k, last, count)
    n[up] = steps.add("the moment at a joint", **{have: n[up], "the child's n": handed, "r x f": cross(r, f_k)})


def depth(tree: Tree, k: Link) -> int:
    """How many links it is from the base."""
    steps = 0
    while k.parent >= 0:
        k, steps = tree.links[k.parent], steps + 1
    return steps
