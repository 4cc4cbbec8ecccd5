"""Motions of links in the axes of the world, link by link from the base, as Newton's and Euler's equations need them.

    turning:  w = w_p + z qd     alpha = alpha_p + w_p x z qd + z qdd
    sliding:  w = w_p            alpha = alpha_p
    a = a_p + alpha_p x r + w_p x (w_p x r)   (+ 2 w_p x z qd + z qdd of a sliding link)

References: Siciliano et al., Robotics (2009), section 7.5; Spong et al., Robot Modeling and Control (2006), 7.6.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...subjects.layout import product, transposed
from .arrays import cross
from .in_place import SPIN, Whole, afterwards, array, found
from .link_axes import RESTING, axes, centripetal, own_rates, rate_in_cross, unturning
from .products import wedge
from .steps import Steps
from .tree import THAT_TURN, Link, Pose, Tree
from .velocities import BETWEEN, IN_SPIN, OF_BEFORE, SIZE, WHOSE_AXIS

RATE, ACCELERATION = "angular acceleration", "linear acceleration"


@dataclass
class Motion:
    """Of a link's frame, in world axes; z is the axis of its joint."""

    w: np.ndarray
    alpha: np.ndarray
    a: np.ndarray
    z: np.ndarray


def accelerations(
    steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, frames: Sequence[str]
) -> np.ndarray:
    """(runs, samples, frames, 6): alpha, and the acceleration of the frame's origin."""
    poses, moving, out = tree.poses(q), motions(steps, tree, q, v, a), []

    def still(number: int) -> dict[str, Callable[[], np.ndarray]]:
        def made() -> np.ndarray:
            m = motions(Steps(), tree, q, 0 * v, a)[number]
            return joined(m.alpha, m.a)

        return {"without products of velocities": made}

    for number, offset in (tree.frames[f] for f in frames):
        m, R = moving[number], poses[number].R0
        alpha, acc = np.split(steps.pick("the accelerations of links", joined(m.alpha, m.a), **still(number)), 2, -1)
        m = replace(m, alpha=alpha, a=acc)
        up = {"that of the parent": moving[max(0, tree.links[number].parent)].alpha + 0 * m.alpha}
        m = replace(m, alpha=steps.pick("the angular acceleration of a frame", m.alpha, **up))
        x = at_frame(steps, m.w, m.alpha, m.a, product(R, offset))
        more = x + joined(0 * m.alpha, cross(m.alpha, product(R, tree.links[number].c)))
        out.append(steps.pick("the whole acceleration of a frame", x, **{"with alpha x c of its link's centre": more}))
    lead = np.broadcast_shapes(*(x.shape for x in out))
    return np.stack([np.broadcast_to(x, lead) for x in out], axis=2)


def at_frame(steps: Steps, w: np.ndarray, alpha: np.ndarray, a: np.ndarray, r: np.ndarray) -> np.ndarray:
    """alpha and the acceleration of a point of a link."""
    terms = {
        "that of the link's origin": a,
        "alpha x r": wedge(steps, alpha, r),
        "w x (w x r)": centripetal(steps, "to a frame", w, alpha, r),
    }
    return np.concatenate(np.broadcast_arrays(alpha, steps.add("the acceleration of a frame", **terms)), -1)


