"""The quantities dualpin computes, each tied to its one source over scalars.

A term says which arrays go in, what shape comes out, and which algorithm computes it.  The NumPy
execution and the compiled engine both run a term; the public functions of `dualpin.api` name one.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from .algorithms import aba, coriolis, crba, derivatives, jacobian, kinematics, link_terms, momentum, regressor, rnea
from .model.robot import Frame, Robot
from .scalars import Scalar
from .spatial.pose import Pose
from .spatial.quaternion import Quaternion
from .spatial.vector import Vector3, motor

Options = dict[str, Hashable]


@dataclass(frozen=True)
class Term:
    """One quantity.

    Attributes
    ----------
    inputs : tuple of str
        Among "q" (nq), "v", "a", "tau" (nv each), "f_ext" (njoints, 6).
    compute : callable
        (robot, *inputs as sequences of scalars, **options) -> nested sequences of scalars.
    shape : callable
        (robot, **options) -> the shape of one result.
    """

    name: str
    inputs: tuple[str, ...]
    compute: Callable[..., Any]
    shape: Callable[..., tuple[int, ...]]

    def sizes(self, robot: Robot) -> list[int]:
        """How many scalars each input has."""
        return [input_size(robot, name) for name in self.inputs]


# inputs whose size is the same for every robot: [R p] row by row, a twist, single numbers
_SIZES = {"pose": 12, "twist": 6, "gain": 1, "damping": 1, "h": 1}


def input_shape(robot: Robot, name: str) -> tuple[int, ...]:
    """The shape of one sample of an input; "name*3" is three of them in a row."""
    base, _, times = name.partition("*")
    if times:
        return (int(times) * input_size(robot, base),)
    if base in _SIZES:
        return (_SIZES[base],)
    if name == "f_ext":
        return (len(robot), 6)
    return (robot.nq,) if name.startswith("q") else (robot.nv,)


def input_size(robot: Robot, name: str) -> int:
    shape = input_shape(robot, name)
    return shape[0] * (shape[1] if len(shape) > 1 else 1)


def flat(nested: Any) -> Iterator[Scalar]:
    """The scalars of nested lists, in order."""
    if isinstance(nested, (list, tuple)):
        for part in nested:
            yield from flat(part)
    else:
        yield nested


# --- how objects become numbers ------------------------------------------------------------------


def twist_entries(m: Vector3) -> list[Scalar]:
    """[w; v] of the motion w + eps v."""
    return [*m.real, *m.dual]


def wrench_entries(m: Vector3) -> list[Scalar]:
    """[n; f] of the wrench f + eps n."""
    return [*m.dual, *m.real]


def wrenches(entries: Sequence[Scalar]) -> list[Vector3]:
    """The wrenches f + eps n of a flat sequence of [n; f]."""
    return [motor(Vector3(*entries[i + 3 : i + 6]), Vector3(*entries[i : i + 3])) for i in range(0, len(entries), 6)]


def quaternion_entries(q: Quaternion) -> list[Scalar]:
    """[w x y z | w x y z] of a dual quaternion."""
    return [*q.real, *q.dual]


def columns(vectors: Iterable[list[Scalar]]) -> list[list[Scalar]]:
    """The matrix with these columns, as rows."""
    return [list(row) for row in zip(*vectors, strict=True)]


# --- the terms -----------------------------------------------------------------------------------


def _rnea(robot: Robot, q: Any, v: Any, a: Any, f_ext: Any = None) -> Any:
    return rnea.rnea(robot, q, v, a, None if f_ext is None else wrenches(f_ext))


def _aba(robot: Robot, q: Any, v: Any, tau: Any, f_ext: Any = None) -> Any:
    return aba.aba(robot, q, v, tau, None if f_ext is None else wrenches(f_ext))


def _fk(robot: Robot, q: Any) -> Any:
    world = kinematics.forward_kinematics(robot, q)
    return [world[b].rows for b in robot]


def _integrate(robot: Robot, q: Any, v: Any) -> Any:
    return _per_joint(robot, lambda b: b.model.integrate(q[b.q], v[b.v]))


def _difference(robot: Robot, q0: Any, q1: Any) -> Any:
    return _per_joint(robot, lambda b: b.model.difference(q0[b.q], q1[b.q]))


def _per_joint(robot: Robot, f: Callable[..., list[Scalar]]) -> list[list[Scalar]]:
    return [f(b) for b in sorted((b for b in robot if b.mimic is None), key=lambda b: b.q.start)]


def _cmm(robot: Robot, q: Any) -> Any:
    return columns(map(wrench_entries, momentum.centroidal_momentum_matrix(robot, q)))


def _com_jacobian(robot: Robot, q: Any) -> Any:
    return columns(list(c) for c in momentum.com_jacobian(robot, q))


def _jacobian(robot: Robot, q: Any, frame: Frame, reference: str) -> Any:
    return columns(map(twist_entries, jacobian.jacobian(robot, q, frame, reference)))


def _jacobian_dot(robot: Robot, q: Any, v: Any, frame: Frame, reference: str) -> Any:
    return columns(map(twist_entries, jacobian.jacobian_dot(robot, q, v, frame, reference)))


def _frame_velocity(robot: Robot, q: Any, v: Any, frame: Frame, reference: str) -> Any:
    return twist_entries(kinematics.frame_velocity(robot, q, v, frame, reference))


def _frame_acceleration(robot: Robot, q: Any, v: Any, a: Any, frame: Frame, reference: str, classical: bool) -> Any:
    return twist_entries(kinematics.frame_acceleration(robot, q, v, a, frame, reference, classical))


def _frame_pose(robot: Robot, q: Any, frame: Frame) -> Any:
    pose: Pose = kinematics.frame_pose(robot, q, frame)
    return pose.rows


def _frame_quaternion(robot: Robot, q: Any, frame: Frame) -> Any:
    return quaternion_entries(kinematics.frame_quaternion(robot, q, frame))


def _link_terms(robot: Robot, q: Any, v: Any) -> Any:
    # one row of M, C, g a joint and link:  (njoints, nv, 2 nv + 1)
    return [[[*M[k], *C[k], g[k]] for k in range(robot.nv)] for M, C, g in link_terms.link_terms(robot, q, v)]


def _vector(robot: Robot, **_: Any) -> tuple[int, ...]:
    return (robot.nv,)


def _square(robot: Robot, **_: Any) -> tuple[int, ...]:
    return (robot.nv, robot.nv)


TERMS: dict[str, Term] = {
    t.name: t
    for t in (
        Term("fk", ("q",), _fk, lambda r: (len(r), 4, 4)),
        Term("frame_pose", ("q",), _frame_pose, lambda r, **_: (4, 4)),
        Term("frame_quaternion", ("q",), _frame_quaternion, lambda r, **_: (8,)),
        Term("jacobian", ("q",), _jacobian, lambda r, **_: (6, r.nv)),
        Term("jacobian_dot", ("q", "v"), _jacobian_dot, lambda r, **_: (6, r.nv)),
        Term("frame_velocity", ("q", "v"), _frame_velocity, lambda r, **_: (6,)),
        Term("frame_acceleration", ("q", "v", "a"), _frame_acceleration, lambda r, **_: (6,)),
        Term("rnea", ("q", "v", "a"), _rnea, _vector),
        Term("rnea_f_ext", ("q", "v", "a", "f_ext"), _rnea, _vector),
        Term("bias", ("q", "v"), rnea.bias, _vector),
        Term("gravity", ("q",), rnea.gravity, _vector),
        Term("crba", ("q",), crba.crba, _square),
        Term("coriolis", ("q", "v"), coriolis.coriolis, _square),
        Term("aba", ("q", "v", "tau"), _aba, _vector),
        Term("aba_f_ext", ("q", "v", "tau", "f_ext"), _aba, _vector),
        Term("minv", ("q",), aba.minv, _square),
        Term("kinetic_energy", ("q", "v"), momentum.kinetic_energy, lambda r: ()),
        Term("potential_energy", ("q",), momentum.potential_energy, lambda r: ()),
        Term("com", ("q",), lambda r, q: list(momentum.center_of_mass(r, q)), lambda r: (3,)),
        Term("com_jacobian", ("q",), _com_jacobian, lambda r: (3, r.nv)),
        Term("centroidal_momentum_matrix", ("q",), _cmm, lambda r: (6, r.nv)),
        Term("joint_torque_regressor", ("q", "v", "a"), regressor.joint_torque_regressor,
             lambda r: (r.nv, len(regressor.inertial_parameters(r)))),
        Term("link_terms", ("q", "v"), _link_terms, lambda r: (len(r), r.nv, 2 * r.nv + 1)),
        Term("rnea_derivatives", ("q", "v", "a"), derivatives.rnea_derivatives, lambda r: (3, r.nv, r.nv)),
        Term("aba_derivatives", ("q", "v", "tau"), derivatives.aba_derivatives, lambda r: (3, r.nv, r.nv)),
        Term("integrate", ("q", "v"), _integrate, lambda r: (r.nq,)),
        Term("difference", ("q0", "q1"), _difference, _vector),
    )
}  # fmt: skip
