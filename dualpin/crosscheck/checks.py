"""The terms that are compared: each by its definition, with what decides how far apart two answers may be.

Where two libraries differ, the definition decides; `definitions` has its building blocks.  The sizes say how
many digits cancellation may cost; `extent` derives them.  The function of a term has its name.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from ..errors import ArgumentError, nearest
from ..model.robot import Frame
from . import tolerance
from .check import GRAVITY, Array, Case, Check, compared
from .definitions import Definitions
from .extent import Extent
from .rigid import displacement, exact, inverse, logarithm, seen
from .sampling import planar_angles

__all__ = ["CHECKS", "Case", "Check", "chosen"]

MOTION = frozenset[str]()
"""Inputs of a term that depends on motion only."""


def _reach(x: Extent) -> Array:
    return x.reach


def _moving(x: Extent) -> Array:
    return x.reach * (x.acceleration + x.speed**2)


def _torques(x: Extent) -> Array:
    return x.heaviest * x.efforts


# --- where bodies are, and how they move ---------------------------------------------------------


@compared(adds=_reach, enters=MOTION, parts=(0,))
def fk(d: Definitions, joint: int) -> Array:
    return d.poses()[joint]


@compared(adds=_reach, enters=MOTION)
def frame_pose(d: Definitions, frame: Frame) -> Array:
    return d.frame(d.poses(), frame)


@compared(adds=_reach, enters=MOTION, form="six")
def jacobian(d: Definitions, frame: Frame, reference: str) -> Array:
    return d.jacobian(d.zeros(), frame, reference)


@compared(adds=lambda x: x.reach * x.speed, enters=MOTION, form="six_rate")
def jacobian_dot(d: Definitions, frame: Frame, reference: str) -> Array:
    return d.rate(lambda step, _: d.jacobian(step, frame, reference), d.state["v"])


@compared(adds=lambda x: x.reach * x.speed, enters=MOTION, form="twist")
def frame_velocity(d: Definitions, frame: Frame, reference: str) -> Array:
    return seen(d.frame(d.poses(), frame), d.jacobian(d.zeros(), frame, "world") @ d.state["v"], reference)


@compared(adds=_moving, enters=MOTION, form="twist")
def frame_acceleration(d: Definitions, frame: Frame, reference: str, classical: bool = False) -> Array:
    """The rate of the world twist; classical, that of the velocity of the frame's origin."""
    rate = d.rate(lambda step, velocity: d.jacobian(step, frame, "world") @ velocity, d.state["v"], d.state["a"])
    A = seen(d.frame(d.poses(), frame), rate, reference)
    if classical:
        twist = frame_velocity.definition(d, frame, reference)
        A[3:] = A[3:] + np.cross(twist[:3], twist[3:])
    return A


# --- forces --------------------------------------------------------------------------------------


@compared(adds=_torques, form="force")
def rnea(d: Definitions) -> Array:
    return d.torques(d.state["v"], d.state["a"])


@compared(adds=lambda x: _torques(x) + x.f_ext(), form="force")
def rnea_f_ext(d: Definitions) -> Array:
    return d.torques(d.state["v"], d.state["a"], f_ext=d.state["f_ext"].reshape(-1, 6))


# every direction counts, not only that of a joint's screw: D of a unit twist is at most this
@compared(adds=lambda x: x.mass**0.5 * np.maximum(1.0, x.reach) * x.efforts, form="twist", parts=(0,))
def joint_wrenches(d: Definitions, joint: int) -> Array:
    T, forces = d.transmitted(d.state["v"], d.state["a"])
    R, p, (n, f) = T[joint][:3, :3], T[joint][:3, 3], np.split(forces[joint], 2)
    return np.concatenate([R.T @ (n - np.cross(p, f)), R.T @ f])


@compared(adds=lambda x: x.heaviest * (x.swing + x.fall), form="bias")
def bias(d: Definitions) -> Array:
    return d.torques(d.state["v"], d.zeros())


@compared(adds=lambda x: x.heaviest * x.fall, form="force")
def gravity(d: Definitions) -> Array:
    return d.torques(d.zeros(), d.zeros())


# --- matrices of the equation of motion, and what solves with them ---------------------------------


@compared(adds=lambda x: x.heaviest**2, form="matrix")
def crba(d: Definitions) -> Array:
    return d.mass_matrix()


@compared(adds=lambda x: x.heaviest**2 * x.speed, form="coriolis", parts=(1,))
def coriolis(d: Definitions, j: int) -> Array:
    """M nabla_v u of the metric's connection at u = e_j: half of what is symmetric in v and u, and of M [v, u].

    Of the bodies: rotors are no part of it.
    """
    v, u, none = d.state["v"], d.unit(j), d.zeros()
    both, of_v, of_u = (d.torques(w, none, gravity=False) for w in (v + u, v, u))
    symmetric = both - of_v - of_u
    return (symmetric + d.torques(none, d.bracket(v, j), gravity=False, rotors=False)) / 2


@compared(
    bounds=lambda x, a: tolerance.solution(x.robot, x.mass, x.forces, a, x.extent), solves=True, form="acceleration"
)
def aba(d: Definitions) -> Array:
    return d.solved(d.state["tau"] - d.torques(d.state["v"], d.zeros()))


