"""Spaces of values: vectors, or configurations of a robot that move along screws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ..model.robot import Robot
from ..scalars import Exact, Scalar
from .column import Column

_BERNOULLI = (1 / 2, 1 / 12, 0.0, -1 / 720)  # B_n / n! for n = 1 ... 4, the sign of B_1 that of u -> -u


class Space:
    """Coordinates that add."""

    additive = True

    def move(self, y: Any, u: Any) -> Any:
        """The value reached from y by the displacement u."""
        return y if u is None else y + u

    def straighten(self, u: Any, k: Any, order: int) -> Any:
        """The rate of u when y exp(u) moves with the rate k."""
        return k


class ConfigurationSpace(Space):
    """Configurations of a robot: axial joints add, planar, spherical and floating ones compose with an exponential.

        q exp(u):  a floating base moves along the screw of its twist;
        u' = dexp^-1(-u) k = k + [u, k] / 2 + [u, [u, k]] / 12 - [u, [u, [u, [u, k]]]] / 720 + ...

    The bracket of two twists is their dual cross product.  (Munthe-Kaas 1998; Iserles et al. 2000)
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.joints = sorted((j for j in robot if j.mimic is None), key=lambda j: j.q.start)
        self.additive = all(j.model.additive for j in self.joints)

    @cached_property
    def size(self) -> int:
        """How many coordinates a value has."""
        return self.robot.nq

    def move(self, y: Any, u: Any) -> Any:
        if u is None:
            return y
        return y + u if self.additive else _on_columns(self._move, y, u)

    def straighten(self, u: Any, k: Any, order: int) -> Any:
        return k if self.additive else _on_columns(lambda u, k: self._straighten(u, k, order), u, k)

    def _move(self, y: Sequence[Scalar], u: Sequence[Scalar]) -> Column:
        return Column(x for j in self.joints for x in j.model.integrate(y[j.q], u[j.v]))

    def _straighten(self, u: Column, k: Column, order: int) -> Column:
        total, nested = k, k
        for weight in _BERNOULLI[: max(order - 1, 0)]:
            nested = self.bracket(u, nested)
            total = total + nested * weight if weight else total
        return total

    def bracket(self, u: Sequence[Scalar], k: Sequence[Scalar]) -> Column:
        """[u, k] in the Lie algebra, joint by joint."""
        return Column(x for j in self.joints for x in j.model.bracket(u[j.v], k[j.v]))


class StateSpace(ConfigurationSpace):
    """Configurations and velocities, y = (q, v); the velocities add."""

    @cached_property
    def size(self) -> int:
        return self.robot.nq + self.robot.nv

    def _move(self, y: Sequence[Scalar], u: Sequence[Scalar]) -> Column:
        nq, nv = self.robot.nq, self.robot.nv
        return Column((*super()._move(y[:nq], u[:nv]), *(a + b for a, b in zip(y[nq:], u[nv:], strict=True))))

    def bracket(self, u: Sequence[Scalar], k: Sequence[Scalar]) -> Column:
        nv = self.robot.nv
        return Column((*super().bracket(u[:nv], k[:nv]), *(0.0,) * nv))


def _on_columns(f: Callable[..., Column], *values: Any) -> Any:
    """f on columns of scalars, or on arrays (..., n) through their columns."""
    if not any(isinstance(x, np.ndarray) for x in values):
        return f(*map(Column, values))
    arrays = np.broadcast_arrays(*(np.asarray(x)[..., :1] for x in values))
    batch = arrays[0].shape[:-1]
    columns = (Column(np.moveaxis(np.broadcast_to(x, (*batch, np.shape(x)[-1])), -1, 0)) for x in values)
    result = f(*columns)
    return np.stack([np.broadcast_to(float(x) if type(x) is Exact else x, batch) for x in result], axis=-1)
