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
from ..arguments import count, flag
from ..integrators.column import Column
from ..integrators.methods import Method
from ..integrators.space import ConfigurationSpace, StateSpace
from ..integrators.step import step
from ..model.robot import Frame, Robot
from ..scalars import ZERO, Scalar
from ..spatial.pose import Pose
from ..spatial.quaternion import Quaternion
from ..spatial.vector import REST
from ..terms import FRAME, TAU, Option, Q, Term, V, row, twist_entries, velocity

Rows = list[list[Scalar]]


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
        A = [[_dot([c[i] for c in J], [c[j] for c in J]) for j in range(6)] for i in range(6)]
        if damped:
            for i in range(6):
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


def _solved(A: Rows, b: list[Scalar]) -> tuple[list[Scalar], Scalar]:
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


def frame_columns(robot: Robot, q: Sequence[Scalar], frame: Frame) -> list[list[Scalar] | None]:
    """Columns of the Jacobian at the frame's origin, world axes; None where a joint does not carry it."""
    J = jacobian(robot, q, frame, "local_world_aligned")
    return [None if c is REST else twist_entries(c) for c in J]


def pose_error(robot: Robot, q: Sequence[Scalar], pose: Sequence[Scalar], frame: Frame) -> Column:
    """[log(R_d R^T); p_d - p]: what is left to turn [rad] and to move [m], world axes."""
    wanted, X = posed(pose), kinematics.frame_pose(robot, q, frame)
    turn = Quaternion.from_rotation(wanted.rotation @ X.rotation.T).log * 2
    return Column((*turn, *(wanted.position - X.position)))


def posed(entries: Sequence[Scalar]) -> Pose:
    """The pose of the twelve entries of [R p], row by row."""
    return Pose.from_rows([entries[0:4], entries[4:8], entries[8:12]])


# --- terms ---------------------------------------------------------------------------------------

POSE, TWIST, DRIFT = row("pose", 12), row("twist", 6), velocity("drift")  # [R p] row by row; [w; v]; joint rates
GAIN, DAMPING, H = row("gain"), row("damping"), row("h")
DAMPED = Option("damped", lambda robot, what, given: flag(what, given))
SWEEPS = Option("sweeps", lambda robot, what, given: count(what, given, 1))


def _closed_loop(
    robot: Robot, q: Any, pose: Any, twist: Any, drift: Any, gain: Any, damping: Any, frame: Frame, damped: bool
) -> Any:
    error = pose_error(robot, q, pose, frame)
    columns = frame_columns(robot, q, frame)
    aim = Column(twist) + error * gain[0]
    # z + J^+ (aim - J z): the rate nearest to z that follows the aim
    aim = aim - [_dot([ZERO if c is None else c[i] for c in columns], drift) for i in range(6)]
    rate, loss = resolved_rate(columns, aim, damping[0], damped)
    return [*(rate + drift), loss, *error]


CLOSED_LOOP = Term(
    "tracking_rate", (Q, POSE, TWIST, DRIFT, GAIN, DAMPING), _closed_loop, lambda r, **_: (r.nv + 7,), (FRAME, DAMPED)
)
"""Joint rates, loss and error of closed-loop inverse kinematics."""


def _held_loop(robot: Robot, q: Any, aim: Any, drift: Any, damping: Any, frame: Frame, damped: bool) -> Any:
    columns = frame_columns(robot, q, frame)
    aim = Column(aim) - [_dot([ZERO if c is None else c[i] for c in columns], drift) for i in range(6)]
    rate, loss = resolved_rate(columns, aim, damping[0], damped)
    return [*(rate + drift), loss]


HELD_LOOP = Term("resolved_rate", (Q, TWIST, DRIFT, DAMPING), _held_loop, lambda r, **_: (r.nv + 1,), (FRAME, DAMPED))
"""Joint rates and loss for a given twist of the frame."""

POSE_ERROR = Term(
    "pose_error", (Q, POSE), lambda r, q, pose, frame: pose_error(r, q, pose, frame), lambda r, **_: (6,), (FRAME,)
)


def _local_error(robot: Robot, q: Any, pose: Any, frame: Frame) -> Column:
    """log of X^-1 X_d as a dual quaternion: the body twist [w; v] that leads to the target."""
    wanted, X = posed(pose), kinematics.frame_pose(robot, q, frame)
    return Column(twist_entries((X.inverse @ wanted).quaternion.log * 2))


