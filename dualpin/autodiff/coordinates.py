"""Conversion of gradients by joint displacements, as terms give them, to gradients by coordinates."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from ..model.robot import Joint, Robot
from ..scalars import Scalar
from ..scalars import _stumpff_closed as stumpff_closed
from ..scalars import _stumpff_series as stumpff_series
from ..spatial.quaternion import Quaternion
from ..spatial.vector import Vector3
from .operation import Library


def scalar_functions(module: Any) -> SimpleNamespace:
    """The elementary functions of the arrays of PyTorch or `jax.numpy` as scalars, for `dualpin.scalars.register`.

    Derivatives are finite on both sides of a choice, since the side that is not chosen gets a harmless argument.
    """

    def stumpff(k: int, y: Any) -> Any:
        small = y < 1.0
        near, far = module.where(small, y, 0.0), module.where(small, 1.0, y)
        return module.where(small, stumpff_series(k, near), stumpff_closed(k, far, found))

    found = SimpleNamespace(sin=module.sin, cos=module.cos, sqrt=module.sqrt, stumpff=stumpff)
    return found


def by_coordinates(robot: Robot, library: Library, q: Any, g: Any) -> Any:
    """The gradient (..., nq) by coordinates, from the gradient g (..., nv) by joint displacements.

    If coordinates add, they are equal.  Otherwise dq/dt = N(q) v, with N a rotation except for the factor
    1/2 of quaternions, and the gradient is the solution of N^T gradient = g without a component along the
    quaternion, since functions are defined only for unit quaternions.
    """
    if all(b.model.additive for b in robot):
        return g
    entries: list[Any] = [None] * robot.nq
    for b in (b for b in robot if b.mimic is None):
        part = [g[..., i] for i in range(b.v.start, b.v.stop)]
        found = part if b.model.additive else _lifted(b, library, [q[..., i] for i in range(b.q.start, b.q.stop)], part)
        entries[b.q] = found
    return library.stack(entries, -1)


def _lifted(b: Joint, library: Library, q: list[Scalar], g: list[Scalar]) -> list[Scalar]:
    """The same for one joint: a position and an orientation, or one of both, as its coordinates say."""
    if not b.model.quaternions:  # x, y, angle: the gradient by the position is in the body's axes
        c, s = library.cos(q[2]), library.sin(q[2])
        return [c * g[0] - s * g[1], s * g[0] + c * g[1], g[2]]
    (at,) = b.model.quaternions
    r = Quaternion(*q[at:])
    moving = r.rotation @ Vector3(*g[3:]) if at else ()
    return [*moving, *(r * Quaternion(0.0, *g[:3]) * 2)]  # dq/dt = q w / 2: N^T N = 1 / 4
