"""The same robot over other scalars: all constants converted, rotations made orthonormal."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from copy import copy
from dataclasses import replace
from typing import Any

from ..dual import Dual, sqrt
from ..scalars import Exact, Scalar
from ..spatial.inertia import Inertia
from ..spatial.pose import Pose
from ..spatial.rotation import IDENTITY, Rotation
from ..spatial.vector import ZERO_VECTOR, Matrix3, Vector3, motor
from .joints import Axial
from .robot import Frame, Joint, Link, Robot, Rotor


def lifted(robot: Robot, scalar: Callable[[Any], Scalar]) -> Robot:
    """The robot with every constant x replaced by scalar(x); exact -1, 0, 1 stay what they are.

    Rotations and axes are made orthonormal with the new scalars (in double precision they are so only to
    1e-16), so that identities hold to the digits of the new type.

    Examples
    --------
    >>> import mpmath, dualpin as dp
    >>> robot = dp.load("panda").lift(mpmath.mpf)
    """

    def number(x: Scalar) -> Scalar:
        return x if type(x) is Exact else scalar(x)

    def vector(p: Vector3) -> Vector3:
        return Vector3(*map(number, p))

    def matrix(A: Matrix3) -> Matrix3:
        return type(A)(*map(vector, A.rows))

    turned: dict[tuple[Any, ...], Rotation] = {}  # most frames are turned like another: Newton's iteration once for all

    def rotation(R: Rotation) -> Rotation:
        key = tuple((type(x), x) for row in R.rows for x in row)
        if key not in turned:
            turned[key] = orthonormal(matrix(R))
        return turned[key]

    def pose(X: Pose) -> Pose:
        return Pose(rotation(X.rotation), vector(X.position))

    def inertia(body: Inertia) -> Inertia:
        return Inertia(number(body.mass), vector(body.moment), matrix(body.rotational))

    def rotor(motor: Rotor) -> Rotor:
        return Rotor(number(motor.inertia), number(motor.ratio), motor.body and inertia(motor.body))

    def joint_model(model: Any) -> Any:
        if not isinstance(model, Axial):
            return model
        other = copy(model)
        axis = vector(model.axis)
        other.axis = axis if _settled(axis) else axis / sqrt(axis.dot(axis))
        other.units = tuple(Dual(number(u.real), number(u.dual)) for u in model.units)
        other.offset = Dual(number(model.offset.real), number(model.offset.dual))
        other.screws = tuple(motor(other.axis, ZERO_VECTOR) * u for u in other.units)
        if model._leader is not None:  # convert the joint without its leader
            other._leader = joint_model(model._leader)
        return other

    new: dict[Joint | None, Joint | None] = {None: None}
    for j in robot:
        new[j] = replace(
            j,
            parent=new[j.parent],
            placement=pose(j.placement),
            inertia=inertia(j.inertia),
            model=joint_model(j.model),
            armature=tuple(map(number, j.armature)),
            rotor=j.rotor and rotor(j.rotor),
        )
    frames = tuple(Frame(f.name, f.role, new[f.joint], pose(f.placement), f.parent) for f in robot.frames)
    links = tuple(Link(k.name, inertia(k.inertia), new[k.joint], pose(k.placement)) for k in robot.links)
    joints = tuple(j for j in new.values() if j is not None)
    return replace(robot, joints=joints, frames=frames, links=links, gravity=vector(robot.gravity))


def orthonormal(R: Matrix3) -> Rotation:
    """The nearest rotation, by Newton's iteration R <- R (3 - R^T R) / 2: 16 digits become 32, 64, 128.

    Symbolic entries are not changed.
    """
    if not _settled(c for row in R.rows for c in row):
        for _ in range(3):
            R = R @ (IDENTITY * 3 - R.T @ R) / 2
    return Rotation(*R.rows)


def _settled(entries: Iterable[Scalar]) -> bool:
    """Whether it needs no correction: all entries are exact constants, or one is symbolic."""
    entries = list(entries)
    return all(type(x) is Exact for x in entries) or any(getattr(x, "free_symbols", ()) for x in entries)
