"""Rates of joint angles for a wanted motion of a frame, over any scalar, and the terms that run them.

Everything here is one straight line of operations, so that a rate, or a whole step of an
integrator around it, becomes one kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

from ..algorithms import aba, kinematics
from ..algorithms.aba import factorised, solve_factorised, solve_inertia
from ..algorithms.coriolis import coriolis
from ..algorithms.crba import crba
from ..algorithms.jacobian import jacobian
from ..algorithms.rnea import gravity
from ..arguments import count, flag, real
from ..dual import sqrt
from ..integrators.column import Column
from ..integrators.methods import Method
from ..integrators.space import ConfigurationSpace, StateSpace
from ..integrators.step import step
from ..model.robot import Frame, Robot
from ..scalars import ZERO, Scalar
from ..spatial.pose import Pose
from ..spatial.rotation import Rotation
from ..spatial.vector import ZERO_MOTOR
from ..terms import FRAME, TAU, Option, Q, Term, V, row, twist_entries, velocity
from .task import POSE, Rows, rows_of, selected, task_error

Table = list[list[Scalar]]


class Resolved(NamedTuple):
    """Joint rates, and by how much the elimination behind them lost digits."""

    rate: Column
    loss: Scalar


def resolved_rate(
    columns: Sequence[Sequence[Scalar] | None], twist: Sequence[Scalar], damping: Scalar, damped: bool
) -> Resolved:
    """J^+ twist by Gauss's elimination in the smaller of J J^T and J^T J.   (Whitney 1969)

        J^T (J J^T + damping^2)^-1 twist       at least as many joints as twist components, or damped
        (J^T J)^-1 J^T twist                   fewer

    The loss sum (diagonal / pivot)^2 tells how near to singular the matrix was: eps^2 loss is the
    square of the relative error to be expected.
    """
    moving = [k for k, c in enumerate(columns) if c is not None]
    J = [c for c in columns if c is not None]
    if damped or len(J) >= len(twist):
        n = len(twist)
        A = [[_dot([c[i] for c in J], [c[j] for c in J]) for j in range(n)] for i in range(n)]
        if damped:
            for i in range(n):
                A[i][i] = A[i][i] + damping * damping
        x, loss = _solved(A, list(twist))
        parts = [_dot(c, x) for c in J]
    else:
        A = [[_dot(a, b) for b in J] for a in J]
        parts, loss = _solved(A, [_dot(c, twist) for c in J])
    rate: list[Scalar] = [ZERO] * len(columns)
    for k, x in zip(moving, parts, strict=True):
        rate[k] = x
    return Resolved(Column(rate), loss)


def _solved(A: Table, b: list[Scalar]) -> tuple[list[Scalar], Scalar]:
    L, D = factorised(A)
    loss = ZERO
    for i, d in enumerate(D):
        ratio = A[i][i] / d
        loss = loss + ratio * ratio
    return solve_factorised(L, D, b), loss


def _dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    total = ZERO
    for x, y in zip(a, b, strict=True):
        total = total + x * y
    return total


def posed(entries: Sequence[Scalar]) -> Pose:
    """The pose of the twelve entries of [R p], row by row."""
    return Pose.from_rows([entries[0:4], entries[4:8], entries[8:12]])


class Aim(NamedTuple):
    """Right-hand side of the law of closed-loop inverse kinematics,  J dq/dt = aim."""

    columns: list[list[Scalar] | None]
    """Of the task's Jacobian; None where a joint does not carry the frame."""
    aim: Column


def law(
    robot: Robot, q: Sequence[Scalar], frame: Frame, rows: Rows, twist: Sequence[Scalar], error: Sequence[Scalar],
    gain: Scalar, drift: Sequence[Scalar] | None = None,
) -> Aim:  # fmt: skip
    """The law of tracking,  J (dq/dt - z) = S (V_d + K e) - J z,  S the components that the task asks for.

    `error` is that of `ERROR`; z, the drift, is the wanted null-space motion.
    """
    R = kinematics.frame_pose(robot, q, frame).rotation
    columns = _columns(robot, q, frame, rows, R)
    aim = Column(selected(rows, R, twist)) + Column(error[i] for i in rows) * gain
    if drift is not None:
        aim = aim - [_dot([ZERO if c is None else c[i] for c in columns], drift) for i in range(len(rows))]
    return Aim(columns, aim)


def _columns(robot: Robot, q: Sequence[Scalar], frame: Frame, rows: Rows, R: Rotation) -> list[list[Scalar] | None]:
    """Columns of the task's Jacobian at the frame's origin; None where a joint does not carry it."""
    J = jacobian(robot, q, frame, "local_world_aligned")
    return [None if c is ZERO_MOTOR else selected(rows, R, twist_entries(c)) for c in J]


