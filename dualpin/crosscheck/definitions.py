"""Every term by its definition, in as many digits as asked: the judge where two libraries differ.

Nothing here is an algorithm of `dualpin.algorithms` or of the oracle.  There are only the poses of the
bodies, as products of matrices, and what the terms mean: momentum is what inertia makes of a
velocity, force is the rate of momentum, and derivatives are differences over a step of 1e-30, taken
with 130 digits.  So a mistake in a recursion, of either library, cannot hide here, and
the price is paid at one entry of one sample only.

A body moves along the curve  T(t) = T_parent P X(q) exp(S (v t + a t^2 / 2)),  whose velocity in the
joint's own coordinates is v + a t: this holds for every joint, whatever its coordinates are.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from ..errors import DualpinError
from ..model.robot import Frame, Robot
from .rigid import (
    Array,
    carried,
    carried_wrench,
    displacement,
    exact,
    inverse,
    logarithm,
    momentum,
    number,
    pose,
    seen,
    six,
    small_motion,
    weight,
)

WORKING_DIGITS = 130
"""A difference over STEP loses 30 digits, one of differences 60; its own error is STEP^2."""
STEP = "1e-30"


SELECTED = {
    "fk": (0,), "joint_wrenches": (0,), "coriolis": (1,), "minv": (1,), "com_jacobian": (1,),
    "centroidal_momentum_matrix": (1,), "joint_torque_regressor": (1,), "rnea_derivatives": (0, 2),
    "aba_derivatives": (0, 2), "difference": (0,),
}  # fmt: skip
"""Of terms that are not found as a whole: the axes whose indices say which part is found at once."""


class UndecidedError(DualpinError):
    """There is no definition of the term, or no time left to evaluate it."""


class Definitions:
    """The terms of one robot in one state.

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

        self.mp, self.robot = mpmath, robot.lift(mpmath.mpf)
        # of this thread: what else the machine does is no reason to give up
        self.deadline = time.thread_time() + seconds
        self.h = mpmath.mpf(STEP)
        self.state = {key: exact(mpmath, x) for key, x in state.items()}
        self.joints = list(self.robot)
        self.placements = [pose(mpmath, j.placement) for j in self.joints]
        self.screws = [[six(mpmath, s) for s in j.model.screws] for j in self.joints]
        self.parents = [j.parent.index if j.parent else -1 for j in self.joints]
        self.indices = [list(range(j.v.start, j.v.stop)) for j in self.joints]
        self.bodies = [exact(mpmath, [number(mpmath, x) for x in j.inertia.parameters]) for j in self.joints]
        self.field = exact(mpmath, [number(mpmath, x) for x in self.robot.gravity])
        self.q = self.state["q" if "q" in self.state else "q0"]

    # --- poses and velocities --------------------------------------------------------------------

    def zeros(self) -> Array:
        return exact(self.mp, [0] * self.robot.nv)

    def poses(self, *steps: Array) -> list[Array]:
        """4x4 matrices of all bodies at q, moved by exp(S step) for each step."""
        if time.thread_time() > self.deadline:
            raise UndecidedError("the time for its evaluation with 50 digits was over")
        found: list[Array] = []
        for i, joint in enumerate(self.joints):
            T = self.placements[i] @ displacement(self.mp, joint, self.q[joint.q])
            for step in steps:
                twist = sum(
                    (s * step[k] for s, k in zip(self.screws[i], self.indices[i], strict=True)), start=0 * T[0, 0]
                )
                T = T @ small_motion(self.mp, twist) if self.screws[i] else T
            found.append(found[self.parents[i]] @ T if self.parents[i] >= 0 else T)
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
        """What the joints' wrenches do on their screws; `more` as in `transmitted`."""
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
            chain = [(c, k) for b in self.chain(i) for c, k in zip(J[b], self.indices[b], strict=True)]
            momenta = [(momentum(T[i], c, self.bodies[i]), k) for c, k in chain]
            for c, k in chain:
                for P, m in momenta:
                    M[k, m] += c @ P
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
        factors, order = self._factored
        y = self.mp.mp.L_solve(factors, self.mp.matrix(list(b)), order)
        return np.array(list(self.mp.mp.U_solve(factors, y)), dtype=object)

    @cached_property
    def _factored(self) -> Any:
        return self.mp.mp.LU_decomp(self.mp.matrix(self.mass_matrix().tolist()))

    # --- the terms ---------------------------------------------------------------------------------
    #
    # A function of a term returns as much as is found at once: a column, say, for the indices in SELECTED.

    def entry(self, term: str, index: tuple[int, ...], options: Mapping[str, Any]) -> Any:
        """One entry of a term."""
        selected = SELECTED.get(term, ())
        rest = tuple(i for axis, i in enumerate(index) if axis not in selected)
        return self._found(term, options, *(index[axis] for axis in selected))[rest]

    def whole(self, term: str, shape: tuple[int, ...], options: Mapping[str, Any]) -> Array:
        """All entries of a term."""
        out, selected = np.empty(shape, object), SELECTED.get(term, ())
        for chosen in np.ndindex(*(shape[axis] for axis in selected)):
            at = dict(zip(selected, chosen, strict=True))
            place = tuple(at.get(axis, slice(None)) for axis in range(len(shape)))
            out[place] = self._found(term, options, *chosen)
        return out

    def _found(self, term: str, options: Mapping[str, Any], *chosen: int) -> Array:
        if term.startswith("frame_") or term in ("jacobian", "jacobian_dot"):
            return self.of_frame(term, self.robot.frames[options["frame"]], options)
        found = getattr(self, f"_{term}", None)
        if found is None:
            raise UndecidedError(f"there is no definition of {term} to evaluate with 50 digits")
        return np.asarray(found(*chosen), object)

    def of_frame(self, term: str, frame: Frame, options: Mapping[str, Any]) -> Array:
        s, how = self.state, options.get("reference", "world")
        if term == "frame_pose":
            return self.frame(self.poses(), frame)
        if term == "jacobian":
            return self.seen_jacobian(self.zeros(), frame, how)
        if term == "jacobian_dot":
            return self.rate(lambda step, _: self.seen_jacobian(step, frame, how), s["v"])
        J = lambda step: self.seen_jacobian(step, frame, "world")  # noqa: E731
        here = self.frame(self.poses(), frame)
        twist = seen(here, J(self.zeros()) @ s["v"], how)
        if term == "frame_velocity":
            return twist
        A = seen(here, self.rate(lambda step, velocity: J(step) @ velocity, s["v"], s["a"]), how)
        if options.get("classical"):
            A[3:] = A[3:] + np.cross(twist[:3], twist[3:])
        return A

    def frame(self, T: list[Array], frame: Frame) -> Array:
        X = pose(self.mp, frame.placement)
        return T[frame.joint.index] @ X if frame.joint else X

    def seen_jacobian(self, step: Array, frame: Frame, reference: str) -> Array:
        T = self.poses(step)
        J = np.array([exact(self.mp, [0] * 6) for _ in range(self.robot.nv)]).reshape(self.robot.nv, 6)
        columns = self.columns(T)
        for b in self.chain(frame.joint.index) if frame.joint else []:
            for column, k in zip(columns[b], self.indices[b], strict=True):
                J[k] = J[k] + column
        here = self.frame(T, frame)
        return np.array([seen(here, column, reference) for column in J]).reshape(-1, 6).T

    def _fk(self, joint: int) -> Array:
        return self.poses()[joint]

    def _rnea(self) -> Array:
        return self.torques(self.state["v"], self.state["a"])

    def _joint_wrenches(self, joint: int) -> Array:
        T, forces = self.transmitted(self.state["v"], self.state["a"])
        R, p, (n, f) = T[joint][:3, :3], T[joint][:3, 3], np.split(forces[joint], 2)
        return np.concatenate([R.T @ (n - np.cross(p, f)), R.T @ f])

    def _rnea_f_ext(self) -> Array:
        f_ext = self.state["f_ext"].reshape(-1, 6)
        return self.torques(self.state["v"], self.state["a"], f_ext=f_ext)

    def _bias(self) -> Array:
        return self.torques(self.state["v"], self.zeros())

    def _gravity(self) -> Array:
        return self.torques(self.zeros(), self.zeros())

    def _crba(self) -> Array:
        return self.mass_matrix()

    def _coriolis(self, j: int) -> Array:
        """M nabla_v u of the metric's connection at u = e_j: half of what is symmetric in v and u, and of M [v, u].

        Of the bodies: rotors are no part of it.
        """
        v, u, none = self.state["v"], self.unit(j), self.zeros()
        both, of_v, of_u = (self.torques(w, none, gravity=False) for w in (v + u, v, u))
        symmetric = both - of_v - of_u
        return (symmetric + self.torques(none, self.bracket(v, j), gravity=False, rotors=False)) / 2

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
        W = np.concatenate([np.cross(V[:3], U[:3]), np.cross(V[:3], U[3:]) + np.cross(V[3:], U[:3])])
        for n, k in enumerate(self.indices[i]):
            found[k] = W @ S[n] / (S[n] @ S[n])  # the screws of such a joint are along the axes
        return found

    def _accelerations(self) -> Array:
        return self.solved(self.state["tau"] - self.torques(self.state["v"], self.zeros()))

    def _aba(self) -> Array:
        return self._accelerations()

    def _minv(self, j: int) -> Array:
        return self.solved(self.unit(j))

    def _kinetic_energy(self) -> Any:
        T = self.poses()
        V = self.twists(T, self.state["v"])
        rotors = sum(
            self.armature(i, n) * self.state["v"][k] ** 2 for i, ks in enumerate(self.indices) for n, k in enumerate(ks)
        )
        return (sum(W @ P for W, P in zip(V, self.momenta(T, V), strict=True)) + rotors) / 2

    def first_moments(self, T: list[Array]) -> tuple[Array, Any]:
        """sum m c in the world, and sum m."""
        return sum(body[0] * X[:3, 3] + X[:3, :3] @ body[1:4] for X, body in zip(T, self.bodies, strict=True)), sum(
            body[0] for body in self.bodies
        )

    def _potential_energy(self) -> Any:
        return -(self.field @ self.first_moments(self.poses())[0])

    def _com(self) -> Array:
        moments, mass = self.first_moments(self.poses())
        return moments / mass

    def _com_jacobian(self, j: int) -> Array:
        return self._total_momentum(j)[3:] / self.first_moments(self.poses())[1]

    def _total_momentum(self, j: int) -> Array:
        T = self.poses()
        return sum(self.momenta(T, self.twists(T, self.unit(j))))

    def _centroidal_momentum_matrix(self, j: int) -> Array:
        moments, mass = self.first_moments(self.poses())
        P = self._total_momentum(j)
        return np.concatenate([P[:3] - np.cross(moments / mass, P[3:]), P[3:]])

    def _joint_torque_regressor(self, column: int) -> Array:
        body, parameter = divmod(column, 10)
        if body >= len(self.joints):  # rotors follow the bodies
            rotors = [(b, k) for b, ks in enumerate(self.indices) for k in ks]
            b, k = rotors[column - 10 * len(self.joints)]
            return self.unit(k) * self.state["a"][k] * self.multiplier(b) ** 2
        bodies = [exact(self.mp, [0] * 10) for _ in self.joints]
        bodies[body][parameter] = self.mp.mpf(1)
        return self.torques(self.state["v"], self.state["a"], rotors=False, bodies=bodies)

    def _by(self, block: int, j: int, a: Array) -> Array:
        """d tau / dq_j or d tau / dv_j."""
        v, e, h, none = self.state["v"], self.unit(j), self.h, self.zeros()
        if block == 0:
            after, before = (self.torques(v, a, at=e * t) for t in (h, -h))
            return (after - before) / (2 * h)
        # quadratic in v, so that a difference over any step is exact
        return (self.torques(v + e, none) - self.torques(v - e, none)) / 2

    def _rnea_derivatives(self, block: int, j: int) -> Array:
        return self._crba()[:, j] if block == 2 else self._by(block, j, self.state["a"])

    def _aba_derivatives(self, block: int, j: int) -> Array:
        return self._minv(j) if block == 2 else -self.solved(self._by(block, j, self._accelerations()))

    def _difference(self, i: int) -> Any:
        q1 = self.state["q1"]
        (joint,) = [j for j in self.joints if i in range(j.v.start, j.v.stop) and j.mimic is None]
        X0, X1 = (displacement(self.mp, joint, x[joint.q]) for x in (self.q, q1))
        if joint.model.nq == joint.model.nv and len(joint.model.screws) < 3:  # coordinates of an axis add
            return q1[joint.q][i - joint.v.start] - self.q[joint.q][i - joint.v.start]
        s = self.screws[joint.index][i - joint.v.start]
        return (s @ logarithm(self.mp, inverse(X0) @ X1)) / (s @ s)
