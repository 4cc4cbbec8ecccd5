"""Newton's and Euler's equations from link to link, each link in its own axes.

Outward, with R and p the pose of a link on its parent:

    turning:  w = R^T w_p + z qd      alpha = R^T alpha_p + R^T w_p x z qd + z qdd
              a = R^T (a_p + alpha_p x p + w_p x (w_p x p))
    sliding:  w = R^T w_p             alpha = R^T alpha_p
              a = R^T (a_p + alpha_p x p + w_p x (w_p x p)) + 2 w x z qd + z qdd
    a_c = a + alpha x c + w x (w x c)      F = m a_c      N = I alpha + w x I w

Inward:  f = F + sum R f_j      n = N + c x F + sum (R n_j + p_j x R f_j)      tau = z . n  or  z . f

References: Craig, Introduction to Robotics (2005), equations 6.45 to 6.53; Luh, Walker and Paul (1980).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...subjects.layout import product, transposed
from .steps import HAVE, Steps, cross
from .tree import Link, Pose, Tree


@dataclass
class Motion:
    """Of a link's frame, in its own axes."""

    w: np.ndarray
    alpha: np.ndarray
    a: np.ndarray


def forces(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
    """tau (runs, samples, nv) of velocities and accelerations, under the gravity g."""
    poses, moving = tree.poses(q), motions(steps, tree, q, v, a, g)
    f, n = _bodies(steps, tree, moving)
    return _inward(steps, tree, poses, f, n, q)


def accelerations(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, frames: Sequence[str]
) -> np.ndarray:
    """(runs, samples, frames, 6): alpha, and the acceleration of the frame's origin, in world axes."""
    poses, moving, out = tree.poses(q), motions(steps, tree, q, v, a, np.zeros((1, 1, 3))), []
    for number, offset in (tree.frames[f] for f in frames):
        m, R = moving[number], poses[number].R0
        terms = {
            "that of the link's origin": m.a, "alpha x r": cross(m.alpha, offset),
            "w x (w x r)": cross(m.w, cross(m.w, offset)),
        }  # fmt: skip
        acc = steps.turn(
            "the acceleration of a frame, in its link's axes,", R, steps.add("the acceleration of a frame", **terms)
        )
        alpha = steps.turn("the angular acceleration of a frame", R, m.alpha)
        out.append(np.concatenate(np.broadcast_arrays(alpha, acc), -1))
    lead = np.broadcast_shapes(*(x.shape for x in out))
    return np.stack([np.broadcast_to(x, lead) for x in out], axis=2)


def motions(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> list[Motion]:
    poses = tree.poses(q)
    moving = [_base(steps, tree, poses[0], v, a, g)]
    for k in tree.links[1:]:
        moving.append(_next(steps, tree, k, poses[k.number], moving[k.parent], v, a))
    return moving


def _base(steps: Steps, tree: Tree, pose: Pose, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> Motion:
    """Gravity enters as an acceleration of the base."""
    back = transposed(pose.R0)
    if not tree.floating:
        zero = np.zeros((*v.shape[:-1], 3), v.dtype)
        return Motion(zero, zero, zero - product(back, g))
    w, linear = v[..., :3], v[..., 3:6]
    up = -steps.turn("gravity, in world axes,", back, g + 0 * linear)
    terms = {"the given acceleration": a[..., 3:6], "w x v": cross(w, linear), "-g": up}
    return Motion(w, a[..., :3], steps.add("the acceleration of the base", **terms))


def _next(steps: Steps, tree: Tree, k: Link, pose: Pose, up: Motion, v: np.ndarray, a: np.ndarray) -> Motion:
    which = "of fixed links" if not k.moves else "of sliding links" if k.slides else "of turning links"
    R, p = transposed(pose.R), pose.p
    w_up = w = steps.turn(f"the parent's angular velocity: {which}", R, up.w)
    alpha_up = alpha = steps.turn(f"the parent's angular acceleration: {which}", R, up.alpha)
    if k.moves:
        qd, qdd = of_joint(steps, tree, k, v, "velocity"), of_joint(steps, tree, k, a, "acceleration")
    if k.moves and not k.slides:
        w = steps.add("the angular velocity of a turning link", **{"the parent's": w_up, "z qd": k.z * qd})
        w_here = steps.turn("the angular velocity in w x z qd", R, up.w)
        qd_here = of_joint(steps, tree, k, v, "velocity", "in w x z qd")
        alpha = steps.add(
            "the angular acceleration of a turning link",
            **{"the parent's": alpha_up, "w x z qd": cross(w_here, k.z * qd_here), "z qdd": k.z * qdd},
        )
    own = {"the link's own": lambda: w}
    w_arm = steps.pick(f"the angular velocity that carries a link's origin: {which}", up.w, **own)
    own = {"the link's own": lambda: alpha}
    alpha_arm = steps.pick(f"the angular acceleration that carries a link's origin: {which}", up.alpha, **own)
    others = {"in the link's axes, not the parent's": lambda: product(R, p)}
    if k.slides:
        others["without the joint's travel"] = lambda: k.p + 0 * p
    arm = steps.pick(f"the arm to a link's origin: {which}", p, **others)
    terms = {
        "the parent's": up.a, "alpha x r": cross(alpha_arm, arm), "w x (w x r)": cross(w_arm, cross(w_arm, arm))
    }  # fmt: skip
    carried = steps.add(f"the acceleration of a link's origin: {which}", **terms)
    acc = steps.turn(f"the acceleration of a link's origin, found in the parent's axes: {which}", R, carried)
    if k.moves and k.slides:
        w_slide = steps.pick("the angular velocity in 2 w x z qd", w, **{"the parent's, in its axes": lambda: up.w})
        acc = steps.add(
            "the acceleration of a sliding link",
            **{"that of the place where it is": acc, "2 w x z qd": 2 * cross(w_slide, k.z * qd), "z qdd": k.z * qdd},
        )
    return Motion(w, alpha, acc)


def of_joint(steps: Steps, tree: Tree, k: Link, x: np.ndarray, what: str, where: str = "along its axis") -> np.ndarray:
    """The velocity or acceleration of a joint."""
    others = {f"that of the {which} joint": x[..., j.column, None] for which, j in tree.neighbours(k).items()}
    return np.asarray(steps.pick(f"the {what} of a joint: {where}", x[..., k.column, None], **others))


def _bodies(steps: Steps, tree: Tree, moving: list[Motion]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Force and moment (about its origin) that each link needs for itself."""
    zero = 0 * moving[0].a
    f, n = [zero] * len(tree.links), [zero] * len(tree.links)
    for i, k in enumerate(tree.bodies):
        m = moving[k.number]
        w_c = steps.pick(
            "the angular velocity in w x (w x c)", m.w, **{"the parent's": lambda k=k: moving[max(0, k.parent)].w}
        )
        alpha_c = steps.pick(
            "the angular acceleration in alpha x c", m.alpha,
            **{"the parent's": lambda k=k: moving[max(0, k.parent)].alpha},
        )  # fmt: skip
        a_c = steps.add(
            "the acceleration of the centre of mass",
            **{
                "that of the origin": m.a, "alpha x r": cross(alpha_c, k.c),
                "w x (w x r)": cross(w_c, cross(w_c, k.c)),
            },
        )  # fmt: skip
        F = steps.add("the force of a body", **{"m a": k.mass * a_c})
        w_I = steps.pick(
            "the angular velocity in w x I w", m.w, **{"the parent's": lambda k=k: moving[max(0, k.parent)].w}
        )
        I = steps.pick("the inertia", k.tensor(steps), **{"that about the link's origin": lambda k=k: k.about_origin})
        N = steps.add(
            "the moment about the centre of mass",
            **{"I alpha": product(I, m.alpha), "w x I w": cross(w_I, product(I, w_I))},
        )
        f[k.number] = steps.part("the forces of bodies", F + zero, i, len(tree.bodies))
        arms = {"that of the link from its parent": tree.links[k.number].p, "half as long": 0.5 * k.c}
        arm = steps.pick("the arm of a body's own force", k.c, **arms)
        own = steps.add("a body's moment about the link's origin", **{"N": N, "r x f": cross(arm, F)})
        n[k.number] = steps.part("the moments of bodies", own + zero, i, len(tree.bodies))
    return f, n


def _inward(
    steps: Steps, tree: Tree, poses: list[Pose], f: list[np.ndarray], n: list[np.ndarray], q: np.ndarray
) -> np.ndarray:
    columns: dict[int, np.ndarray] = {}
    for k in reversed(tree.links):
        f_k, n_k, pose = f[k.number], n[k.number], poses[k.number]
        if k.moves:
            others = {f"that of the {which} joint": j.z for which, j in tree.neighbours(k).items()}
            z = steps.pick("the axis along which a joint feels force or moment", k.z, **others)
            moment, push = (z * n_k).sum(-1), (z * f_k).sum(-1)
            columns[k.column] = (
                steps.pick("what a sliding joint feels", push, **{"the moment along its axis": moment})
                if k.slides
                else steps.pick("what a turning joint feels", moment, **{"the force along its axis": push})
            )
        if k.parent < 0:
            continue
        six = np.concatenate(np.broadcast_arrays(f_k, n_k), -1)
        six = steps.pick("what a link hands on", six, nothing=0 * six)
        six = steps.pick("the children that hand on force and moment", six, **tree.alone(k, six))
        f_k, n_k = six[..., :3], six[..., 3:]
        handed = steps.turn("the force that is handed on", pose.R, f_k)
        pushed = steps.turn("the force in r x f", pose.R, f_k)
        turned = steps.turn("the moment that is handed on", pose.R, n_k)
        others = {
            "in the child's axes": product(transposed(pose.R), pose.p),
            "that of the parent (index i in place of i + 1)": poses[k.parent].p + 0 * pose.p,
            "without the joint's travel": k.p + 0 * pose.p,
        }
        arm = steps.pick("the arm in r x f", pose.p, **others)
        up, last, count = k.parent, k.number - 1, len(tree.links) - 1
        handed = steps.part("the links that hand on their force", handed, last, count)
        f[up] = steps.add("the force at a joint", **{HAVE: f[up], "the child's f": handed})
        turned = steps.part("the links that hand on their moment", turned, last, count)
        n[up] = steps.add(
            "the moment at a joint", **{HAVE: n[up], "the child's n": turned, "r x f": cross(arm, pushed)}
        )
    base = [n[0], f[0]] if tree.floating else []
    return gathered(columns, base, q)


def gathered(columns: dict[int, np.ndarray], base: list[np.ndarray], q: np.ndarray) -> np.ndarray:
    """tau of its columns, behind the base's moment and force."""
    parts = [*base, *(columns[k][..., None] for k in sorted(columns))]
    lead = np.broadcast_shapes(q.shape[:-1], *(x.shape[:-1] for x in parts))
    return np.concatenate([np.broadcast_to(x, (*lead, x.shape[-1])) for x in parts], axis=-1)