def motions(steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> list[Motion]:
    poses = tree.poses(q)
    zero = np.zeros((*q.shape[:-1], 3), np.result_type(q, v, a))
    moving = [Motion(zero, zero, zero, zero)]
    if tree.floating:
        moving = [_base(steps, tree, poses[0].R0, v + 0 * q[..., :1], a + 0 * q[..., :1])]

    def whole() -> np.ndarray:
        turning = (k for k in tree.links if k.moves and not k.slides)
        return np.asarray(sum((poses[k.number].axis(k) * v[..., k.column, None] for k in turning), moving[0].w))

    for k in tree.links[1:]:
        moving.append(_next(steps, tree, k, poses, moving, whole, q, v, a))
    w = afterwards(steps, SPIN, [m.w for m in moving], whole)
    alpha, acc = (
        afterwards(steps, RATE, [m.alpha for m in moving]),
        afterwards(steps, ACCELERATION, [m.a for m in moving]),
    )
    return [Motion(x, y, z, m.z) for x, y, z, m in zip(w, alpha, acc, moving, strict=True)]


def _base(steps: Steps, tree: Tree, R: np.ndarray, v: np.ndarray, a: np.ndarray) -> Motion:
    """What is given in the base's axes."""
    angular, linear, first, second = v[..., :3], v[..., 3:6], a[..., :3], a[..., 3:6]
    w = steps.turn("the base's velocity, in its own axes: its angular part", R, angular)
    u = steps.turn("the base's velocity, in its own axes: its linear part", R, linear)
    w_u = steps.pick("w x v of the base", cross(w, u), **{"in the base's axes": cross(angular, linear)})
    given = steps.turn("the base's acceleration, in its own axes: its linear part", R, second)
    acc = steps.add("the acceleration of the base", **{"the given acceleration": given, "w x v": w_u})
    alpha = steps.turn("the base's acceleration, in its own axes: its angular part", R, first)
    exchanged = {
        "the velocity with its halves exchanged": lambda: joined(product(R, linear), alpha, given + cross(u, w)),
        "the acceleration with its halves exchanged": lambda: joined(w, product(R, second), product(R, first) + w_u),
    }  # fmt: skip
    moving = steps.mistaken("the base's motion", joined(w, alpha, acc), **exchanged)
    w, alpha, acc = np.split(
        steps.pick("the base's motion, of a floating base,", moving, **{RESTING: 0 * moving}), 3, -1
    )
    return Motion(w, alpha, acc, 0 * w)


def joined(*parts: np.ndarray) -> np.ndarray:
    """One after another along the last axis, where some have fewer runs."""
    return np.concatenate(np.broadcast_arrays(*parts), -1)


def kind(k: Link) -> str:
    """Which of a group of sites are those of a link."""
    return "of fixed links" if not k.moves else "of sliding links" if k.slides else "of turning links"


def _next(
    steps: Steps, tree: Tree, k: Link, poses: list[Pose], moving: list[Motion], whole: Whole, q: np.ndarray,
    v: np.ndarray, a: np.ndarray,
) -> Motion:  # fmt: skip
    which = kind(k)
    up, pose, on = moving[k.parent], poses[k.number], poses[k.parent]
    known = len(moving)

    def others(of: Callable[[Motion], np.ndarray]) -> dict[str, np.ndarray]:
        return tree.near(k, lambda x: of(moving[x.number] if x.number < known else up))

    up = _parent(steps, tree, k, moving, up, whole)
    ws, alphas = others(lambda x: x.w), others(lambda x: x.alpha)
    w = steps.pick("the parent's angular velocity: in that of the link", up.w, **ws)
    alpha = steps.pick("the parent's angular acceleration: in that of the link", up.alpha, **alphas)
    alpha = steps.mistaken("the parent's angular acceleration", alpha, **{"its angular velocity": up.w})
    r = steps.add(
        f"the arm between two links' origins: {which}", **{"the link's place": pose.p0, "the parent's place": -on.p0}
    )
    if k.moves:
        z = axis_of(steps, k, pose, on, which)
        qd, qdd = own_rates(steps, tree, k, q, v, a)
        # z itself may be wrong in all its uses; here it may be turned wrongly in one of them besides
        kinds, plain = f"of {'sliding' if k.slides else 'turning'} joints", pose.axis(k) + 0 * z
        own = (steps.turn(f"the axis z in {of}: {kinds}", pose.turns_axis, k.z) - plain for of in ("z qd", "z qdd"))
        z_qd, z_qdd = ((z + wrong) * rate for wrong, rate in zip(own, (qd, qdd), strict=True))
        there = rate_in_cross(steps, tree, k, q, v, a)
        turned = steps.pick("the parent's angular velocity: in w x z qd", up.w, **ws)
        about = steps.mistaken(
            f"z in w x z qd: {which}", z, **{"the link's angular velocity": up.w + (not k.slides) * z_qd}
        )
        turning = wedge(steps, turned, about * there)
    if k.slides:
        place = product(on.R0, k.p)
        parts = {"without its travel": place, "its travel alone": r - place}
        r = steps.pick("the arm to a sliding link", r, **parts)
        wrong = {"that with w x z qd, as of a turning one": alpha + turning}
        alpha = steps.pick("the angular acceleration of a sliding link", alpha, **wrong)
        w = steps.pick("z qd of a sliding link", w, **{IN_SPIN: w + z_qd})
    elif k.moves:
        of_parent = 0 * z if not k.parent else up.z if tree.links[k.parent].moves else on.R0[..., 0]
        z_qd = steps.pick(WHOSE_AXIS, z_qd, **{"the parent's": of_parent * qd})
        before = tree.joints_of(tree.links[k.parent])
        column = (before or [x for x in tree.links if x.moves])[-1].column
        of_before = {
            OF_BEFORE: z * v[..., column, None] * bool(before),
            f"{OF_BEFORE}, of the last one for the first": z * v[..., column, None],
        }
        z_qd = steps.pick(SIZE, z_qd, **{"without its sign": z * np.sqrt(qd * qd), **of_before})
        w = steps.add(f"the angular velocity of a link: {THAT_TURN}", **{"that of the parent": w, "z qd": z_qd})
        rates = {"the parent's": alpha, "w x z qd": turning, "z qdd": z_qdd}
        alpha = steps.add("the angular acceleration of a turning link", **rates)
    if not k.moves or k.slides:
        w, alpha = unturning(steps, which, w, alpha)
    site = f"that carries a link's origin: {which}"
    w_r = steps.pick(f"the angular velocity {site}", up.w, **{"the link's own": w}, **ws)
    alpha_r = steps.pick(f"the angular acceleration {site}", up.alpha, **{"the link's own": alpha}, **alphas)
    alpha_r = steps.mistaken("alpha in alpha x r", alpha_r, w=up.w)
    arms = {
        "that to its centre of mass": r + product(pose.R0, k.c), "that from the world's origin": pose.p0 + 0 * r,
        "in the parent's axes": product(transposed(on.R0), r), "in the link's axes": product(transposed(pose.R0), r),
        "that from the parent's centre of mass": r - product(on.R0, tree.links[k.parent].c), "of the other sign": -r,
        BETWEEN: r + product(pose.R0, k.c) - product(on.R0, tree.links[k.parent].c),
    }  # fmt: skip
    r = steps.pick(f"the arm to a link's origin: {which}", r, **arms)
    up_a = steps.pick("the parent's acceleration", up.a, **others(lambda x: x.a))
    w_w_r = centripetal(steps, f"to a link's origin: {which}", w_r, alpha_r, r, w if k.moves and not k.slides else None)
    terms = {"the parent's": up_a, "alpha x r": wedge(steps, alpha_r, r), "w x (w x r)": w_w_r}
    acc = carried = steps.add(f"the acceleration of a link's origin: {which}", **terms)
    if k.slides:
        terms = {"that of the place where it is": acc, "2 w x z qd": 2 * turning, "z qdd": z_qdd}
        acc = steps.add("the acceleration of a sliding link", **terms)
    if not k.moves:
        return Motion(w, alpha, acc, up.z)
    turned = (up.w + z_qd, up.alpha + turning + z_qdd, carried)
    slid = (up.w, up.alpha, carried + 2 * turning + z_qdd)
    return _of_other_joints(
        steps, k, Motion(w, alpha, acc, z), (up.w, up.alpha, carried), slid if not k.slides else turned
    )


def _of_other_joints(
    steps: Steps, k: Link, right: Motion, fixed: tuple[np.ndarray, ...], other: tuple[np.ndarray, ...]
) -> Motion:
    """The motion of a joint that is taken for another one."""
    which, another = ("sliding", "a turning one") if k.slides else ("turning", "a sliding one")
    others = {f"that of {another}": lambda: joined(*other), "that of a fixed one": lambda: joined(*fixed)}
    x = steps.pick(f"the motion of a {which} link", joined(right.w, right.alpha, right.a), **others)
    w, alpha, acc = np.split(x, 3, -1)
    return Motion(w, alpha, acc, right.z)


def _parent(steps: Steps, tree: Tree, k: Link, moving: list[Motion], up: Motion, whole: Whole) -> Motion:
    """What a link takes its motion from."""

    known = len(moving)

    def six(m: Motion) -> np.ndarray:
        return joined(m.w, m.alpha, m.a)

    others = tree.near(k, lambda x: six(moving[x.number] if x.number < known else up))
    w, alpha, acc = np.split(steps.pick("the motion that a link starts from", six(up), **others), 3, -1)
    w = steps.pick(array(SPIN), w, **found(moving[-1].w, whole))
    alpha = steps.pick(array(RATE), alpha, **found(moving[-1].alpha))
    return Motion(w, alpha, steps.pick(array(ACCELERATION), acc, **found(moving[-1].a)), up.z)


def axis_of(steps: Steps, k: Link, pose: Pose, on: Pose, which: str) -> np.ndarray:
    """z of a joint, in world axes."""
    other = {"by the parent's matrix, without the joint's own placement": lambda: on.R0}
    z = steps.turn(f"the joint's axis: {which}", pose.turns_axis, k.z, **other)
    return np.asarray(
        steps.pick(f"the joint's axis, in its motion: {which}", z, **axes(pose.R0, "of the link's frame"))
    )
