"""The quantities dualpin computes, each with its algorithm over scalars.

A term declares its input arrays, its options, the shape of its result, and the algorithm that computes it.  NumPy and
the compiled engine both execute terms; the public functions of `dualpin.functions` refer to them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from .algorithms import (
    aba,
    coriolis,
    crba,
    derivatives,
    jacobian,
    kinematics,
    link_terms,
    momentum,
    regressor,
    rnea,
    second_derivatives,
)
from .arguments import choice, flag
from .errors import ArgumentError, nearest
from .model.robot import Frame, Robot
from .scalars import Scalar
from .spatial.pose import Pose
from .spatial.quaternion import Quaternion
from .spatial.vector import Twist, Vector3, Wrench, motor

Options = dict[str, Hashable]
Shape = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Input:
    """An input array of a term.

    Attributes
    ----------
    shape : callable
        robot -> the shape of one sample.
    meaning : callable
        robot -> a description of the array, for messages.
    configuration : bool
        Whether its quaternions must have unit norm.
    """

    name: str
    shape: Callable[[Robot], Shape]
    meaning: Callable[[Robot], str]
    configuration: bool = False

    def size(self, robot: Robot) -> int:
        """How many numbers one sample has."""
        return math.prod(self.shape(robot))


def configuration(name: str) -> Input:
    """A configuration of the robot, (nq,)."""
    return Input(name, lambda r: (r.nq,), lambda r: f"nq = {r.nq}", configuration=True)


def velocity(name: str, times: int = 1) -> Input:
    """Velocities, accelerations or torques of the joints, (nv,), or several of them in a row."""
    return Input(name, lambda r: (times * r.nv,), lambda r: f"{f'{times} ' if times > 1 else ''}nv = {r.nv}")


def row(name: str, size: int = 1) -> Input:
    """An array of fixed size."""
    return Input(name, lambda r: (size,), lambda r: "for every robot")


@dataclass(frozen=True, eq=False)
class Option:
    """An argument of a term that is not an array.

    Attributes
    ----------
    settle : callable
        (robot, its name in messages, value as given) -> the value that the algorithm takes; raises for a wrong value.
    default : Hashable, optional
        The value if none is given; without a default, a value is required.
    """

    name: str
    settle: Callable[[Robot, str, Any], Hashable]
    default: Hashable = None


@dataclass(frozen=True, eq=False)
class Term:
    """One quantity.

    Attributes
    ----------
    arguments : tuple of Input
        The arrays it takes, in order.
    compute : callable
        (robot, *arrays as sequences of scalars, **options) -> nested sequences of scalars.
    shape : callable
        (robot, **options) -> the shape of one result.
    options : tuple of Option
        The arguments that are not arrays.
    """

    name: str
    arguments: tuple[Input, ...]
    compute: Callable[..., Any]
    shape: Callable[..., Shape]
    options: tuple[Option, ...] = ()

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The names of its arrays, in order."""
        return tuple(x.name for x in self.arguments)

    def sizes(self, robot: Robot) -> list[int]:
        """How many scalars each array has."""
        return [x.size(robot) for x in self.arguments]

    def settled(self, robot: Robot, given: Mapping[str, Any]) -> Options:
        """All options as `compute` takes them, in order; raises for a wrong option."""
        names = [option.name for option in self.options]
        for name in given:
            if name not in names:
                offered = nearest(name, names, "options") if names else "it takes none"
                raise ArgumentError(f"{self.name}: option {name!r} is not known; {offered}")
        found: Options = {}
        for option in self.options:
            value = given.get(option.name, option.default)
            if value is None:
                raise ArgumentError(f"{self.name}: {option.name}= is needed")
            found[option.name] = option.settle(robot, f"{self.name}: {option.name}", value)
        return found


def term(name: object) -> Term:
    """The term of that name; the error for an unknown name lists the nearest ones."""
    if not isinstance(name, str) or name not in TERMS:
        raise ArgumentError(f"term {name!r} is not known; {nearest(str(name), TERMS, 'terms')}")
    return TERMS[name]


def flat(nested: Any) -> Iterator[Scalar]:
    """The scalars of nested lists, in order."""
    if isinstance(nested, (list, tuple)):
        for part in nested:
            yield from flat(part)
    else:
        yield nested


# --- objects as numbers ------------------------------------------------------------------------


def twist_entries(m: Twist) -> list[Scalar]:
    """[w; v] of the motion w + eps v."""
    return [*m.real, *m.dual]


def wrench_entries(m: Wrench) -> list[Scalar]:
    """[n; f] of the wrench f + eps n."""
    return [*m.dual, *m.real]


def wrenches(entries: Sequence[Scalar]) -> list[Wrench]:
    """The wrenches f + eps n of a flat sequence of [n; f]."""
    return [motor(Vector3(*entries[i + 3 : i + 6]), Vector3(*entries[i : i + 3])) for i in range(0, len(entries), 6)]