# --- terms ---------------------------------------------------------------------------------------


def _error(robot: Robot, q: Any, pose: Any, frame: Frame, rows: Rows) -> Any:
    return task_error(rows, posed(pose), kinematics.frame_pose(robot, q, frame))


def _law(
    robot: Robot, q: Any, pose: Any, twist: Any, held_error: Any, drift: Any, gain: Any, frame: Frame, rows: Rows,
    held: bool,
) -> Aim:  # fmt: skip
    error = held_error if held else _error(robot, q, pose, frame, rows)
    return law(robot, q, frame, rows, twist, error, gain[0], drift)


def _rate(
    robot: Robot, q: Any, pose: Any, twist: Any, error: Any, drift: Any, gain: Any, damping: Any, frame: Frame,
    rows: Rows, held: bool, damped: bool,
) -> Any:  # fmt: skip
    wanted = _law(robot, q, pose, twist, error, drift, gain, frame, rows, held)
    rate, loss = resolved_rate(*wanted, damping[0], damped)
    return [*(rate + drift), loss]


def _aim(
    robot: Robot, q: Any, pose: Any, twist: Any, error: Any, drift: Any, gain: Any, frame: Frame, rows: Rows, held: bool
) -> Any:
    columns, aim = _law(robot, q, pose, twist, error, drift, gain, frame, rows, held)
    zero = [ZERO] * len(rows)
    return [*aim, *(x for c in columns for x in c or zero)]


WANTED, TWIST, LACKING = row("pose", 12), row("twist", 6), row("error", 6)  # [R p] row by row; [w; v]
DRIFT, GAIN, DAMPING, H = velocity("drift"), row("gain"), row("damping"), row("h")
LOSSES = velocity("viscous"), velocity("dry")
ROWS = Option("rows", lambda robot, what, given: _rows(what, given))
HELD = Option("held", lambda robot, what, given: flag(what, given))
DAMPED = Option("damped", lambda robot, what, given: flag(what, given))
LENGTH = Option("length", lambda robot, what, given: real(what, given, "m", above=0))
SWEEPS = Option("sweeps", lambda robot, what, given: count(what, given, 1))


def _rows(what: str, given: Any) -> Rows:
    known = isinstance(given, tuple) and list(given) == sorted({*given} & {*POSE})  # a mask repeats its booleans
    return given if known else rows_of(what, given)


ERROR = Term("task_error", (Q, WANTED), _error, lambda r, **_: (6,), (FRAME, ROWS))
"""The error of the frame against a pose: six numbers, see `dualpin.tracking.task.task_error`."""

RATE = Term("tracking_rate", (Q, WANTED, TWIST, LACKING, DRIFT, GAIN, DAMPING), _rate, lambda r, **_: (r.nv + 1,),
            (FRAME, ROWS, HELD, DAMPED))  # fmt: skip
"""Joint rates by the law of tracking, and how much the elimination behind them lost.  The error is that of the pose,
or as given if it is held."""

AIM = Term("tracking_aim", (Q, WANTED, TWIST, LACKING, DRIFT, GAIN), _aim,
           lambda r, rows, **_: (len(rows) * (r.nv + 1),), (FRAME, ROWS, HELD))  # fmt: skip
"""The right-hand side of the law of tracking, and the columns of the task's Jacobian."""


def _gauss_newton(
    robot: Robot, q: Any, pose: Any, weights: Any, damping: Any, frame: Frame, rows: Rows, length: float
) -> Any:
    wanted, X = posed(pose), kinematics.frame_pose(robot, q, frame)
    if rows == POSE:  # log of X^-1 X_d as a dual quaternion: the body twist [w; v] that leads to the target
        error: Sequence[Scalar] = twist_entries((X.inverse @ wanted).quaternion.log * 2)
        J = [None if c is ZERO_MOTOR else twist_entries(c) for c in jacobian(robot, q, frame, "local")]
    else:
        error = task_error(rows, wanted, X)
        J = _columns(robot, q, frame, rows, X.rotation)
    # lengths are divided by the chain's length, so that the search does not depend on the unit of length
    unit = [1.0 if i < 3 else 1.0 / length for i in rows]
    columns = [None if c is None else [x * (w * u) for x, u in zip(c, unit, strict=True)]
               for c, w in zip(J, weights, strict=True)]  # fmt: skip
    missing = [error[i] * u for i, u in zip(rows, unit, strict=True)]
    moved, _ = resolved_rate(columns, missing, damping[0], True)
    return [*(x * w for x, w in zip(moved, weights, strict=True)), *error]


