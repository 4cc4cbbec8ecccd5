"""Other quantities of the same name, answers half filled or turned round, and forces that are in them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.layout import cross_matrix, product, rotations, transposed
from ..case import Case, View
from ..description import Description, homogeneous
from ..hypothesis import ALL, FORCED, SIX, Hypothesis, proposer, rule

FRAMED_SIX = ("jacobian", "jacobian_dot")
SEEN = ("fk", *SIX, "com", "com_jacobian", "centroidal_momentum_matrix")


# --- poses and frames ----------------------------------------------------------------------------


@rule("inverse_pose", "the pose is that of the world in the frame", "return the frame's pose in the world", ("fk",), "change")
def inverse_pose(view: View, term: str, x: np.ndarray) -> np.ndarray:
    return np.linalg.inv(x)


@rule("rotation_transposed", "rotations are transposed", "the columns of R are the frame's axes in the world", ("fk",), "change")
def rotation_transposed(view: View, term: str, x: np.ndarray) -> np.ndarray:
    out = x.copy()
    out[..., :3, :3] = transposed(x[..., :3, :3])
    return out


@rule("at_com", "taken at the link's centre of mass", "ask for the link's frame, not its inertial frame", ("fk", *SIX), "change")
def at_com(view: View, term: str, x: np.ndarray) -> np.ndarray:
    poses, out = view.compute("fk"), x.copy()
    bodies = {p.link: p.body for p in view.description.parts}
    for k, frame in enumerate(view.frames):
        body = bodies.get(frame)
        if body is None:
            continue
        if term == "fk":
            out[:, k] = x[:, k] @ homogeneous(body.rotation, body.com)
            continue
        arm = cross_matrix(poses[:, k, :3, :3] @ body.com)
        if term == "frame_velocity":
            out[:, k, 3:] -= product(arm, x[:, k, :3])
        else:
            out[:, k, 3:] -= arm @ x[:, k, :3]
    return out


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


@rule("jacobian_linear_sign", "the linear rows have the other sign", "the linear part is axis x (frame - joint)", SIX, "change")
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
    "jdot_absolute": ("columns are not taken relative to the frame: V_k x s_k in place of (V_k - V_f) x s_k", _absolute),
}


@proposer("jdot_*", "the rate of another Jacobian: jdot_zero, jdot_local, jdot_world, jdot_absolute", "differentiate the Jacobian that is returned")
def jacobian_rates(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, key=k, says=says, terms=("jacobian_dot",), place="change", act=f) for k, (says, f) in RATES.items()]


@rule("same_product", "another matrix with the same product Jdot v", "nothing, if only Jdot v is used", ("jacobian_dot",), "answer", cost=1.5)
def same_product(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    v = view.case.sent["v"]
    lacks = np.einsum("nfij,nj->nfi", x - observed, v)
    return observed + lacks[..., None] * (v / (v**2).sum(-1, keepdims=True))[:, None, None, :]


# --- matrices ------------------------------------------------------------------------------------


def _answer(f: Callable[[np.ndarray], np.ndarray]) -> Callable[..., np.ndarray]:
    return lambda view, term, x, observed: f(x)


SQUARE = {
    "upper": ("only the upper triangle is filled", np.triu, ("crba", "minv"), "fill the lower triangle by symmetry"),
    "lower": ("only the lower triangle is filled", np.tril, ("crba", "minv"), "fill the upper triangle by symmetry"),
    "diagonal": ("only the diagonal is filled", lambda x: x * np.eye(x.shape[-1]), ("crba", "minv"), "fill all of the matrix"),
    "transposed": ("the matrix is transposed", transposed, ("coriolis",), "transpose it"),
    "coriolis_symmetric": ("only the symmetric part, dM/dt / 2", lambda x: (x + transposed(x)) / 2, ("coriolis",), "C also has a skew part"),
    "coriolis_rate": ("dM/dt itself", lambda x: x + transposed(x), ("coriolis",), "C v is dM/dt v - (1/2) d(v M v)/dq"),
    "coriolis_skew": ("only the skew part", lambda x: (x - transposed(x)) / 2, ("coriolis",), "C also has the symmetric part dM/dt / 2"),
}  # fmt: skip


@proposer("upper, lower, ...", "the matrix is half filled or turned round: upper, lower, diagonal, transposed, coriolis_rate, ...", "fill all of it")
def square(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [
        replace(h, key=k, says=says, terms=terms, place="answer", act=_answer(f), fix=fix)
        for k, (says, f, terms, fix) in SQUARE.items()
    ]


@rule(
    "coriolis_other", "another factorisation: dM/dt - (1/2) (d(M v)/dq)^T",
    "nothing where C v is used; use Christoffel's symbols where dM/dt = C + C^T must hold", ("coriolis",), "change",
)  # fmt: skip
def coriolis_other(view: View, term: str, C: np.ndarray) -> np.ndarray:
    return C + transposed(C) - 0.5 * transposed(_momentum_by_q(view))


@rule("coriolis_other", "another factorisation: d(M v)/dq - (1/2) (d(M v)/dq)^T", "nothing where C v is used; use Christoffel's symbols where dM/dt = C + C^T must hold", ("coriolis",), "change")
def coriolis_momentum(view: View, term: str, C: np.ndarray) -> np.ndarray:
    B = _momentum_by_q(view)
    return B - 0.5 * transposed(B)


def _momentum_by_q(view: View) -> np.ndarray:
    """d(M v)/dq at a given v, in its tangent space."""
    from ....boundary import call

    s, zero = view.states, np.zeros_like(view.states["v"])
    robot = view.case.robot if view.description is view.case.description else view.robot
    by_q = [call(robot, "rnea_derivatives", {"q": s["q"], "v": zero, "a": a}, engine="numpy")[:, 0] for a in (s["v"], zero)]
    return np.asarray(by_q[0] - by_q[1])


@rule("same_cv", "another matrix with the same product C v", "nothing where only C v is used", ("coriolis",), "answer", cost=1.5)
def same_cv(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    v = view.case.sent["v"]
    lacks = product(x - observed, v)
    return observed + lacks[..., None] * v[:, None, :] / (v**2).sum(-1)[:, None, None]


@rule(
    "coriolis_frozen", "that of the inertial frame, brought to the base's columns without the rate of the turning",
    "add P^T M dP/dt", ("coriolis",), "answer", when=lambda case: case.floating,
)  # fmt: skip
def coriolis_frozen(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    from ...subjects.layout import Layout

    C, M, s = view.compute("coriolis"), view.compute("crba"), view.states
    other = Layout(view.case.robot, replace(view.layout.how, angular="world", linear="origin"))
    P = other.matrices(s["q"], s["v"])[0] @ np.linalg.inv(view.layout.matrices(s["q"], s["v"])[0])
    return transposed(P) @ other.answer("coriolis", C, s, M) @ P


@rule("sign", "the sign is reversed", "return the negative", ("gravity", *FORCED, "coriolis", "jacobian_dot", "potential_energy"), "answer")
def sign(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    return -x


@rule("single_precision", "answers are rounded to single precision", "return arrays of doubles", ALL, "answer", cost=1.1)
def answers_in_single_precision(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    return np.asarray(x.astype(np.float32), float)


# --- mass and momentum ---------------------------------------------------------------------------


@rule("about_origin", "the momentum is about the origin of the world", "take it about the centre of mass", ("centroidal_momentum_matrix",), "change")
def about_origin(view: View, term: str, x: np.ndarray) -> np.ndarray:
    out = x.copy()
    out[:, :3] += cross_matrix(view.compute("com")) @ x[:, 3:]
    return out


@rule(
    "base_counts", "the base link's mass counts", "leave the link that cannot move out of it",
    ("com", "com_jacobian", "centroidal_momentum_matrix", "potential_energy"), "change",
    when=lambda case: not case.floating and case.description.base is not None,
)  # fmt: skip
def base_counts(view: View, term: str, x: np.ndarray) -> np.ndarray:
    m, c = _ground(view.description)
    moving = view.robot_mass
    com = view.compute("com")
    whole = moving + m
    if term == "com":
        return (moving * com + m * c) / whole
    if term == "com_jacobian":
        return x * moving / whole
    if term == "potential_energy":
        return x - m * (c @ np.array(view.description.gravity))
    new = (moving * com + m * c) / whole
    out = x.copy()
    out[:, :3] -= cross_matrix(new - com) @ x[:, 3:]
    return out


def _ground(d: Description) -> tuple[float, np.ndarray]:
    """Mass and centre of all links that no joint moves."""
    where = {d.root: np.eye(4)}
    mass, moment = (d.base.mass, d.base.mass * d.base.com) if d.base is not None else (0.0, np.zeros(3))
    for p in d.parts:
        if not p.moves and p.parent in where:
            where[p.link] = where[p.parent] @ p.pose
            if p.body is not None:
                mass += p.body.mass
                moment = moment + p.body.mass * (where[p.link] @ np.append(p.body.com, 1))[:3]
    return mass, moment / mass if mass else moment


@rule("potential_offset", "heights are counted from elsewhere", "nothing, if only differences are used", ("potential_energy",), "answer", cost=1.2)
def potential_offset(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    return x + np.nanmean(observed - x)


# --- forces --------------------------------------------------------------------------------------


def _gravity(g: tuple[float, float, float]) -> Callable[..., Description]:
    return lambda d, items: replace(d, gravity=g)


@proposer("no_gravity_in_bias", "gravity is not in it", "add the gravity term, or call it C v")
def no_gravity_in_bias(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, terms=("bias",), place="edit", act=_gravity((0.0, 0.0, 0.0)), cost=0.9)]


def _has(what: str) -> Callable[[Case], bool]:
    return lambda case: any(getattr(p, what) for p, _ in case.parts())


@rule("damping", "the file's joint damping is in it", "set <dynamics damping> to 0, or subtract D v", FORCED, "force", when=_has("damping"))
def damping(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.damping) * view.states["v"]


@rule("damping_sign", "the file's joint damping is in it with the other sign", "damping opposes the motion: tau has + D v", FORCED, "force", when=_has("damping"))
def damping_sign(view: View) -> np.ndarray:
    return -damping(view)


@rule("friction", "the file's joint friction is in it", "set <dynamics friction> to 0, or subtract f sign(v)", FORCED, "force", when=_has("friction"))
def friction(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.friction) * np.sign(view.states["v"])


@rule("friction_sign", "the file's joint friction is in it with the other sign", "friction opposes the motion: tau has + f sign(v)", FORCED, "force", when=_has("friction"))
def friction_sign(view: View) -> np.ndarray:
    return -friction(view)


@rule("friction_as_damping", "the file's friction is used as a viscous coefficient", "<dynamics friction> is dry friction: f sign(v)", FORCED, "force", when=_has("friction"))
def friction_as_damping(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.friction) * view.states["v"]


@rule("damping_as_friction", "the file's damping is used as dry friction", "<dynamics damping> is viscous: D v", FORCED, "force", when=_has("damping"))
def damping_as_friction(view: View) -> np.ndarray:
    return view.case.per_velocity(lambda p: p.damping) * np.sign(view.states["v"])


def _allowed(view: View, term: str, x: np.ndarray, observed: np.ndarray, f: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """The prediction, and what of the rest is an allowed force; accelerations are turned into forces first."""
    r = observed - x
    if term != "aba":
        return x + f(r)
    M = view.layout.answer("matrix", view.compute("crba"), view.states)
    return x + np.linalg.solve(M, f(product(M, r))[..., None])[..., 0]


@rule("mimic_force", "a force along the <mimic> constraint (a soft equality)", "switch equality constraints off", ("rnea", "aba"), "answer", cost=1.3,
      when=lambda case: not case.floating and not case.robot.coupled and bool(case.description.mimics))  # fmt: skip
def mimic_force(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    names, rows = view.case.how.v, []
    for name, (leader, k, _) in view.case.description.mimics.items():
        row = np.zeros(len(names))
        row[names.index(name)] += 1
        row[names.index(leader)] -= k
        rows.append(row)
    P = np.linalg.pinv(np.array(rows)) @ np.array(rows)
    return _allowed(view, term, x, observed, lambda r: r @ P.T)


SATURATED = 0.3
"""A friction "within its bound" explains anything unless it stands at its bound in this share of the entries."""


@rule("friction_bound", "a friction force within the file's bound (not f sign(v))", "switch friction off", ("rnea", "aba"), "answer", cost=1.7, when=_has("friction"))
def friction_bound(view: View, term: str, x: np.ndarray, observed: np.ndarray) -> np.ndarray:
    f = view.case.per_velocity(lambda p: p.friction)[view.layout.to_v] * (1 + 1e-9)

    def within(r: np.ndarray) -> np.ndarray:
        at_bound = (np.abs(np.abs(r) - f) < 1e-6 * f)[:, f > 0]
        return np.clip(r, -f, f) if at_bound.mean() > SATURATED else 0 * r

    return _allowed(view, term, x, observed, within)
