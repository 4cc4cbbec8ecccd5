"""The rules: each gradient, expressed by other terms.

A rule takes the inputs, the output and the cotangent of a term, whose leading axes are equal, and gives
the gradients of the inputs.  Wrenches on the bodies enter inverse dynamics linearly, tau = ... - J^T f,
so that J^T f is inverse dynamics of a robot at rest without gravity, and J w the bodies' twists.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import DualpinError
from ..model.memory import memory
from ..model.robot import Robot
from .coordinates import by_coordinates
from .operation import Library, Operation


@dataclass(frozen=True)
class Use:
    """The arguments of a rule: the operation, the library, and which gradients are needed."""

    operation: Operation
    library: Library
    needed: tuple[bool, ...]

    @property
    def robot(self) -> Robot:
        return self.operation.robot

    @property
    def weightless(self) -> Robot:
        """The same robot without gravity, for terms that are linear in forces or accelerations."""
        kept = memory(self.robot)
        return kept.get("weightless") or kept.setdefault("weightless", self.robot.with_gravity((0.0, 0.0, 0.0)))

    def still(self, q: Any) -> Any:
        """Zero velocities, or accelerations, for these configurations."""
        zeros = self.library.constant(np.zeros(self.robot.nv), q)
        return self.library.broadcast(zeros, (*q.shape[:-1], self.robot.nv))

    def __call__(self, robot: Robot, name: str, *arrays: Any, **options: Any) -> Any:
        """Another term of these arrays."""
        return self.library.apply(Operation.of(robot, name, **options), *arrays)


Rule = Callable[[Use, list[Any], Any, Any], list[Any]]


def _named(name: str, f: Sequence[Any]) -> str:
    return f"{name}_f_ext" if f else name


def _by_q(use: Use, q: Any, g: Any) -> Any:
    return by_coordinates(use.robot, use.library, q, g)


def _parts(x: Any) -> list[Any]:
    """Those along the axis before the last."""
    return [x[..., i, :] for i in range(x.shape[-2])]


def rnea(use: Use, inputs: list[Any], tau: Any, w: Any) -> list[Any]:
    """Gradients of w . tau."""
    q, v, a, *f = inputs
    by_q, by_v, by_a = None, None, None
    if any(use.needed[:3]):
        by_q, by_v, by_a = _parts(use(use.robot, _named("rnea_vjp", f), q, v, a, w, *f))
        by_q = _by_q(use, q, by_q)
    pushed = [-use(use.robot, "body_twists", q, w) if use.needed[3] else None for _ in f]
    return [by_q, by_v, by_a, *pushed]


def rnea_vjp(use: Use, inputs: list[Any], output: Any, c: Any) -> list[Any]:
    """The gradient along a direction c is w . d tau along c: its Hessian times c, and d tau by w."""
    q, v, a, w, *f = inputs
    direction = _parts(c)
    by_q, by_v, by_a = None, None, None
    if any(use.needed[:3]):
        by_q, by_v, by_a = _parts(use(use.robot, _named("rnea_hvp", f), q, v, a, w, *direction, *f))
        by_q = _by_q(use, q, by_q)
    by_w = use(use.robot, _named("rnea_jvp", f), q, v, a, *direction, *f) if use.needed[3] else None
    return [by_q, by_v, by_a, by_w, *(_by_forces(use, 4, q, w, direction[0]) for _ in f)]


def rnea_jvp(use: Use, inputs: list[Any], output: Any, w: Any) -> list[Any]:
    """Linear in the direction, with the gradient of w . tau for coefficients."""
    q, v, a, dq, dv, da, *f = inputs
    by_q, by_v, by_a = None, None, None
    if any(use.needed[:3]):
        by_q, by_v, by_a = _parts(use(use.robot, _named("rnea_hvp", f), q, v, a, w, dq, dv, da, *f))
        by_q = _by_q(use, q, by_q)
    along = _parts(use(use.robot, _named("rnea_vjp", f), q, v, a, w, *f))
    return [by_q, by_v, by_a, *along, *(_by_forces(use, 6, q, w, dq) for _ in f)]


def rnea_hvp(use: Use, inputs: list[Any], output: Any, c: Any) -> list[Any]:
    """Linear in w, with what unit torques give for coefficients, and in the direction, symmetric but for brackets.

    H_jk - H_kj = g . [e_k, e_j] where displacements do not commute, with the gradient g of w . tau.
    """
    if any(use.needed[:3]) or any(use.needed[7:]):
        raise _without(use.operation)
    q, v, a, w, *direction = inputs[:7]
    f, by_w, along = inputs[7:], None, [None, None, None]
    if use.needed[3]:
        many, unit = _each_joint(use, q)
        wide = [use.library.broadcast(x[..., None, :], unit.shape) for x in (v, a, *direction)]
        wide += [use.library.broadcast(x[..., None, :, :], (*unit.shape[:-1], *x.shape[-2:])) for x in f]
        each = use(use.robot, _named("rnea_hvp", f), many, *wide[:2], unit, *wide[2:])
        by_w = (each * c[..., None, :, :]).sum(-1).sum(-1)
    if any(use.needed[4:]):
        along = _parts(use(use.robot, _named("rnea_hvp", f), q, v, a, w, *_parts(c), *f))
        if not all(b.model.additive for b in use.robot):
            g, brackets = _parts(use(use.robot, _named("rnea_vjp", f), q, v, a, w, *f))[0], _brackets(use.robot)
            turned = (use.library.constant(brackets, q) * c[..., 0, None, None, :]).sum(-1)
            along[0] = along[0] + (turned * g[..., :, None]).sum(-2)
    return [None, None, None, by_w, *along, *(None for _ in f)]


def _by_forces(use: Use, at: int, q: Any, w: Any, dq: Any) -> Any:
    """-w . J^T f changes with the twists J w while the joints are displaced by dq."""
    return -use(use.robot, "body_twists_jvp", q, w, dq) if use.needed[at] else None


def bias(use: Use, inputs: list[Any], output: Any, w: Any) -> list[Any]:
    """Inverse dynamics without acceleration."""
    q, v = inputs
    by_q, by_v, _ = _parts(use(use.robot, "rnea_vjp", q, v, 0 * v, w))
    return [_by_q(use, q, by_q), by_v]


def gravity(use: Use, inputs: list[Any], output: Any, w: Any) -> list[Any]:
    """Inverse dynamics at rest."""
    (q,) = inputs
    by_q, _, _ = _parts(use(use.robot, "rnea_vjp", q, use.still(q), use.still(q), w))
    return [_by_q(use, q, by_q)]


def aba(use: Use, inputs: list[Any], a: Any, w: Any) -> list[Any]:
    """With mu = M^-1 w, the gradient of w . a is mu by tau, and that of -mu . rnea(q, v, a) by the state."""
    q, v, _, *f = inputs
    mu, by_q, by_v = use(use.weightless, "aba", q, use.still(q), w), None, None
    if any(use.needed[:2]):
        by_q, by_v, _ = _parts(use(use.robot, _named("rnea_vjp", f), q, v, a, -mu, *f))
        by_q = _by_q(use, q, by_q)
    pushed = [use(use.robot, "body_twists", q, mu) if use.needed[3] else None for _ in f]
    return [by_q, by_v, mu, *pushed]


def crba(use: Use, inputs: list[Any], M: Any, G: Any) -> list[Any]:
    """Column j of M is the torque of the unit acceleration e_j, at rest and without gravity."""
    (q,) = inputs
    many, unit = _each_joint(use, q)
    by_q, _, _ = _parts(use(use.weightless, "rnea_vjp", many, 0 * unit, unit, G.swapaxes(-1, -2)))
    return [_by_q(use, q, by_q.sum(-2))]


def _each_joint(use: Use, q: Any) -> tuple[Any, Any]:
    """The configuration (..., nv, nq) as often as there are velocities, and unit velocities (..., nv, nv)."""
    n, library = use.robot.nv, use.library
    many = library.broadcast(q[..., None, :], (*q.shape[:-1], n, use.robot.nq))
    return many, library.broadcast(library.constant(np.eye(n), q), (*q.shape[:-1], n, n))


def coriolis(use: Use, inputs: list[Any], C: Any, G: Any) -> list[Any]:
    """C e_k = [h(v + e_k, b_k) - h(v - e_k, -b_k)] / 4, of inverse dynamics h(v, a) without gravity.

    The connection has no torsion, so that C(v) e - C(e) v = M b with the bracket b = [v, e], which is zero where
    velocities are derivatives of coordinates; and C(v) v is a square, h(v, 0).  This M has no armature.
    """
    q, v = inputs
    many, unit = _each_joint(use, q)
    brackets = use.library.constant(_brackets(use.robot), q)  # [e_i, e_k] is row (k, i)
    b, w = (brackets * v[..., None, None, :]).sum(-1).swapaxes(-1, -2), G.swapaxes(-1, -2) / 4
    after = _parts(use(use.weightless, "rnea_vjp", many, v[..., None, :] + unit, b, w))
    before = _parts(use(use.weightless, "rnea_vjp", many, v[..., None, :] - unit, -b, -w))
    by_q, by_v = (x + y for x, y in zip(after[:2], before[:2], strict=True))
    by_b = (after[2] - before[2] - 2 * use.library.constant(_armature(use.robot), q) * w)[..., None, :, :]
    by_v = by_v.sum(-2) + (brackets.swapaxes(-1, -3) * by_b).sum(-1).sum(-1)
    return [_by_q(use, q, by_q.sum(-2)), by_v]


def _brackets(robot: Robot) -> np.ndarray:
    """The brackets [e_i, e_k] of unit velocities, at [entry, k, i]."""
    found = np.zeros((robot.nv,) * 3)
    for b in (b for b in robot if not b.model.additive):
        unit = np.eye(b.model.nv)
        for (i, s), (k, r) in itertools.product(enumerate(unit.tolist()), repeat=2):
            found[b.v, b.v.start + k, b.v.start + i] = [float(x) for x in b.model.bracket(s, r)]
    return found


def _armature(robot: Robot) -> np.ndarray:
    found = np.zeros(robot.nv)
    for b in (b for b in robot if not b.model.additive):
        found[b.v] = [float(x) for x in b.armature]
    return found


def minv(use: Use, inputs: list[Any], inverse: Any, G: Any) -> list[Any]:
    """d M^-1 = -M^-1 dM M^-1, of symmetric matrices."""
    return crba(use, inputs, None, -(inverse @ G @ inverse))


def kinetic_energy(use: Use, inputs: list[Any], energy: Any, g: Any) -> list[Any]:
    """v . M v / 2"""
    q, v = inputs
    by_q, _, momentum = _parts(use(use.weightless, "rnea_vjp", q, 0 * v, v, v))
    g = g[..., None]
    return [_by_q(use, q, by_q * g / 2), momentum * g]


def potential_energy(use: Use, inputs: list[Any], energy: Any, g: Any) -> list[Any]:
    """Its gradient is `gravity`."""
    (q,) = inputs
    return [_by_q(use, q, use(use.robot, "gravity", q) * g[..., None])]


def com(use: Use, inputs: list[Any], at: Any, g: Any) -> list[Any]:
    """By the Jacobian of the centre of mass."""
    (q,) = inputs
    return [_by_q(use, q, (use(use.robot, "com_jacobian", q) * g[..., None]).sum(-2))]


def com_jacobian(use: Use, inputs: list[Any], J: Any, G: Any) -> list[Any]:
    """Row i is what holds the robot, a kilogram of it, where gravity pulls with 1 m/s^2 against axis i."""
    (q,) = inputs
    kept = memory(use.robot)
    pulled = kept.get("pulled") or kept.setdefault("pulled", [use.robot.with_gravity(x) for x in (-np.eye(3)).tolist()])
    still = use.still(q)
    rows = [_parts(use(robot, "rnea_vjp", q, still, still, G[..., i, :]))[0] for i, robot in enumerate(pulled)]
    return [_by_q(use, q, sum(rows) / use.robot.mass)]


def body_twists(use: Use, inputs: list[Any], U: Any, c: Any) -> list[Any]:
    """With c as wrenches on the bodies, c . J w: by w it is J^T c, and by q the gradient of w . J^T c."""
    q, w = inputs
    return [_by_q(use, q, _turning(use, q, w, c)) if use.needed[0] else None, _felt(use, q, c)]


def _turning(use: Use, q: Any, w: Any, c: Any) -> Any:
    """The derivative of c . J w by the joints' displacements."""
    return _parts(use(use.weightless, "rnea_vjp_f_ext", q, use.still(q), use.still(q), w, -c))[0]