def quaternion_entries(q: Quaternion) -> list[Scalar]:
    """[w x y z | w x y z] of a dual quaternion."""
    return [*q.real, *q.dual]


def columns(vectors: Iterable[list[Scalar]]) -> list[list[Scalar]]:
    """The matrix with these columns, as rows."""
    return [list(row) for row in zip(*vectors, strict=True)]


# --- the terms -----------------------------------------------------------------------------------


def _joint_wrenches(robot: Robot, q: Any, v: Any, a: Any, f_ext: Any = None) -> Any:
    return [wrench_entries(F) for F in rnea.joint_wrenches(robot, q, v, a, f_ext)]


def _fk(robot: Robot, q: Any) -> Any:
    world = kinematics.forward_kinematics(robot, q)
    return [world[b].rows for b in robot]


def _crba_triangle(robot: Robot, q: Any) -> Any:
    return [row[: k + 1] for k, row in enumerate(crba.crba(robot, q))]


def _integrate(robot: Robot, q: Any, v: Any) -> Any:
    return _per_joint(robot, lambda b: b.model.integrate(q[b.q], v[b.v]))


def _difference(robot: Robot, q0: Any, q1: Any) -> Any:
    return _per_joint(robot, lambda b: b.model.difference(q0[b.q], q1[b.q]))


def _per_joint(robot: Robot, f: Callable[..., list[Scalar]]) -> list[list[Scalar]]:
    return [f(b) for b in sorted((b for b in robot if b.mimic is None), key=lambda b: b.q.start)]


def _body_twists(robot: Robot, q: Any, v: Any) -> Any:
    V = kinematics.body_twists(robot, kinematics.joint_poses(robot, q), v)
    return [twist_entries(V[b]) for b in robot]


def _body_twists_jvp(robot: Robot, q: Any, v: Any, dq: Any) -> Any:
    X = kinematics.joint_poses(robot, q)
    change = kinematics.body_twists_change(robot, X, kinematics.body_twists(robot, X, v), v, dq)
    return [twist_entries(change[b]) for b in robot]


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
    return quaternion_entries(kinematics.frame_quaternion(robot, q, frame).positive)


def _link_terms(robot: Robot, q: Any, v: Any) -> Any:
    # one row of M, C, g a joint and link:  (njoints, nv, 2 nv + 1)
    return [[[*M[k], *C[k], g[k]] for k in range(robot.nv)] for M, C, g in link_terms.link_terms(robot, q, v)]


def _fk_quaternion(robot: Robot, q: Any) -> Any:
    world = kinematics.forward_kinematics(robot, q)
    return [quaternion_entries(world[b].quaternion) for b in robot]


def _vector(robot: Robot, **_: Any) -> Shape:
    return (robot.nv,)


def _square(robot: Robot, **_: Any) -> Shape:
    return (robot.nv, robot.nv)


def _twist(robot: Robot, **_: Any) -> Shape:
    return (6,)


def _twists(robot: Robot, **_: Any) -> Shape:
    return (6, robot.nv)


def pushed(term: Term) -> Term:
    """The same term with external wrenches: one more array, the algorithm's last argument."""

    def compute(robot: Robot, *arrays: Any) -> Any:
        return term.compute(robot, *arrays[:-1], wrenches(arrays[-1]))

    return Term(f"{term.name}_f_ext", (*term.arguments, F_EXT), compute, term.shape)


Q, V, A, TAU = configuration("q"), velocity("v"), velocity("a"), velocity("tau")
W, DIRECTION = velocity("w"), (velocity("dq"), velocity("dv"), velocity("da"))
F_EXT = Input("f_ext", lambda r: (len(r), 6), lambda r: f"a wrench [n; f] for each of {len(r)} joints")

FRAME = Option("frame", lambda robot, what, given: robot.frame(given))
REFERENCE = Option("reference", lambda robot, what, given: choice(what, given, kinematics.References), "world")
CLASSICAL = Option("classical", lambda robot, what, given: flag(what, given), default=False)

