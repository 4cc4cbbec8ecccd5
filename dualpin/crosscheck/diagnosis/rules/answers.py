"""Other quantities of the same name: poses, Jacobians, centres of mass and momentum."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, quaternions, rotations, transposed
from ...subjects.questions import QUESTIONS
from ..case import Case, View, evaluate
from ..description import Description, homogeneous, merged
from ..displaced import displaced
from ..hypothesis import Hypothesis
from .register import SIX, proposer, rule

FRAMED_SIX = ("jacobian", "jacobian_dot")
OF_FRAMES = ("fk", *SIX, "frame_acceleration")
SEEN = ("fk", *SIX, "com", "com_jacobian", "centroidal_momentum_matrix")


# --- poses and frames ----------------------------------------------------------------------------


@rule(
    "inverse_pose",
    "the pose is that of the world in the frame",
    "return the frame's pose in the world",
    ("fk",),
    "change",
)
def inverse_pose(view: View, term: str, x: np.ndarray) -> np.ndarray:
    return np.linalg.inv(x)


@rule(
    "rotation_transposed",
    "rotations are transposed",
    "the columns of R are the frame's axes in the world",
    ("fk",),
    "change",
)
def rotation_transposed(view: View, term: str, x: np.ndarray) -> np.ndarray:
    out = x.copy()
    out[..., :3, :3] = transposed(x[..., :3, :3])
    return out


@rule("rotation_missing", "rotations are left out", "multiply the rotations in", ("fk",), "change", cost=1.1)
def rotation_missing(view: View, term: str, x: np.ndarray) -> np.ndarray:
    out = x.copy()
    out[..., :3, :3] = np.eye(3)
    return out


@rule(
    "at_com", "taken at the link's centre of mass, in the axes of <inertial>",
    "ask for the link's frame, not its inertial frame", OF_FRAMES, "change", cost=1.01,
)  # fmt: skip
def at_com(view: View, term: str, x: np.ndarray) -> np.ndarray:
    bodies = {p.link: p.body for p in view.description.parts}
    at = {k: homogeneous(b.rotation, b.com) for k, f in enumerate(view.frames) if (b := bodies.get(f)) is not None}
    return displaced(view, term, x, at)


@rule("at_com", "taken at the link's centre of mass", "ask for the link's frame, not for its centre of mass",
      OF_FRAMES, "change")  # fmt: skip
def at_link_com(view: View, term: str, x: np.ndarray) -> np.ndarray:
    """In the link's axes."""
    bodies = {p.link: p.body for p in view.description.parts}
    at = {k: homogeneous(np.eye(3), b.com) for k, f in enumerate(view.frames) if (b := bodies.get(f)) is not None}
    return displaced(view, term, x, at)


@rule("at_com", "taken at the centre of mass of the body that the link is part of (fixed links merged)",
      "ask for the link's frame, not for its centre of mass", OF_FRAMES, "change", cost=1.1)  # fmt: skip
def at_body_com(view: View, term: str, x: np.ndarray) -> np.ndarray:
    """In the link's axes."""
    whole, to = merged(view.description), view.description.carried()
    bodies = {p.link: p.body for p in whole.parts}
    at = {}
    for k, frame in enumerate(view.frames):
        carrier, H = to[frame]
        if (b := bodies.get(carrier)) is not None:
            at[k] = homogeneous(np.eye(3), (np.linalg.inv(H) @ np.append(b.com, 1.0))[:3])
    return displaced(view, term, x, at)


@rule("in_base", "seen from the base", "multiply the base's pose in", SEEN, "change", when=lambda case: case.floating)
def in_base(view: View, term: str, x: np.ndarray) -> np.ndarray:
    q = view.states["q"]
    R, p = transposed(rotations(q[:, 3:7])), q[:, :3]
    if term == "fk":
        H = np.zeros((len(q), 4, 4))
        H[:, :3, :3], H[:, :3, 3], H[:, 3, 3] = R, -product(R, p), 1.0
        return H[:, None] @ x
    if term == "com":
        return product(R, x - p)
    if term == "com_jacobian":
        return R @ x
    if term == "frame_velocity":
        return np.concatenate([product(R[:, None], x[..., :3]), product(R[:, None], x[..., 3:])], -1)
    R = R[:, None] if term in FRAMED_SIX else R
    return np.concatenate([R @ x[..., :3, :], R @ x[..., 3:, :]], -2)