def body_twists_jvp(use: Use, inputs: list[Any], output: Any, c: Any) -> list[Any]:
    """Linear in w, with the derivative of J^T c along dq for coefficients, and in dq."""
    if use.needed[0]:
        raise _without(use.operation)
    q, w, dq = inputs
    still = use.still(q)
    by_w = use(use.weightless, "rnea_jvp_f_ext", q, still, still, dq, still, still, -c) if use.needed[1] else None
    return [None, by_w, _turning(use, q, w, c) if use.needed[2] else None]


def fk(use: Use, inputs: list[Any], T: Any, G: Any) -> list[Any]:
    """G on the poses is a wrench on each body."""
    (q,) = inputs
    return [_by_q(use, q, _felt(use, q, _wrench(use, T, G)))]


def frame_pose(use: Use, inputs: list[Any], T: Any, G: Any) -> list[Any]:
    """G on the pose is a wrench on the frame, and so on the body that carries it."""
    (q,) = inputs
    frame: Any = use.operation.settled["frame"]
    if frame.joint is None:  # fixed to the ground
        return [0 * q]
    return [_by_q(use, q, _felt(use, q, _carried(use, frame, _wrench(use, T, G))))]


def jacobian(use: Use, inputs: list[Any], J: Any, G: Any) -> list[Any]:
    """Column k of the local Jacobian is the frame's twist for the unit velocity e_k; other viewpoints turn and move it.

    A turn and a shift xi of the viewpoint change a column X j by X (xi x j), where X does not depend on the shift
    for "local_world_aligned": with the wrench W = X^T G_k that is a wrench of j x* W on the frame.
    """
    (q,), settled = inputs, use.operation.settled
    frame: Any = settled["frame"]
    reference = settled["reference"]
    if frame.joint is None:
        return [0 * q]
    n, f = ([G[..., i + at, :] for i in range(3)] for at in (0, 3))
    moved: Any = 0.0
    if reference != "local":
        T = use(use.robot, "frame_pose", q, frame=frame)
        R, p = ([[T[..., i, j, None] for i in range(3)] for j in range(3)], [T[..., i, 3, None] for i in range(3)])
        if reference == "world":
            n = [x - y for x, y in zip(n, _cross(p, f), strict=True)]
        n, f = ([sum(x * y for x, y in zip(column, z, strict=True)) for column in R] for z in (n, f))
        local = use(use.robot, "jacobian", q, frame=frame, reference="local")
        w, v = ([local[..., i + at, :] for i in range(3)] for at in (0, 3))
        about = [(x + y).sum(-1) for x, y in zip(_cross(w, n), _cross(v, f), strict=True)]
        along = [(x if reference == "world" else 0 * x).sum(-1) for x in _cross(w, f)]
        moved = _felt(use, q, _carried(use, frame, use.library.stack([*about, *along], -1)))
    many, unit = _each_joint(use, q)
    wrenches = _carried(use, frame, use.library.stack([*n, *f], -1))
    by_q, _, _ = _parts(use(use.weightless, "rnea_vjp_f_ext", many, 0 * unit, 0 * unit, unit, -wrenches))
    return [_by_q(use, q, by_q.sum(-2) + moved)]


