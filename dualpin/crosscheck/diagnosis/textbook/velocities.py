"""Velocities of all links of a tree whose poses are known, link by link from the base, in world axes.

    w = w_p + z qd (turning)        v = v_p + w_p x r (+ z qd, sliding)        z = R a,  r = p - p_p

References: Siciliano et al., Robotics (2009), section 3.1.3; Craig, Introduction to Robotics (2005), section 5.6.
"""

from __future__ import annotations

import numpy as np

from ...subjects.layout import product, transposed
from .arrays import cross
from .in_place import GROWING, SPEED, SPIN, afterwards, array
from .poses import Poses
from .products import wedge
from .references import six
from .steps import Steps
from .tree import RATES_OF, THAT_SLIDE, THAT_TURN

BETWEEN = "that between both centres of mass"
IN_SPIN = "added to its angular velocity, not to its velocity"
SIZE = "the rate qd in z qd, of a turning link,"
OF_BEFORE = "that of the joint before it"
WHOSE_AXIS = "the joint whose axis z is in z qd"
SPINS = (
    "the angular velocity of a link", "the angular velocity that a link starts from", "the motion that a link starts",
    "the parent's angular velocity", "the rate that turns a link", "the axis z in z qd", array(SPIN), SIZE, WHOSE_AXIS,
    "z qd of a sliding link",
)  # fmt: skip
"""Sites of angular velocities."""


def carried(t: Poses) -> Poses:
    """The same tree with `w` and `v` of all its links."""
    for link in range(1, len(t.R)):
        up = t.parent[link]
        if t.fused and not t.of_link[link]:
            _of_frame(t, link, up)
        else:
            _of_link(t, link, up)
    t.w, t.v = afterwards(t.steps, SPIN, t.w), afterwards(t.steps, SPEED, t.v)
    return t


def _of_link(t: Poses, link: int, up: int) -> None:
    """From the velocities of its parent."""
    steps, r = t.steps, t.p[link] - t.p[up]
    up_w, up_v = _start(t, link, up)
    turning, sliding = _rates(t, link, 0 * r)
    turns, slides = (any(t.axes[i].turns == x for i in t.of_link[link]) for x in (True, False))
    which = (THAT_TURN if turns else THAT_SLIDE) if t.of_link[link] else "of fixed links"
    w_up = steps.pick("the parent's angular velocity: in that of the link", up_w, **_near(t, link, t.w))
    rate = steps.pick("the rate that turns a link", turning, **{"that of a sliding joint too": turning + sliding})
    terms = {"that of the parent": w_up} | ({"z qd": rate} if turns else {})
    own = steps.add(f"the angular velocity of a link: {which}", **terms)
    own = own if turns else own + rate
    if not turns:
        kind = "of sliding links" if slides else "of fixed links"
        own = steps.pick(f"the angular velocity of a link that no joint turns: {kind}", own, zero=0 * own)
    carries = f"the angular velocity that carries a link's origin: {which.partition(': ')[0]}"
    w = steps.pick(carries, up_w, **{"the link's own": own}, **_near(t, link, t.w))
    others = {
        "that from the world's origin": t.p[link] + 0 * r, "the sum of both positions": r + 2 * t.p[up],
        "in the parent's axes": lambda: product(transposed(t.R[up]), r),
        "in the link's axes": lambda: product(transposed(t.R[link]), r),
        "without the travel of a sliding joint": lambda: r - t.travel.get(link, 0 * r), "of the other sign": -r,
        "that to its centre of mass": lambda: r + _centre(t, link, r),
        "that from the parent's centre of mass": lambda: r - _centre(t, up, r),
        BETWEEN: lambda: r + _centre(t, link, r) - _centre(t, up, r),
    }  # fmt: skip
    arm = steps.pick(f"the arm to a link's origin: {which.partition(': ')[0]}", r, **others)
    v_up = steps.pick("the parent's velocity", up_v, **_near(t, link, t.v))
    slid = steps.pick("the rate that slides a link", sliding, **{"that of a turning joint too": turning + sliding})
    terms = {"that of the parent": v_up, "w x r": wedge(steps, w, arm)}
    terms |= {"z qd of a sliding joint": slid} if slides else {}
    v = steps.add(f"the velocity of a link: {which}", **terms)
    v = v if slides else v + slid
    if t.of_link[link]:
        if slides:
            mistaken = {IN_SPIN: six(own + sliding, v - slid)}
            own, v = np.split(steps.pick("z qd of a sliding link", six(own, v), **mistaken), 2, -1)
        own, v = _of_other_joints(t, (own, v), (up_w, up_v + cross(up_w, r)), turning + sliding, turns)
    t.w.append(own)
    t.v.append(v)