GAUSS_NEWTON = Term("ik_step", (Q, WANTED, velocity("weights"), DAMPING), _gauss_newton,
                    lambda r, **_: (r.nv + 6,), (FRAME, ROWS, LENGTH))  # fmt: skip
"""The damped Gauss-Newton displacement of the joints, and the error: for a pose the dual quaternion's logarithm."""


@cache
def tracking_step(method: Method, held: bool, depth: int) -> Term:
    """A whole step of a fixed-step method around the closed loop, as one term.

    Inputs: q; pose and twist at each of the method's nodes; gain, damping, h; the rates of `depth`
    earlier steps.  Results: the next q, the rates to remember, the sum of the losses.
    """
    n = len(method.nodes)

    def compute(
        robot: Robot, q: Any, poses: Any, twists: Any, gain: Any, damping: Any, h: Any, past: Any = (), *,
        frame: Frame, rows: Rows, damped: bool,
    ) -> Any:  # fmt: skip
        losses: list[Scalar] = []
        kept: list[list[Scalar]] = []

        def rate(i: int, x: Any) -> Column:
            if not (held and kept):
                kept[:] = [_error(robot, x, poses[12 * i : 12 * i + 12], frame, rows)]
            wanted = law(robot, x, frame, rows, twists[6 * i : 6 * i + 6], kept[0], gain[0])
            found = resolved_rate(*wanted, damping[0], damped)
            losses.append(found.loss)
            return found.rate

        before = tuple(Column(past[robot.nv * j : robot.nv * (j + 1)]) for j in range(depth))
        y, after = step(method, rate, Column(q), h[0], before, ConfigurationSpace(robot))
        return [*y, *(after[0] if depth else ()), sum(losses, ZERO)]

    earlier = (velocity("past", times=depth),) if depth else ()
    inputs = (Q, row("poses", 12 * n), row("twists", 6 * n), GAIN, DAMPING, H, *earlier)
    name = f"tracking_step_{method.name}" + ("_held" if held else "")
    return Term(name, inputs, compute, lambda r, **_: (r.nq + (r.nv if depth else 0) + 1,), (FRAME, ROWS, DAMPED))


SLOW = 1e-3
"""Speed [rad/s or m/s] below which dry friction fades: at rest Coulomb friction is not a function of the velocity."""


def drag(v: Scalar, viscous: Scalar, dry: Scalar) -> Scalar:
    """The force of damping and of dry friction on a joint, against its velocity:  d v + f v / sqrt(v^2 + SLOW^2)."""
    return v * viscous + v * (dry / sqrt(v * v + SLOW * SLOW))


def _net(tau: Any, v: Any, losses: Any) -> Column:
    """Torques less the drag, if losses (viscous, dry) are given."""
    return Column(tau) - [drag(*x) for x in zip(v, *losses, strict=True)] if losses else Column(tau)


@cache
def dynamics_step(method: Method, dissipative: bool) -> Term:
    """A whole step of the equations of motion under constant joint torques: the next q and v."""

    def compute(robot: Robot, q: Any, v: Any, tau: Any, h: Any, *losses: Any) -> Any:
        nq = robot.nq

        def rate(i: int, y: Any) -> Column:
            return Column((*y[nq:], *aba.aba(robot, y[:nq], y[nq:], _net(tau, y[nq:], losses))))

        y, _ = step(method, rate, Column((*q, *v)), h[0], (), StateSpace(robot))
        return y

    extra, suffix = (LOSSES, "_dissipative") if dissipative else ((), "")
    return Term(f"dynamics_step_{method.name}{suffix}", (Q, V, TAU, H, *extra), compute, lambda r, **_: (r.nq + r.nv,))


def _variational(robot: Robot, q: Any, p: Any, v: Any, tau: Any, h: Any, *losses: Any, sweeps: int) -> Any:
    """Fixed-point sweeps of the discrete Euler-Lagrange equations; see `simulate`."""
    for _ in range(sweeps):
        before = v
        middle = Column(q) + Column(v) * (h[0] / 2)
        C, g, net = coriolis(robot, middle, v), gravity(robot, middle), _net(tau, v, losses)
        force = Column(net[k] - g[k] + _dot([row[k] for row in C], v) for k in range(robot.nv))
        momentum = Column(p) + force * (h[0] / 2)
        v = solve_inertia(crba(robot, middle), list(momentum))
    return [*v, *force, *before]


@cache
def variational_sweep(dissipative: bool) -> Term:
    """The midpoint velocity after some sweeps, the generalised force, and the velocity one sweep before."""
    extra, suffix = (LOSSES, "_dissipative") if dissipative else ((), "")
    inputs = (Q, velocity("p"), V, TAU, H, *extra)
    return Term("variational_sweep" + suffix, inputs, _variational, lambda r, **_: (3 * r.nv,), (SWEEPS,))