def _cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def _carried(use: Use, frame: Any, W: Any) -> Any:
    """A wrench [n; f] on a frame, in its axes and about its origin, as wrenches on all bodies (..., njoints, 6)."""
    library = use.library
    p, R = (np.array([[float(x) for x in row] for row in m]) for m in _placement(frame))
    n, f = ((library.constant(R, W) * x[..., None, :]).sum(-1) for x in (W[..., :3], W[..., 3:]))
    n = n + library.stack(_cross(p[0], [f[..., i] for i in range(3)]), -1)
    carried = library.concatenate([n, f], -1)
    at = frame.joint.index
    return library.stack([carried if i == at else 0 * carried for i in range(len(use.robot))], -2)


def _placement(frame: Any) -> tuple[Any, Any]:
    return [list(frame.placement.position)], frame.placement.rotation.rows


def _wrench(use: Use, T: Any, G: Any) -> Any:
    """[n; f] with the power of G on dT = T [twist], in the frame's own axes and about its origin."""
    R = [[T[..., i, j] for j in range(3)] for i in range(3)]

    def turned(column: int) -> list[Any]:
        return [sum(R[i][k] * G[..., i, column] for i in range(3)) for k in range(3)]

    A = [turned(j) for j in range(3)]  # columns of R^T G
    n = [A[1][2] - A[2][1], A[2][0] - A[0][2], A[0][1] - A[1][0]]
    return use.library.stack([*n, *turned(3)], -1)


