"""The rules: each gradient, expressed by other terms.

A rule takes the inputs, the output and the cotangent of a term, whose leading axes are equal, and gives
the gradients of the inputs.  Wrenches on the bodies enter inverse dynamics linearly, tau = ... - J^T f,
so that J^T f is inverse dynamics of a robot at rest without gravity, and J w the bodies' twists.
"""

from __future__ import annotations

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
    by_q, by_v, by_a = _parts(use(use.robot, _named("rnea_vjp", f), q, v, a, w, *f))
    pushed = [-use(use.robot, "body_twists", q, w) if use.needed[3] else None for _ in f]
    return [_by_q(use, q, by_q), by_v, by_a, *pushed]


def rnea_vjp(use: Use, inputs: list[Any], output: Any, c: Any) -> list[Any]:
    """The gradient along a direction c is w . d tau along c: its Hessian times c, and d tau by w."""
    q, v, a, w, *f = inputs
    direction = _parts(c)
    by_q, by_v, by_a = _parts(use(use.robot, _named("rnea_hvp", f), q, v, a, w, *direction, *f))
    by_w = use(use.robot, _named("rnea_jvp", f), q, v, a, *direction, *f)
    return [_by_q(use, q, by_q), by_v, by_a, by_w, *(_by_forces(use, 4, q, w, direction[0]) for _ in f)]


def rnea_jvp(use: Use, inputs: list[Any], output: Any, w: Any) -> list[Any]:
    """Linear in the direction, with the gradient of w . tau for coefficients."""
    q, v, a, dq, dv, da, *f = inputs
    by_q, by_v, by_a = _parts(use(use.robot, _named("rnea_hvp", f), q, v, a, w, dq, dv, da, *f))
    along = _parts(use(use.robot, _named("rnea_vjp", f), q, v, a, w, *f))
    return [_by_q(use, q, by_q), by_v, by_a, *along, *(_by_forces(use, 6, q, w, dq) for _ in f)]


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
    by_q, _, _ = _parts(use(use.robot, "rnea_vjp", q, 0 * w, 0 * w, w))
    return [_by_q(use, q, by_q)]


def aba(use: Use, inputs: list[Any], a: Any, w: Any) -> list[Any]:
    """With mu = M^-1 w, the gradient of w . a is mu by tau, and that of -mu . rnea(q, v, a) by the state."""
    q, v, _, *f = inputs
    mu = use(use.weightless, "aba", q, 0 * v, w)
    by_q, by_v, _ = _parts(use(use.robot, _named("rnea_vjp", f), q, v, a, mu, *f))
    pushed = [use(use.robot, "body_twists", q, mu) if use.needed[3] else None for _ in f]
    return [-_by_q(use, q, by_q), -by_v, mu, *pushed]


def crba(use: Use, inputs: list[Any], M: Any, G: Any) -> list[Any]:
    """Column j of M is the torque of the unit acceleration e_j, at rest and without gravity."""
    (q,) = inputs
    n, library = use.robot.nv, use.library
    unit = library.broadcast(library.constant(np.eye(n), G), tuple(G.shape))
    many = library.broadcast(q[..., None, :], (*G.shape[:-1], use.robot.nq))
    weights = library.stack([G[..., j] for j in range(n)], -2)
    by_q, _, _ = (x.sum(-2) for x in _parts(use(use.weightless, "rnea_vjp", many, 0 * unit, unit, weights)))
    return [_by_q(use, q, by_q)]


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


def body_twists(use: Use, inputs: list[Any], U: Any, c: Any) -> list[Any]:
    """With c as wrenches on the bodies, c . J w: by w it is J^T c, and by q the gradient of w . J^T c."""
    q, w = inputs
    rest, still = use.weightless, 0 * w
    by_q, _, _ = _parts(use(rest, "rnea_vjp_f_ext", q, still, still, w, -c))
    return [_by_q(use, q, by_q), use(rest, "rnea_f_ext", q, still, still, -c)]


def fk(use: Use, inputs: list[Any], T: Any, G: Any) -> list[Any]:
    """G on the poses is a wrench on each body."""
    (q,) = inputs
    return [_by_q(use, q, _felt(use, q, _wrench(use, T, G)))]


def frame_pose(use: Use, inputs: list[Any], T: Any, G: Any) -> list[Any]:
    """G on the pose is a wrench on the frame, and so on the body that carries it."""
    (q,), library = inputs, use.library
    frame: Any = use.operation.settled["frame"]
    W = _wrench(use, T, G)
    if frame.joint is None:  # fixed to the ground
        return [0 * q]
    p, R = (np.array([[float(x) for x in row] for row in m]) for m in _placement(frame))
    n, f = ((library.constant(R, W) * x[..., None, :]).sum(-1) for x in (W[..., :3], W[..., 3:]))
    n = n + library.stack([p[0, i - 2] * f[..., i - 1] - p[0, i - 1] * f[..., i - 2] for i in range(3)], -1)
    carried = library.concatenate([n, f], -1)
    at = frame.joint.index
    wrenches = library.stack([carried if i == at else 0 * carried for i in range(len(use.robot))], -2)
    return [_by_q(use, q, _felt(use, q, wrenches))]


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
    still = use.library.constant(np.zeros(use.robot.nv), wrenches)
    still = use.library.broadcast(still, (*q.shape[:-1], use.robot.nv))
    return use(use.weightless, "rnea_f_ext", q, still, still, -wrenches)


RULES: dict[str, Rule] = {
    "rnea": rnea, "rnea_f_ext": rnea, "rnea_vjp": rnea_vjp, "rnea_vjp_f_ext": rnea_vjp, "rnea_jvp": rnea_jvp,
    "rnea_jvp_f_ext": rnea_jvp, "bias": bias, "gravity": gravity, "aba": aba, "aba_f_ext": aba, "crba": crba,
    "kinetic_energy": kinetic_energy, "potential_energy": potential_energy, "com": com, "body_twists": body_twists,
    "fk": fk, "frame_pose": frame_pose,
}  # fmt: skip
"""The rule of each differentiable term."""


def gradients(
    operation: Operation, library: Library, inputs: Sequence[Any], output: Any, cotangent: Any, needed: Sequence[bool]
) -> list[Any]:
    """The gradient of each input by the term's rule; None if it is not needed."""
    rule = RULES.get(operation.term.name)
    if rule is None:
        raise DualpinError(
            f"{operation.term.name} has no derivative here; terms that have one: {', '.join(sorted(RULES))}. "
            "Inverse dynamics can be differentiated twice"
        )
    return rule(Use(operation, library, tuple(needed)), list(inputs), output, cotangent)
