"""Definitions of the terms in any number of digits, which decide where two libraries differ.

Nothing here is an algorithm of `dualpin.algorithms` or of the oracle.  There are only the poses of the
bodies, as products of matrices, and the terms' meanings: momentum is inertia times velocity, force is
the rate of momentum, and derivatives are differences over a step of 1e-30, taken with 130 digits.  So
the definitions share no recursion, and no mistake of one, with either library.  They are slow, and
evaluated for one entry of one sample at a time.  The definitions of the terms are in `checks`.

A body moves along the curve  T(t) = T_parent P X(q) exp(S (v t + a t^2 / 2)),  whose velocity in the
joint's own coordinates is v + a t: this holds for every joint, whatever its coordinates are.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..errors import DualpinError
from ..model.memory import memory
from ..model.robot import Frame, Robot
from .rigid import (
    Array,
    carried,
    carried_wrench,
    cross,
    displacement,
    exact,
    factors,
    momentum,
    number,
    pose,
    product,
    seen,
    six,
    small_motion,
    solution,
    weight,
)

WORKING_DIGITS = 130
"""A difference over STEP loses 30 digits, one of differences 60; its own error is STEP^2."""
STEP = "1e-30"


class UndecidedError(DualpinError):
    """The term has no value there, or there is no time left to evaluate it."""


class Definitions:
    """One robot in one state, by what its terms are defined by.

    Parameters
    ----------
    robot : Robot
        Its constants are taken as the doubles they are; rotations and axes are made orthonormal.
    state : mapping
        The arrays of one sample: "q", and "v", "a", "tau", "f_ext" (njoints, 6), "q1" as the term needs them.
    seconds : float
        Of the processor, after which it gives up with an `UndecidedError`.

    Notes
    -----
    To be used within ``mpmath.workdps(WORKING_DIGITS)``.  World six-vectors are [w; v0] and [l0; p], about
    the world's origin.
    """

    def __init__(self, robot: Robot, state: Mapping[str, Array], seconds: float = 10.0) -> None:
        import mpmath

        self.mp, self.given = mpmath, robot
        kept = memory(robot)
        self.robot = kept.get("definitions") or kept.setdefault("definitions", robot.lift(mpmath.mpf))
        # of this thread, so that the load of the machine does not count
        self.deadline = time.thread_time() + seconds
        self.h = mpmath.mpf(STEP)
        self.state = {key: exact(mpmath, x) for key, x in state.items()}
        self.joints = list(self.robot)
        self.screws = [[six(mpmath, s) for s in j.model.screws] for j in self.joints]
        self.parents = [j.parent.index if j.parent else -1 for j in self.joints]
        self.indices = [list(range(j.v.start, j.v.stop)) for j in self.joints]
        self.bodies = [exact(mpmath, [number(mpmath, x) for x in j.inertia.parameters]) for j in self.joints]
        self.field = exact(mpmath, [number(mpmath, x) for x in self.robot.gravity])
        self.q = self.state["q" if "q" in self.state else "q0"]
        moved = (displacement(mpmath, j, self.q[j.q]) for j in self.joints)
        self.at_q = [product(pose(mpmath, j.placement), X) for j, X in zip(self.joints, moved, strict=True)]

    # --- poses and velocities --------------------------------------------------------------------

    def zeros(self) -> Array:
        return exact(self.mp, [0] * self.robot.nv)

    def poses(self, *steps: Array) -> list[Array]:
        """4x4 matrices of all bodies at q, moved by exp(S step) for each step."""
        if time.thread_time() > self.deadline:
            raise UndecidedError("the time for its evaluation with 50 digits was over")
        found: list[Array] = []
        for i, T in enumerate(self.at_q):
            for step in steps:
                if any(step[k] for k in self.indices[i]):
                    twist = sum(s * step[k] for s, k in zip(self.screws[i], self.indices[i], strict=True))
                    T = product(T, small_motion(self.mp, twist))
            found.append(product(found[self.parents[i]], T) if self.parents[i] >= 0 else T)
        return found

    def columns(self, T: list[Array]) -> list[list[Array]]:
        """The world twist of each degree of freedom of each joint at unit velocity."""
        return [[carried(X, s) for s in screws] for X, screws in zip(T, self.screws, strict=True)]

    def twists(self, T: list[Array], v: Array) -> list[Array]:
        """World twists of all bodies."""
        found: list[Array] = []
        for i, columns in enumerate(self.columns(T)):
            V = found[self.parents[i]] if self.parents[i] >= 0 else exact(self.mp, [0] * 6)
            for column, k in zip(columns, self.indices[i], strict=True):
                V = V + column * v[k]
            found.append(V)
        return found

    def rate(self, f: Callable[[Array, Array], Any], v: Array, a: Array | None = None) -> Any:
        """df/dt of f(step, velocity) along the curve."""
        a, h = self.zeros() if a is None else a, self.h
        after, before = (f(v * t + a * (t * t / 2), v + a * t) for t in (h, -h))
        return (after - before) / (2 * h)

    # --- momentum and force ----------------------------------------------------------------------

    def momenta(self, T: list[Array], V: list[Array], bodies: list[Array] | None = None) -> Array:
        """World momenta [l0; p] of all bodies."""
        return np.array([momentum(X, W, body) for X, W, body in zip(T, V, bodies or self.bodies, strict=True)])

    def transmitted(
        self, v: Array, a: Array, *, gravity: bool = True, f_ext: Array | None = None, at: Array | None = None,
        bodies: list[Array] | None = None,
    ) -> tuple[list[Array], list[Array]]:  # fmt: skip
        """Poses, and the joints' world wrenches.

        Newton and Euler: the rate of the momenta is what gravity, f_ext and the joints' forces make.
        """
        at = self.zeros() if at is None else at
        bodies = bodies or self.bodies

        def momenta(step: Array, velocity: Array) -> Array:
            T = self.poses(at, step)
            return self.momenta(T, self.twists(T, velocity), bodies)

        forces = list(self.rate(momenta, v, a))
        T = self.poses(at)
        for i, X in enumerate(T):
            if gravity:
                forces[i] = forces[i] - weight(X, bodies[i], self.field)
            if f_ext is not None:
                forces[i] = forces[i] - carried_wrench(X, f_ext[i])
        for i in reversed(range(len(T))):
            if self.parents[i] >= 0:
                forces[self.parents[i]] = forces[self.parents[i]] + forces[i]
        return T, forces

    def torques(self, v: Array, a: Array, *, rotors: bool = True, **more: Any) -> Array:
        """Joint forces: the joints' wrenches on their screws; `more` as in `transmitted`."""
        T, forces = self.transmitted(v, a, **more)
        tau = self.zeros()
        for i, columns in enumerate(self.columns(T)):
            for n, (column, k) in enumerate(zip(columns, self.indices[i], strict=True)):
                tau[k] += column @ forces[i] + (self.armature(i, n) * a[k] if rotors else 0)
        return tau

    def armature(self, i: int, n: int) -> Any:
        """What a rotor adds to the diagonal of M; one that follows turns by the multiplier of its leader's rate."""
        joint = self.joints[i]
        return number(self.mp, joint.armature[n]) * self.multiplier(i) ** 2 if joint.armature else self.mp.mpf(0)

    def multiplier(self, i: int) -> Any:
        return number(self.mp, self.joints[i].model.coupling[0])

    def mass_matrix(self) -> Array:
        """The kinetic energy as a bilinear form: M = sum J^T I J, with rotors."""
        T = self.poses()
        M = np.array([self.zeros() for _ in range(self.robot.nv)]).reshape(self.robot.nv, self.robot.nv)
        J = self.columns(T)
        for i in range(len(T)):
            at = [k for b in self.chain(i) for k in self.indices[b]]
            C = np.array([c for b in self.chain(i) for c in J[b]], dtype=object).reshape(-1, 6).T
            P = momentum(T[i], C, self.bodies[i])
            for n, k in enumerate(at):
                M[k, k] += C[:, n] @ P[:, n]
                for m, x in zip(at, P[:, n] @ C[:, :n], strict=False):
                    M[k, m] += x
                    M[m, k] += x
            for n, k in enumerate(self.indices[i]):
                M[k, k] += self.armature(i, n)
        return M

    def chain(self, i: int) -> list[int]:
        """Body i and those before it."""
        found = []
        while i >= 0:
            found.append(i)
            i = self.parents[i]
        return found

    def solved(self, b: Array) -> Array:
        """M^-1 b."""
        return solution(self._factors, b)

    @property
    def _factors(self) -> Array:
        """Those of M; of the last q they are kept, since several terms are often worst at the same sample."""
        kept, at = memory(self.given), tuple(self.q)
        found = kept.get("factors of M")
        if found is None or found[0] != at:
            found = kept["factors of M"] = at, factors(self.mass_matrix(), self.mp.mp.eps)
        return found[1]

    # --- frames, directions, sums --------------------------------------------------------------------

    def lifted(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """Options, with the frame of this robot instead of the given one's."""
        frame = {"frame": self.robot.frames[self.given.frames.index(options["frame"])]} if "frame" in options else {}
        return {**options, **frame}

    def frame(self, T: list[Array], frame: Frame) -> Array:
        X = pose(self.mp, frame.placement)
        return T[frame.joint.index] @ X if frame.joint else X

    def jacobian(self, step: Array, frame: Frame, reference: str) -> Array:
        T = self.poses(step)
        J = np.array([exact(self.mp, [0] * 6) for _ in range(self.robot.nv)]).reshape(self.robot.nv, 6)
        columns = self.columns(T)
        for b in self.chain(frame.joint.index) if frame.joint else []:
            for column, k in zip(columns[b], self.indices[b], strict=True):
                J[k] = J[k] + column
        here = self.frame(T, frame)
        return np.array([seen(here, column, reference) for column in J]).reshape(-1, 6).T

    def unit(self, j: int) -> Array:
        e = self.zeros()
        e[j] = self.mp.mpf(1)
        return e

    def bracket(self, v: Array, j: int) -> Array:
        """[v, e_j] of fields with constant velocities: within the joint of j, the product of their twists."""
        found = self.zeros()
        (i,) = [i for i, k in enumerate(self.indices) if j in k and self.joints[i].mimic is None]
        S = np.array(self.screws[i])
        V, U = v[self.indices[i]] @ S, S[self.indices[i].index(j)]
        W = np.concatenate([cross(V[:3], U[:3]), cross(V[:3], U[3:]) + cross(V[3:], U[:3])])
        for n, k in enumerate(self.indices[i]):
            found[k] = W @ S[n] / (S[n] @ S[n])  # the screws of such a joint are along the axes
        return found

    def first_moments(self) -> tuple[Array, Any]:
        """sum m c in the world, and sum m."""
        T = self.poses()
        return sum(X[:3, 3] * body[0] + X[:3, :3] @ body[1:4] for X, body in zip(T, self.bodies, strict=True)), sum(
            body[0] for body in self.bodies
        )

    def total_momentum(self, v: Array) -> Array:
        """[l0; p] of the robot."""
        T = self.poses()
        return sum(self.momenta(T, self.twists(T, v)))