def _felt(use: Use, q: Any, wrenches: Any) -> Any:
    """J^T wrenches, the joint torques of wrenches on the bodies."""
    return use(use.weightless, "rnea_f_ext", q, use.still(q), use.still(q), -wrenches)


RULES: dict[str, Rule] = {
    "rnea": rnea, "rnea_f_ext": rnea, "rnea_vjp": rnea_vjp, "rnea_vjp_f_ext": rnea_vjp, "rnea_jvp": rnea_jvp,
    "rnea_jvp_f_ext": rnea_jvp, "bias": bias, "gravity": gravity, "aba": aba, "aba_f_ext": aba, "crba": crba,
    "minv": minv, "kinetic_energy": kinetic_energy, "potential_energy": potential_energy, "com": com,
    "com_jacobian": com_jacobian, "coriolis": coriolis, "body_twists": body_twists, "fk": fk,
    "frame_pose": frame_pose, "jacobian": jacobian,
}  # fmt: skip
"""The rule of each differentiable term."""
DIFFERENTIABLE = frozenset(RULES)
RULES |= {"rnea_hvp": rnea_hvp, "rnea_hvp_f_ext": rnea_hvp, "body_twists_jvp": body_twists_jvp}  # what is linear


def _without(operation: Operation) -> DualpinError:
    return DualpinError(
        f"{operation.term.name} has no derivative here; terms that have one: {', '.join(sorted(DIFFERENTIABLE))}. "
        "Inverse dynamics can be differentiated twice"
    )


def gradients(
    operation: Operation, library: Library, inputs: Sequence[Any], output: Any, cotangent: Any, needed: Sequence[bool]
) -> list[Any]:
    """The gradient of each input by the term's rule; None if it is not needed."""
    rule = RULES.get(operation.term.name)
    if rule is None:
        raise _without(operation)
    return rule(Use(operation, library, tuple(needed)), list(inputs), output, cotangent)