def _gauss_newton(robot: Robot, q: Any, pose: Any, weights: Any, damping: Any, frame: Frame) -> Any:
    error = _local_error(robot, q, pose, frame)
    J = jacobian(robot, q, frame, "local")
    columns = [None if c is REST else [x * w for x in twist_entries(c)] for c, w in zip(J, weights, strict=True)]
    moved, _ = resolved_rate(columns, error, damping[0], True)
    return [*(x * w for x, w in zip(moved, weights, strict=True)), *error]


GAUSS_NEWTON = Term(
    "ik_step", (Q, POSE, velocity("weights"), DAMPING), _gauss_newton, lambda r, **_: (r.nv + 6,), (FRAME,)
)
"""The damped Gauss-Newton displacement of the joints, and the dual-quaternion log error."""


@cache
def tracking_step(method: Method, held: bool, depth: int) -> Term:
    """A whole step of a fixed-step method around the closed loop, as one term.

    Inputs: q; pose and twist at each of the method's nodes; gain, damping, h; the rates of `depth`
    earlier steps.  Results: the next q, the rates to remember, the sum of the losses.
    """
    n = len(method.nodes)

    def compute(
        robot: Robot, q: Any, poses: Any, twists: Any, gain: Any, damping: Any, h: Any, past: Any = (), *,
        frame: Frame, damped: bool,
    ) -> Any:  # fmt: skip
        losses: list[Scalar] = []
        kept: list[Column] = []

        def rate(i: int, x: Any) -> Column:
            twist = Column(twists[6 * i : 6 * i + 6])
            if not (held and kept):
                kept[:] = [pose_error(robot, x, poses[12 * i : 12 * i + 12], frame)]
            found = resolved_rate(frame_columns(robot, x, frame), twist + kept[0] * gain[0], damping[0], damped)
            losses.append(found.loss)
            return found.rate

        before = tuple(Column(past[robot.nv * j : robot.nv * (j + 1)]) for j in range(depth))
        y, after = step(method, rate, Column(q), h[0], before, ConfigurationSpace(robot))
        return [*y, *(after[0] if depth else ()), sum(losses, ZERO)]

    earlier = (velocity("past", times=depth),) if depth else ()
    inputs = (Q, row("poses", 12 * n), row("twists", 6 * n), GAIN, DAMPING, H, *earlier)
    name = f"tracking_step_{method.name}" + ("_held" if held else "")
    return Term(name, inputs, compute, lambda r, **_: (r.nq + (r.nv if depth else 0) + 1,), (FRAME, DAMPED))


@cache
def dynamics_step(method: Method) -> Term:
    """A whole step of the equations of motion under constant joint torques: the next q and v."""

    def compute(robot: Robot, q: Any, v: Any, tau: Any, h: Any) -> Any:
        nq = robot.nq

        def rate(i: int, y: Any) -> Column:
            return Column((*y[nq:], *aba.aba(robot, y[:nq], y[nq:], tau)))

        y, _ = step(method, rate, Column((*q, *v)), h[0], (), StateSpace(robot))
        return y

    return Term(f"dynamics_step_{method.name}", (Q, V, TAU, H), compute, lambda r, **_: (r.nq + r.nv,))


def _variational(robot: Robot, q: Any, p: Any, v: Any, tau: Any, h: Any, sweeps: int) -> Any:
    """Fixed-point sweeps of the discrete Euler-Lagrange equations; see `simulate`."""
    for _ in range(sweeps):
        before = v
        middle = Column(q) + Column(v) * (h[0] / 2)
        C, g = coriolis(robot, middle, v), gravity(robot, middle)
        force = Column(tau[k] - g[k] + _dot([row[k] for row in C], v) for k in range(robot.nv))
        momentum = Column(p) + force * (h[0] / 2)
        v = solve_inertia(crba(robot, middle), list(momentum))
    return [*v, *force, *before]


VARIATIONAL_SWEEP = Term(
    "variational_sweep", (Q, velocity("p"), V, TAU, H), _variational, lambda r, **_: (3 * r.nv,), (SWEEPS,)
)
"""The midpoint velocity after some sweeps, the generalised force, and the velocity one sweep before."""
