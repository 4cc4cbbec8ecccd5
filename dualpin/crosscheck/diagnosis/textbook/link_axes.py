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

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...subjects.layout import product, transposed
from .arrays import cross
from .products import wedge
from .pushes import Wrenches
from .steps import HANDING, HAVE, Steps
from .tree import RATES_OF, THAT_TURN, Link, Pose, Tree, in_turn

OWN_FORCE = "the force in r x f, r to a link's centre of mass,"
WHOLE_FORCE = "that of the link with all that it carries, not its own"
RESTING = "that of a base that rests"
FIRST = "gravity at the first link that moves"


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


def pushed(steps: Steps, tree: Tree, q: np.ndarray, wrenches: Wrenches) -> np.ndarray:
    """tau (runs, samples, nv) of wrenches on links."""
    poses, zero = tree.poses(q), np.zeros((*q.shape[:-1], 3))

    def of(k: Link, i: int) -> np.ndarray:
        if k.number not in wrenches:
            return zero
        what = "the moment from outside" if i else "the force from outside"
        return steps.turn(f"what acts on a link, in world axes: {what}", transposed(poses[k.number].R0),
                          wrenches[k.number][i])  # fmt: skip

    f, n = ([of(k, i) for k in tree.links] for i in (0, 1))
    return _inward(steps, tree, poses, f, n, q)