@rule(
    "jacobian_linear_sign",
    "the linear rows have the other sign",
    "the linear part is axis x (frame - joint)",
    SIX,
    "change",
)
def linear_sign(view: View, term: str, x: np.ndarray) -> np.ndarray:
    out = x.copy()
    rows = out if term == "frame_velocity" else np.moveaxis(out, -2, -1)
    rows[..., 3:] *= -1
    return out


@rule("angular_only", "linear rows are zero", "fill the linear rows too", SIX, "change", cost=1.1)
def angular_only(view: View, term: str, x: np.ndarray) -> np.ndarray:
    rows = np.array([1.0, 1, 1, 0, 0, 0])
    return x * (rows if term == "frame_velocity" else rows[:, None])


@rule("linear_only", "angular rows are zero", "fill the angular rows too", SIX, "change", cost=1.1)
def linear_only(view: View, term: str, x: np.ndarray) -> np.ndarray:
    rows = np.array([0.0, 0, 0, 1, 1, 1])
    return x * (rows if term == "frame_velocity" else rows[:, None])


@proposer("parent_frame", "frames of the parent links are taken", "ask for the link that its joint moves")
def parent_frame(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """As where frames are counted from the joint before."""

    def of(taken: Callable[[Description], dict[str, str]]) -> Callable[[View, str], np.ndarray]:
        def act(view: View, term: str) -> np.ndarray:
            instead = taken(view.description)
            frames = [instead.get(f, f) for f in view.frames]
            inputs = {k: x[None] for k, x in view.states.items()}
            return evaluate(view.robot, QUESTIONS[term], inputs, frames, view.layout.how.reference)[0]

        return act

    def beside(step: int, names: Callable[[Description], Sequence[str]]) -> Callable[[Description], dict[str, str]]:
        """Counted along a list from another number."""
        return lambda d: dict(zip(names(d)[max(0, -step) :], names(d)[max(0, step) :], strict=False))

    h = replace(h, terms=OF_FRAMES, place="formula", cost=1.1)
    lists: dict[str, Callable[[Description], Sequence[str]]] = {
        "in the file": lambda d: d.links, "along the tree": lambda d: [d.root, *(p.link for p in d.parts)],
    }  # fmt: skip
    shifted = [
        replace(h, act=of(beside(step, names)), says=f"frames are those of the link {which} {words}", cost=1.15,
                fix="find the link by its name")
        for words, names in lists.items() for step, which in ((1, "after it"), (-1, "before it"))
    ]  # fmt: skip
    carrier = "frames on fixed joints are those of the links that carry them"
    return [
        replace(h, act=of(lambda d: {p.link: p.parent for p in d.parts})),
        replace(h, act=of(Description.carriers), says=carrier, fix="multiply the poses of fixed joints in"),
        *shifted,
    ]


@proposer("mixed_axes", "angular and linear rows are in different axes", "turn both alike")
def mixed_axes(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(local: slice) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            R, out = transposed(view.compute("fk")[..., :3, :3]), x.copy()
            out[:, :, local] = product(R, x[:, :, local]) if x.ndim == 3 else R @ x[:, :, local]
            return out

        words = f"{'angular' if local.start == 0 else 'linear'} ones in the frame's own"
        return replace(h, terms=("jacobian", "frame_velocity"), place="change", act=act, values=words, cost=1.1)

    if case.how.reference != "local_world_aligned":
        return []
    return [one(slice(0, 3)), one(slice(3, 6))]


@rule("acceleration_in_frame", "accelerations of frames are those of their origins, in the frames' own axes",
      "turn them into world axes", ("frame_acceleration",), "change", cost=1.05,
      when=lambda case: case.how.reference == "local_world_aligned")  # fmt: skip
def turned_into_the_frame(view: View, term: str, x: np.ndarray) -> np.ndarray:
    R = transposed(view.compute("fk")[..., :3, :3])
    return np.concatenate([product(R, x[..., :3]), product(R, x[..., 3:])], -1)


@proposer("position_units", "positions are multiplied by a number (other units)", "give them in metres")
def position_units(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str, k: float) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            out = x.copy()
            out[..., :3, 3] *= k
            return out

        return replace(h, terms=("fk",), place="change", act=act, values=words, cost=1.05)

    return [one("1000", 1e3), one("100", 1e2), one("1/1000", 1e-3), one("1/100", 1e-2)]


@rule("pose_quaternion", "the quaternion of poses is written in the other order", "return qw qx qy qz, or a 4x4 matrix",
      ("fk",), "change")  # fmt: skip
def pose_quaternion(view: View, term: str, x: np.ndarray) -> np.ndarray:
    out, q = x.copy(), quaternions(x[..., :3, :3])
    out[..., :3, :3] = rotations(np.roll(q, -1, axis=-1))
    return out


@rule("pose_transposed", "the 4x4 is transposed", "write it row by row, or declare its order", ("fk",), "change")
def pose_transposed(view: View, term: str, x: np.ndarray) -> np.ndarray:
    """As where rows and columns of a flat array are taken for each other."""
    return transposed(x)


@proposer("proper_acceleration", "gravity is taken from it, as an accelerometer does", "add gravity to it")
def proper_acceleration(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(sign: float) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            R, g = view.compute("fk")[..., :3, :3], np.array(view.description.gravity)
            out = x.copy()
            out[..., 3:] -= sign * (g @ R if view.layout.how.reference == "local" else g)
            return out

        return replace(h, terms=("frame_acceleration",), place="change", act=act, cost=1.0 + 0.1 * (sign < 0))

    return [one(1.0), replace(one(-1.0), says="gravity is added to it", fix="take gravity from it")]


@rule(
    "spatial_acceleration", "the acceleration is the spatial one, not that of the frame's origin (w x v is missing)",
    "add w x v to the linear part", ("frame_acceleration",), "change", cost=0.9,
    when=lambda case: case.how.reference == "local_world_aligned",
)  # fmt: skip
def spatial_acceleration(view: View, term: str, x: np.ndarray) -> np.ndarray:
    twist, out = view.compute("frame_velocity"), x.copy()
    out[..., 3:] -= np.cross(twist[..., :3], twist[..., 3:])
    return out


@rule("velocity_product_ignored", "J a alone: the rate of the Jacobian is left out", "add dJ/dt v",
      ("frame_acceleration",), "change")  # fmt: skip
def velocity_product_ignored(view: View, term: str, x: np.ndarray) -> np.ndarray:
    return x - np.einsum("nfij,nj->nfi", view.compute("jacobian_dot"), view.states["v"])


# --- rates of Jacobians --------------------------------------------------------------------------


def _turned(source: str) -> Callable[[View, str, np.ndarray], np.ndarray]:
    """The rate of another Jacobian, brought to the axes asked for without the rate of the turning."""

    def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
        D, P = view.compute("jacobian_dot", source), view.compute("fk")
        R, p = P[..., :3, :3], P[..., :3, 3]
        if source == "local":
            return np.concatenate([R @ D[..., :3, :], R @ D[..., 3:, :]], -2)
        return np.concatenate([D[..., :3, :], D[..., 3:, :] - cross_matrix(p) @ D[..., :3, :]], -2)

    return act


def _absolute(view: View, term: str, x: np.ndarray) -> np.ndarray:
    """The world's rate moved here, and the turning of the frame's axes on top of it."""
    D, J = _turned("world")(view, term, x), view.compute("jacobian")
    W = cross_matrix(view.compute("frame_velocity")[..., :3])
    return D + np.concatenate([W @ J[..., :3, :], W @ J[..., 3:, :]], -2)


RATES: dict[str, tuple[str, Callable[[View, str, np.ndarray], np.ndarray]]] = {
    "jdot_zero": ("the rate of the Jacobian is zero", lambda view, term, x: 0 * x),
    "jdot_local": ("the rate of the local Jacobian, turned without the rate of the turning", _turned("local")),
    "jdot_world": ("the rate of the world's Jacobian, moved without the rate of the moving", _turned("world")),
    "jdot_absolute": (
        "columns are not taken relative to the frame: V_k x s_k in place of (V_k - V_f) x s_k",
        _absolute,
    ),
}


@proposer(
    "jdot_*", "the rate of another Jacobian", "differentiate the Jacobian that is returned",
    {key: says for key, (says, _) in RATES.items()},
)  # fmt: skip
def jacobian_rates(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(
            h,
            key=k,
            says=says,
            terms=("jacobian_dot",),
            place="change",
            act=f,
            cost=0.94 if k == "jdot_zero" else h.cost,
        )
        for k, (says, f) in RATES.items()
    ]  # a rate of zero is plainer than a velocity that is ignored


@rule(
    "same_product",
    "another matrix with the same product Jdot v",
    "nothing, if only Jdot v is used",
    ("jacobian_dot",),
    "relation",
    cost=1.5,
)
def same_product(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    v = view.case.sent["v"]
    lacks = np.einsum("nfij,nj->nfi", x - observed, v)
    return observed + lacks[..., None] * (v / (v**2).sum(-1, keepdims=True))[:, None, None, :]