@compared(
    bounds=lambda x, _: tolerance.inverse(x.robot, x.mass, x.extent), solves=True, form="inverse", parts=(1,)
)  # fmt: skip
def minv(d: Definitions, j: int) -> Array:
    return d.solved(d.unit(j))


# --- energy and momentum -------------------------------------------------------------------------


@compared(adds=lambda x: x.push(x.states["v"]) ** 2)
def kinetic_energy(d: Definitions) -> Any:
    T = d.poses()
    V = d.twists(T, d.state["v"])
    rotors = sum(d.armature(i, n) * d.state["v"][k] ** 2 for i, ks in enumerate(d.indices) for n, k in enumerate(ks))
    return (sum(W @ P for W, P in zip(V, d.momenta(T, V), strict=True)) + rotors) / 2


@compared(bounds=lambda x, energy: tolerance.weighing(x.robot, x.extent.positions, energy))
def potential_energy(d: Definitions) -> Any:
    return -(d.field @ d.first_moments()[0])


@compared(adds=_reach)
def com(d: Definitions) -> Array:
    moments, mass = d.first_moments()
    return moments / mass


@compared(adds=lambda x: x.heaviest / x.mass**0.5, form="columns", parts=(1,))
def com_jacobian(d: Definitions, j: int) -> Array:
    return d.total_momentum(d.unit(j))[3:] / d.first_moments()[1]


@compared(adds=lambda x: x.heaviest * x.outreach * x.mass**0.5, form="six", parts=(1,))
def centroidal_momentum_matrix(d: Definitions, j: int) -> Array:
    moments, mass = d.first_moments()
    P = d.total_momentum(d.unit(j))
    return np.concatenate([P[:3] - np.cross(moments / mass, P[3:]), P[3:]])


# --- by parameters, and derivatives --------------------------------------------------------------


@compared(
    adds=lambda x: x.reach * (_moving(x) + x.gravity), enters=frozenset({GRAVITY}), form="regressor", parts=(1,)
)  # fmt: skip
def joint_torque_regressor(d: Definitions, column: int) -> Array:
    body, parameter = divmod(column, 10)
    if body >= len(d.joints):  # rotors follow the bodies
        rotors = [(b, k) for b, ks in enumerate(d.indices) for k in ks]
        b, k = rotors[column - 10 * len(d.joints)]
        return d.unit(k) * d.state["a"][k] * d.multiplier(b) ** 2
    bodies = [exact(d.mp, [0] * 10) for _ in d.joints]
    bodies[body][parameter] = d.mp.mpf(1)
    return d.torques(d.state["v"], d.state["a"], rotors=False, bodies=bodies)


def _slope(d: Definitions, block: int, j: int, a: Array) -> Array:
    """d tau / dq_j or d tau / dv_j."""
    v, e, h, none = d.state["v"], d.unit(j), d.h, d.zeros()
    if block == 0:
        after, before = (d.torques(v, a, at=e * t) for t in (h, -h))
        return (after - before) / (2 * h)
    # quadratic in v, so that a difference over any step is exact
    return (d.torques(v + e, none) - d.torques(v - e, none)) / 2


@compared(adds=lambda x: _torques(x) + x.heaviest**2 * (1 + x.speed), form="derivatives", parts=(0, 2))
def rnea_derivatives(d: Definitions, block: int, j: int) -> Array:
    return d.mass_matrix()[:, j] if block == 2 else _slope(d, block, j, d.state["a"])


@compared(
    bounds=lambda x, D: tolerance.derivatives(x.robot, x.mass, x.forces, x.ask("aba"), D, x.extent),
    solves=True, form="derivatives", parts=(0, 2),
)  # fmt: skip
def aba_derivatives(d: Definitions, block: int, j: int) -> Array:
    if block == 2:
        return d.solved(d.unit(j))
    return -d.solved(_slope(d, block, j, aba.definition(d)))


# --- configurations ------------------------------------------------------------------------------


@compared(
    bounds=lambda x, turns: tolerance.logarithm(x.robot, turns[:, planar_angles(x.robot)]),
    enters=MOTION, form="velocity", parts=(0,),
)  # fmt: skip
def difference(d: Definitions, i: int) -> Any:
    q1 = d.state["q1"]
    (joint,) = [j for j in d.joints if i in range(j.v.start, j.v.stop) and j.mimic is None]
    X0, X1 = (displacement(d.mp, joint, x[joint.q]) for x in (d.q, q1))
    if joint.model.nq == joint.model.nv and len(joint.model.screws) < 3:  # coordinates of an axis add
        return q1[joint.q][i - joint.v.start] - d.q[joint.q][i - joint.v.start]
    s = d.screws[joint.index][i - joint.v.start]
    return (s @ logarithm(d.mp, inverse(X0) @ X1)) / (s @ s)


CHECKS: dict[str, Check] = {x.term: x for x in list(globals().values()) if isinstance(x, Check)}
"""Every check by its term."""


def chosen(terms: Iterable[str] | None) -> list[Check]:
    """The checks of these terms, or of all; a name that is none is refused with the nearest."""
    if terms is None:
        return list(CHECKS.values())
    terms = [terms] if isinstance(terms, str) else list(terms)
    for term in terms:
        if term not in CHECKS:
            raise ArgumentError(f"validate: term {term!r} is not known; {nearest(term, CHECKS, 'terms', most=99)}")
    return [CHECKS[t] for t in terms]