def _of_other_joints(
    t: Poses, right: tuple[np.ndarray, np.ndarray], fixed: tuple[np.ndarray, np.ndarray], rate: np.ndarray, turns: bool
) -> tuple[np.ndarray, np.ndarray]:
    """The motion of a joint that is taken for another one."""
    (w, v), which = fixed, "turning" if turns else "sliding"
    another = ("a sliding one", (w, v + rate)) if turns else ("a turning one", (w + rate, v))
    others = {f"that of {what}": six(*x) for what, x in (another, ("a fixed one", fixed))}
    x = t.steps.pick(f"the motion of a {which} link", six(*right), **others)
    return x[..., :3], x[..., 3:]


def _rates(t: Poses, link: int, zero: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """z qd of the axes that turn a link, and of those that slide it."""
    assert t.qd is not None
    rates = [zero, zero]
    for i in t.of_link[link]:
        a = t.axes[i]
        site = f"the axis z in z qd: of {'turning' if a.turns else 'sliding'} joints"
        z = t.steps.turn(site, t.R[link], a.direction + zero) if a.world is None else a.world
        if a.turns:
            z = t.steps.pick(WHOSE_AXIS, z, **{"the parent's": _of_parent(t, link, z)})
        rate = a.ratio * t.qd[..., a.column, None]
        if not a.base:
            joints = [k for k, x in enumerate(t.axes) if not x.base]
            rate = t.steps.part(RATES_OF, rate, joints.index(i), len(joints))
        if a.turns:
            rate = t.steps.pick(SIZE, rate, **{"without its sign": np.sqrt(rate * rate), **_of_others(t, link)})
        rates[not a.turns] = rates[not a.turns] + z * rate
    return rates[0], rates[1]


def _of_others(t: Poses, link: int) -> dict[str, np.ndarray]:
    """The rate of the joint before one, on its way from the root."""
    assert t.qd is not None
    up, last = t.parent[link], t.axes[-1].column
    while up and not t.of_link[up]:
        up = t.parent[up]
    column = t.axes[t.of_link[up][-1]].column if t.of_link[up] else -1
    none = 0 * t.qd[..., :1]
    return {
        OF_BEFORE: t.qd[..., column, None] if column >= 0 else none,
        f"{OF_BEFORE}, of the last one for the first": t.qd[..., column if column >= 0 else last, None],
    }


def _centre(t: Poses, link: int, r: np.ndarray) -> np.ndarray:
    """R c of a link."""
    return product(t.R[link], t.centre(link) + 0 * r)


def _of_parent(t: Poses, link: int, z: np.ndarray) -> np.ndarray:
    """The axis of the parent's joint: none of the root, and x where a file names none."""
    up = t.parent[link]
    axes = [t.axes[i] for i in t.of_link[up]]
    if not up or not axes:
        return 0 * z + (t.R[up][..., 0] if up else 0.0)
    return product(t.R[up], axes[-1].direction + 0 * z) if axes[-1].world is None else axes[-1].world + 0 * z


def _of_frame(t: Poses, link: int, up: int) -> None:
    """Of a frame that is fixed on a body."""
    r = t.p[link] - t.p[up]
    others = {
        "that from the world's origin": t.p[link] + 0 * r,
        "in the body's axes": lambda: product(transposed(t.R[up]), r),
        "that to the body's centre of mass": lambda: product(t.R[up], t.centre(up) + 0 * r),
    }
    arm = t.steps.pick("the arm to a frame on a body", r, **others)
    terms = {"that of the body's origin": t.v[up], "w x r": wedge(t.steps, t.w[up], arm)}
    t.w.append(t.w[up])
    t.v.append(t.steps.add("the velocity of a frame on a body", **terms))


def _start(t: Poses, link: int, up: int) -> tuple[np.ndarray, np.ndarray]:
    """The twist that a link starts from."""
    both = [np.concatenate(np.broadcast_arrays(w, v), -1) for w, v in zip(t.w, t.v, strict=True)]
    six = t.steps.pick("the motion that a link starts from", both[up], **_near(t, link, both))
    w = t.steps.pick("the angular velocity that a link starts from", six[..., :3], **_near(t, link, t.w))
    w = t.steps.pick(array(SPIN), w, **{GROWING: t.w[t.before_in_list(link)]})
    return w, t.steps.pick(array(SPEED), six[..., 3:], **{GROWING: t.v[t.before_in_list(link)]})


def _near(t: Poses, link: int, of: list[np.ndarray]) -> dict[str, np.ndarray]:
    """What the link before in the list has."""
    return {f"that of the link before in the list{t.listing}": of[t.before_in_list(link)]}


def of_origin(steps: Steps, w: np.ndarray, v: np.ndarray, p: np.ndarray, o: np.ndarray) -> np.ndarray:
    """The velocity of a joint's origin o, made of that of the link on which it is, at p."""
    r = steps.pick("the arm in the velocity of a joint's origin", o - p, **{"that from the world's origin": o})
    terms = {"that of the link on which it is": v, "w x r": wedge(steps, w + 0 * r, r + 0 * w)}
    return np.asarray(steps.add("the velocity of a joint's origin", **terms))