def accelerations(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, frames: Sequence[str]
) -> np.ndarray:
    """(runs, samples, frames, 6): alpha, and the acceleration of the frame's origin, in world axes."""
    poses, moving, out = tree.poses(q), motions(steps, tree, q, v, a, np.zeros((1, 1, 3))), []
    for number, offset in (tree.frames[f] for f in frames):
        m, R = moving[number], poses[number].R0
        terms = {
            "that of the link's origin": m.a, "alpha x r": wedge(steps, m.alpha, offset),
            "w x (w x r)": wedge(steps, m.w, wedge(steps, m.w, offset)),
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
        moving.append(_next(steps, tree, k, poses[k.number], moving, q, v, a))
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
    right = Motion(w, a[..., :3], steps.add("the acceleration of the base", **terms))
    others = {
        RESTING: lambda: joined(Motion(0 * w, 0 * w, up)),
        "that with the velocity's halves exchanged":
            lambda: joined(Motion(linear, a[..., :3], a[..., 3:6] + cross(linear, w) + up)),
        "that with the acceleration's halves exchanged":
            lambda: joined(Motion(w, a[..., 3:6], a[..., :3] + cross(w, linear) + up)),
    }  # fmt: skip
    return Motion(*np.split(steps.pick("the base's motion, of a floating base,", joined(right), **others), 3, -1))


def joined(m: Motion) -> np.ndarray:
    return np.concatenate(np.broadcast_arrays(m.w, m.alpha, m.a), -1)


def _next(
    steps: Steps, tree: Tree, k: Link, pose: Pose, moving: list[Motion], q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> Motion:
    up = moving[k.parent]
    which = "of fixed links" if not k.moves else "of sliding links" if k.slides else "of turning links"
    R, p = transposed(pose.R), pose.p
    before = tree.near(k, lambda x: joined(moving[x.number] if x.number < len(moving) else up))
    up = Motion(*np.split(steps.pick("the motion that a link starts from", joined(up), **before), 3, -1))
    w_up = w = steps.turn(f"the parent's angular velocity: {which}", R, up.w)
    alpha_up = alpha = steps.turn(f"the parent's angular acceleration: {which}", R, up.alpha)
    if k.moves:
        qd, qdd = own_rates(steps, tree, k, q, v, a)
        qd_here = rate_in_cross(steps, tree, k, q, v, a)
    if k.moves and not k.slides:
        w = steps.add(f"the angular velocity of a link: {THAT_TURN}", **{"that of the parent": w_up, "z qd": k.z * qd})
        w_here = steps.turn("the parent's angular velocity: in w x z qd", R, up.w)
        alpha = steps.add(
            "the angular acceleration of a turning link",
            **{"the parent's": alpha_up, "w x z qd": wedge(steps, w_here, k.z * qd_here), "z qdd": k.z * qdd},
        )
    own = {"the link's own": lambda: w}
    w_arm = steps.pick(f"the angular velocity that carries a link's origin: {which}", up.w, **own)
    own = {"the link's own": lambda: alpha}
    alpha_arm = steps.pick(f"the angular acceleration that carries a link's origin: {which}", up.alpha, **own)
    others = {"in the link's axes, not the parent's": lambda: product(R, p)}
    others |= {
        "that to its centre of mass": lambda: p + product(pose.R, k.c),
        "that from the parent's centre of mass": lambda: p - tree.links[k.parent].c,
    }
    if k.slides:
        others["without the joint's travel"] = lambda: k.p + 0 * p
    arm = steps.pick(f"the arm to a link's origin: {which}", p, **others)
    w_w_r = centripetal(steps, f"to a link's origin: {which}", w_arm, alpha_arm, arm)
    terms = {"the parent's": up.a, "alpha x r": wedge(steps, alpha_arm, arm), "w x (w x r)": w_w_r}
    carried = steps.add(f"the acceleration of a link's origin: {which}", **terms)
    acc = steps.turn(f"the acceleration of a link's origin, found in the parent's axes: {which}", R, carried)
    if k.number in tree.first:
        acc = steps.pick(FIRST, acc, **unturned(k, pose, moving[0].a))
    if k.moves and k.slides:
        w_slide = steps.pick("the angular velocity in 2 w x z qd", w, **{"the parent's, in its axes": lambda: up.w})
        turning = 2 * wedge(steps, w_slide, k.z * qd_here)
        terms = {"that of the place where it is": acc, "2 w x z qd": turning, "z qdd": k.z * qdd}
        acc = steps.add("the acceleration of a sliding link", **terms)
    if not k.moves or k.slides:
        w, alpha = unturning(steps, which, w, alpha)
    return Motion(w, alpha, acc)


def unturning(steps: Steps, which: str, w: np.ndarray, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """w and alpha of a link that no joint turns on its parent, which are those of the parent."""
    site = f"of a link that no joint turns: {which}"
    w = steps.pick(f"the angular velocity {site}", w, zero=0 * w)
    return w, steps.pick(f"the angular acceleration {site}", alpha, zero=0 * alpha)


def unturned(k: Link, pose: Pose, up: np.ndarray) -> dict[str, np.ndarray]:
    """What may stand in the place of -g in a link's axes; `up` is -g in those of the world."""
    R = transposed(pose.R)
    joint = transposed(k.R) @ pose.R  # the turn of the joint alone
    return {
        "in the world's axes, not turned into the link's": up + 0 * pose.p,
        "turned by the placement of the joint alone, not by its position":
            product(joint @ transposed(pose.R0), up),
        "turned by the position of the joint alone, not by its placement": product(transposed(joint), up),
        "turned as if the link before it stood in the world's axes": product(R, up),
        "turned the other way": product(pose.R0, up),
    }  # fmt: skip


def centripetal(
    steps: Steps, where: str, w: np.ndarray, alpha: np.ndarray, r: np.ndarray, other: np.ndarray | None = None
) -> np.ndarray:
    """w x (w x r); `other` is the velocity of that of two links which does not turn r."""
    inner, few = wedge(steps, w, r), steps.few

    def twice(a: np.ndarray, b: np.ndarray) -> Callable[[], np.ndarray]:
        return lambda: cross(few(a), cross(few(b), few(r)))

    others: dict[str, Any] = {
        "w x r": inner, "w x (alpha x r)": twice(w, alpha), "alpha x (w x r)": twice(alpha, w),
        "alpha x (alpha x r)": twice(alpha, alpha),
        "(w . w) r": lambda: (few(w) * few(w)).sum(-1)[..., None] * few(r),
    }  # fmt: skip
    if other is not None:
        others |= {
            "w' x (w x r), of the two links": twice(other, w), "w x (w' x r), of the two links": twice(w, other),
        }  # fmt: skip
    return np.asarray(steps.pick(f"w x (w x r): {where}", wedge(steps, w, inner), **others))


def own_rates(
    steps: Steps, tree: Tree, k: Link, q: np.ndarray, v: np.ndarray, a: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and acceleration of a joint, along its axis."""
    qd, qdd = of_joint(steps, tree, k, v, "velocity"), of_joint(steps, tree, k, a, "acceleration")
    (qd,) = in_turn(steps, tree, k, RATES_OF, qd)
    mine = {
        name: x[..., i, None]
        for name, x, i in (
            ("its coordinate", q, k.place),
            ("its velocity", v, k.column),
            ("its acceleration", a, k.column),
        )
    }
    one = {"1": 0 * mine["its coordinate"] + 1}
    by_v = {name: x for name, x in mine.items() if name != "its velocity"}
    by_a = {name: x for name, x in mine.items() if name == "its velocity"}
    return (
        steps.mistaken("a joint's velocity along its axis", qd, **by_v, **one),
        steps.mistaken("a joint's acceleration along its axis", qdd, **by_a, **one),
    )


def rate_in_cross(steps: Steps, tree: Tree, k: Link, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """qd in w x z qd."""
    qd = of_joint(steps, tree, k, v, "velocity", "in w x z qd")
    others = {
        "its acceleration": a[..., k.column, None],
        "its coordinate": q[..., k.place, None],
        "1": 0 * q[..., :1] + 1,
    }
    kind = "of sliding joints" if k.slides else "of turning joints"
    return np.asarray(steps.mistaken(f"a joint's velocity in w x z qd: {kind}", qd, **others))


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
        a_c = _of_centre(steps, tree, k, m, moving)
        mass = steps.pick("the mass of a body", k.mass + zero[..., :1], **tree.masses(k, k.mass + zero[..., :1]))
        F = steps.add("the force of a body", **{"m a": mass * a_c})
        N = _about_centre(steps, tree, k, m, moving, a_c)
        f[k.number] = steps.part("the forces of bodies", F + zero, i, len(tree.bodies))
        arms = {
            "that from the parent's joint to the link's": tree.links[k.number].p, "half as long": 0.5 * k.c,
            "that from the parent's joint": k.p + product(k.R, k.c), "in the parent's axes": product(k.R, k.c),
        }  # fmt: skip
        arm = steps.pick("the arm of a body's own force", k.c, **arms)
        own = steps.add("a body's moment about the link's origin", **{"N": N, "r x f": wedge(steps, arm, F)})
        n[k.number] = steps.part("the moments of bodies", own + zero, i, len(tree.bodies))
    return f, n


def _of_centre(steps: Steps, tree: Tree, k: Link, m: Motion, moving: list[Motion]) -> np.ndarray:
    """The acceleration of a body's centre."""
    up = moving[max(0, k.parent)]
    ws, alphas = tree.near(k, lambda x: moving[x.number].w), tree.near(k, lambda x: moving[x.number].alpha)
    w = steps.pick("the angular velocity that carries a centre of mass", m.w, **{"the parent's": up.w}, **ws)
    alpha = steps.pick(
        "the angular acceleration that carries a centre of mass", m.alpha, **{"the parent's": up.alpha}, **alphas
    )
    alpha = steps.mistaken("alpha in alpha x c", alpha, w=m.w)
    arms = {
        "that from the parent's joint to the link's": k.p, "that from the parent's joint": k.p + product(k.R, k.c)
    }  # fmt: skip
    c = steps.pick("the arm that carries a centre of mass", k.c, **arms)
    terms = {
        "that of the origin": m.a, "alpha x r": wedge(steps, alpha, c),
        "w x (w x r)": centripetal(steps, "to a centre of mass", w, alpha, c, up.w),
    }  # fmt: skip
    a_c = steps.add("the acceleration of the centre of mass", **terms)
    return np.asarray(steps.pick("the acceleration in m a", a_c, **{"that of the link's origin": m.a + 0 * a_c}))


def _about_centre(steps: Steps, tree: Tree, k: Link, m: Motion, moving: list[Motion], a_c: np.ndarray) -> np.ndarray:
    """The moment of a body."""
    up = moving[max(0, k.parent)]
    others = {"the parent's": up.w, **tree.near(k, lambda x: moving[x.number].w)}
    sides = ("its first", "its second")
    w = [steps.pick(f"the angular velocity in w x I w: {x}", m.w, **others) for x in sides]
    w = [steps.mistaken(f"w in w x I w: {x}", y, alpha=m.alpha) for x, y in zip(sides, w, strict=True)]
    others = {"the parent's": up.alpha, **tree.near(k, lambda x: moving[x.number].alpha)}
    alpha = steps.pick("the angular acceleration in I alpha", m.alpha, **others)
    alpha = steps.mistaken("alpha in I alpha", alpha, w=m.w, **{"the acceleration of its centre": a_c})
    tensors = {
        "that about the link's origin": k.about_origin, "turned into the parent's axes": k.R @ k.I @ transposed(k.R),
        "its principal moments": k.moments, "its diagonal alone": k.I * np.eye(3),
        "zero, as of a point": 0 * k.I,
    }  # fmt: skip
    I = [
        steps.pick(f"the inertia about the centre of mass: in {x}", k.tensor(steps), **tensors)
        for x in ("I alpha", "w x I w")
    ]
    moments = {"I alpha": product(I[0], alpha), "w x I w": wedge(steps, w[0], product(I[1], w[1]))}
    return np.asarray(steps.add("the moment about the centre of mass", **moments))


def _inward(
    steps: Steps, tree: Tree, poses: list[Pose], f: list[np.ndarray], n: list[np.ndarray], q: np.ndarray
) -> np.ndarray:
    columns: dict[int, np.ndarray] = {}
    own = list(zip(f, n, strict=True))
    for k in reversed(tree.links):
        f_k, n_k, pose = f[k.number], n[k.number], poses[k.number]
        n_k = steps.pick(OWN_FORCE, n_k, **{WHOLE_FORCE: n_k + cross(k.c, f_k - own[k.number][0])})
        if k.moves:
            others = {f"that of the {which} joint": j.z for which, j in tree.neighbours(k).items()}
            others |= axes(np.eye(3)[None, None], "of the link's frame") | {
                "turned into the parent's axes": product(k.R, k.z)
            }
            which = "of sliding links" if k.slides else "of turning links"
            z = steps.pick(f"the axis along which a joint feels force or moment: {which}", k.z, **others)
            columns[k.column] = felt(steps, k, z, f_k, n_k, own[k.number])
        if k.parent < 0:
            continue
        six = np.concatenate(np.broadcast_arrays(f_k, n_k), -1)
        six = steps.pick("what a link hands on", six, nothing=0 * six)
        six = steps.part(HANDING, six, k.number - 1, len(tree.links) - 1)
        six = steps.summed("the force and moment that children hand on", six, **tree.alone(k, six))
        f_k, n_k = six[..., :3], six[..., 3:]
        handed = steps.turn("the force that is handed on", pose.R, f_k)
        pushed = steps.turn("the force in r x f", pose.R, f_k)
        turned = steps.turn("the moment that is handed on", pose.R, n_k)
        others = {
            "in the child's axes": product(transposed(pose.R), pose.p),
            "that of the parent (index i in place of i + 1)": poses[k.parent].p + 0 * pose.p,
            "without the joint's travel": k.p + 0 * pose.p,
        }
        others["that to the child's centre of mass"] = pose.p + product(pose.R, k.c)
        others["that from the parent's centre of mass"] = pose.p - tree.links[k.parent].c
        arm = steps.pick("the arm in r x f", pose.p, **others)
        turned = steps.mistaken("the moment that a link hands on", turned, **{"its force": handed})
        up, last, count = k.parent, k.number - 1, len(tree.links) - 1
        handed = steps.part("the links that hand on their force", handed, last, count)
        f[up] = steps.add("the force at a joint", **{HAVE: f[up], "the child's f": handed})
        turned = steps.part("the links that hand on their moment", turned, last, count)
        n[up] = moment(steps, tree, k, n[up], {"the child's n": turned, "r x f": wedge(steps, arm, pushed)})
    base = [n[0], f[0]] if tree.floating else []
    return gathered(columns, base, q)


def moment(steps: Steps, tree: Tree, k: Link, have: np.ndarray, handed: dict[str, np.ndarray]) -> np.ndarray:
    """That at a joint, with what a child hands on; in some codes children overwrite each other's."""
    whole = steps.add("the moment at a joint", **{HAVE: have, **handed})
    alone = {words: have + x for words, x in tree.alone(k, sum(handed.values(), 0 * have)).items()}
    whole = steps.summed("the moment that children hand on, with r x f,", whole, **alone)
    own = {"its own alone": have}
    return np.asarray(steps.pick("the moment at a joint, with those of its children,", whole, **own))


def gathered(columns: dict[int, np.ndarray], base: list[np.ndarray], q: np.ndarray) -> np.ndarray:
    """tau of its columns, behind the base's moment and force."""
    parts = [*base, *(columns[k][..., None] for k in sorted(columns))]
    lead = np.broadcast_shapes(q.shape[:-1], *(x.shape[:-1] for x in parts))
    return np.concatenate([np.broadcast_to(x, (*lead, x.shape[-1])) for x in parts], axis=-1)


def felt(
    steps: Steps, k: Link, z: np.ndarray, f: np.ndarray, n: np.ndarray,
    own: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:  # fmt: skip
    """What a joint feels of a force and a moment at its link's origin; `own` are those that the link itself needs."""
    mine, other = (f, n) if k.slides else (n, f)
    right = (z * mine).sum(-1)
    words = "the moment along its axis" if k.slides else "the force along its axis"
    others: dict[str, Any] = {words: (z * other).sum(-1), "zero": 0 * right}
    others["its size, whatever its direction"] = lambda: np.sqrt((mine * mine).sum(-1))
    if own is not None:
        alone = (z * own[0 if k.slides else 1]).sum(-1) + 0 * right
        others |= {"that of the links beyond alone": right - alone, "that of its own link alone": alone}
    site = "what a sliding joint feels" if k.slides else "what a turning joint feels"
    return np.asarray(steps.pick(site, right, **others))


def axes(R: np.ndarray, whose: str) -> dict[str, np.ndarray]:
    """The three axes of a frame, by name."""
    return {f"the {name} axis {whose}": R[..., i] for i, name in enumerate("xyz")}