FK = Term("fk", (Q,), _fk, lambda r: (len(r), 4, 4))
FK_QUATERNION = Term("fk_quaternion", (Q,), _fk_quaternion, lambda r: (len(r), 8))
FRAME_POSE = Term("frame_pose", (Q,), _frame_pose, lambda r, **_: (4, 4), (FRAME,))
FRAME_QUATERNION = Term("frame_quaternion", (Q,), _frame_quaternion, lambda r, **_: (8,), (FRAME,))
JACOBIAN = Term("jacobian", (Q,), _jacobian, _twists, (FRAME, REFERENCE))
JACOBIAN_DOT = Term("jacobian_dot", (Q, V), _jacobian_dot, _twists, (FRAME, REFERENCE))
FRAME_VELOCITY = Term("frame_velocity", (Q, V), _frame_velocity, _twist, (FRAME, REFERENCE))
FRAME_ACCELERATION = Term("frame_acceleration", (Q, V, A), _frame_acceleration, _twist, (FRAME, REFERENCE, CLASSICAL))
RNEA = Term("rnea", (Q, V, A), rnea.rnea, _vector)
RNEA_F_EXT = pushed(RNEA)
JOINT_WRENCHES = Term("joint_wrenches", (Q, V, A), _joint_wrenches, lambda r: (len(r), 6))
JOINT_WRENCHES_F_EXT = pushed(JOINT_WRENCHES)
BIAS = Term("bias", (Q, V), rnea.bias, _vector)
GRAVITY = Term("gravity", (Q,), rnea.gravity, _vector)
CRBA = Term("crba", (Q,), crba.crba, _square)
CRBA_TRIANGLE = Term("crba_triangle", (Q,), _crba_triangle, lambda r: (r.nv * (r.nv + 1) // 2,))
CORIOLIS = Term("coriolis", (Q, V), coriolis.coriolis, _square)
ABA = Term("aba", (Q, V, TAU), aba.aba, _vector)
ABA_F_EXT = pushed(ABA)
MINV = Term("minv", (Q,), aba.minv, _square)
KINETIC_ENERGY = Term("kinetic_energy", (Q, V), momentum.kinetic_energy, lambda r: ())
POTENTIAL_ENERGY = Term("potential_energy", (Q,), momentum.potential_energy, lambda r: ())
COM = Term("com", (Q,), lambda r, q: list(momentum.center_of_mass(r, q)), lambda r: (3,))
COM_JACOBIAN = Term("com_jacobian", (Q,), _com_jacobian, lambda r: (3, r.nv))
CENTROIDAL_MOMENTUM_MATRIX = Term("centroidal_momentum_matrix", (Q,), _cmm, _twists)
JOINT_TORQUE_REGRESSOR = Term(
    "joint_torque_regressor", (Q, V, A), regressor.joint_torque_regressor,
    lambda r: (r.nv, len(regressor.inertial_parameters(r))),
)  # fmt: skip
LINK_TERMS = Term("link_terms", (Q, V), _link_terms, lambda r: (len(r), r.nv, 2 * r.nv + 1))
RNEA_DERIVATIVES = Term("rnea_derivatives", (Q, V, A), derivatives.rnea_derivatives, lambda r: (3, r.nv, r.nv))
ABA_DERIVATIVES = Term("aba_derivatives", (Q, V, TAU), derivatives.aba_derivatives, lambda r: (3, r.nv, r.nv))
RNEA_JVP = Term("rnea_jvp", (Q, V, A, *DIRECTION), derivatives.rnea_jvp, _vector)
RNEA_VJP = Term("rnea_vjp", (Q, V, A, W), derivatives.rnea_vjp, lambda r: (3, r.nv))
RNEA_HVP = Term("rnea_hvp", (Q, V, A, W, *DIRECTION), second_derivatives.rnea_hvp, lambda r: (3, r.nv))
RNEA_HESSIAN = Term("rnea_hessian", (Q, V, A, W), second_derivatives.rnea_hessian, lambda r: (4, r.nv, r.nv))
RNEA_SECOND_DERIVATIVES = Term(
    "rnea_second_derivatives", (Q, V, A), second_derivatives.rnea_second_derivatives, lambda r: (4, r.nv, r.nv, r.nv)
)
(
    RNEA_DERIVATIVES_F_EXT, ABA_DERIVATIVES_F_EXT, RNEA_JVP_F_EXT, RNEA_VJP_F_EXT, RNEA_HVP_F_EXT, RNEA_HESSIAN_F_EXT,
    RNEA_SECOND_DERIVATIVES_F_EXT,
) = map(
    pushed, (RNEA_DERIVATIVES, ABA_DERIVATIVES, RNEA_JVP, RNEA_VJP, RNEA_HVP, RNEA_HESSIAN, RNEA_SECOND_DERIVATIVES)
)  # fmt: skip
BODY_TWISTS = Term("body_twists", (Q, V), _body_twists, lambda r: (len(r), 6))
BODY_TWISTS_JVP = Term("body_twists_jvp", (Q, V, velocity("dq")), _body_twists_jvp, lambda r: (len(r), 6))
INTEGRATE = Term("integrate", (Q, V), _integrate, lambda r: (r.nq,))
DIFFERENCE = Term("difference", (configuration("q0"), configuration("q1")), _difference, _vector)

TERMS: dict[str, Term] = {x.name: x for x in list(globals().values()) if isinstance(x, Term)}
"""Every quantity by its name."""
