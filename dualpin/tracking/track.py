"""Follow a trajectory by integrating joint rates, in open or closed loop."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import choice
from ..call.arguments import as_array, check_robot
from ..errors import ArgumentError, DualpinWarning, ShapeError
from ..functions import fk
from ..integrators.methods import Mechanical, Method
from ..integrators.solve import STARTUPS, Cost, check_multistep, run_steps, step_count
from ..integrators.tableaus import method_named
from ..model.robot import Frame, Robot
from ..terms import configuration
from .loop import Loop, whole_steps
from .nullspace import objective_named
from .reach import reach
from .trajectories import Callback, Circle, Trajectory, as_trajectory

FEEDBACKS = ("stage", "held")
LOOKS = 400  # instants at which reach is checked before a run, and the Jacobian's condition after it
NEAR_SINGULAR = 1e-3  # ratio of singular values: an error of a millimetre a second becomes radians


@dataclass(frozen=True)
class Tracking:
    """A followed trajectory.

    Attributes
    ----------
    t : ndarray, shape (n + 1,)
        [s]
    q : ndarray, shape (..., n + 1, nq)
    position_error : ndarray, shape (..., n + 1)
        |p_d - p| [m]
    orientation_error : ndarray, shape (..., n + 1)
        |log(R_d R^T)| [rad]
    cost : Cost
        .evaluations of the joint rates (each with one pseudo-inverse), .steps, .seconds
    method : Method
    warnings : tuple of str
        Joint limits passed, singularities come near, rates above the limits.
    """

    t: np.ndarray
    q: np.ndarray
    position_error: np.ndarray
    orientation_error: np.ndarray
    cost: Cost
    method: Method
    warnings: tuple[str, ...]


def track(
    robot: Robot,
    trajectory: Trajectory | Callable[[float], Any],
    q0: ArrayLike | None = None,
    *,
    frame: str | int | Frame | None = None,
    method: str | Method = "rk4",
    dt: float = 0.01,
    t_end: float | None = None,
    gain: float = 0.0,
    feedback: str = "stage",
    startup: str = "paper",
    damping: float = 0.0,
    nullspace: str | Callable[[np.ndarray], np.ndarray] | None = None,
    nullspace_gain: float = 1.0,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    unreachable: str = "raise",
    engine: str = "auto",
) -> Tracking:
    """Follow a trajectory of a frame by differential kinematics.

        dq/dt = J^+ (V_d + K e) + (1 - J^+ J) z,   e = (log(R_d R^T), p_d - p)

    with J at the frame's origin in world axes, and J^+ = J^T (J J^T + damping^2)^-1, for damping 0
    the Moore-Penrose inverse.  gain 0 is the open loop, which drifts; with gain K the linear error
    decays as exp(-K t) as long as K dt stays below the method's stability limit.

    Parameters
    ----------
    trajectory : Circle, Line, Screw, Waypoints or callable
        A callable takes a time t and returns (pose (4, 4), twist (6,) [w; v]), v the velocity of
        the frame's origin, world axes.  Members of a batch have trajectories of their own when
        their starts differ, or when the callable returns (..., 4, 4), (..., 6).
    q0 : array_like, shape (..., nq), optional
        Start; without it, the trajectory's.
    frame : str, int or Frame, optional
        The last frame of the robot if not given.
    method : str
        One of `dualpin.integrators.METHODS`; multistep methods run as PECE, restarted from the
        corrected value.
    dt : float
        Step [s]; of adaptive methods and SciPy's, the interval between the values returned.
    t_end : float, optional
        A whole number of steps [s]; without it, once through the trajectory.
    gain : float
        K [1/s].
    feedback : "stage" or "held"
        The error enters anew at every evaluation, or as seen at the beginning of the step.
    startup : "paper" or "rk4"
        How a multistep method begins: Euler, then AB2 and AB3 with their correctors, or by RK4.
    damping : float
        Of damped least squares; in the unit of J's singular values.
    nullspace : "joint_limits", "manipulability" or callable, optional
        z, what to do with the freedom left: keep to the middle of the limits, stay away from
        singularities, or q (B, nq) -> (B, nv).
    nullspace_gain : float
        Factor on the named objectives.
    rtol, atol : float
        Of adaptive methods and SciPy's.
    unreachable : "raise", "warn" or "ignore"
        What to do about a trajectory that leaves the workspace, which is checked before the run.
    engine : "auto" or "numpy"

    Returns
    -------
    Tracking

    Raises
    ------
    ArgumentError, ShapeError, FrameNotFoundError

    References
    ----------
    Whitney (1969); Sciavicco & Siciliano (1988) for the closed loop; Nakamura & Hanafusa (1986) for
    the damping; Sariyildiz & Temeltas on the choice of the integrator.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> circle = dp.Circle(0.1, period=4.0, plane="xy", start=[0.0, -1.2, 1.4, -0.2, 1.5, 0.0])
    >>> run = dp.track(robot, circle, method="rk4", dt=0.1, t_end=4.0, gain=1.0, frame="tool0")
    >>> run.q.shape, bool(run.position_error.max() < 1e-5), run.cost.evaluations
    ((41, 6), True, 160)
    """
    check_robot(robot, "track")
    path, chosen = as_trajectory(trajectory), method_named(method)
    target = robot.frame(-1 if frame is None else frame)
    choice("track: feedback", feedback, FEEDBACKS)
    choice("track: startup", startup, STARTUPS)
    choice("track: unreachable", unreachable, ("raise", "warn", "ignore"))
    _check_numbers(gain=gain, damping=damping, nullspace_gain=nullspace_gain, rtol=rtol, atol=atol)
    held = feedback == "held"
    if isinstance(chosen, Mechanical):
        raise ArgumentError(f"track: method {chosen.name!r} is for equations of motion; dualpin.simulate takes it")
    if held and not whole_steps(chosen):
        raise ArgumentError(f"track: feedback 'held' needs equal steps, which method {chosen.name!r} does not take")
    n = step_count("track", dt, _duration(path, t_end))
    start, T0 = _start(robot, target, path, q0)
    batch = T0.shape[:-2]
    loop = Loop(robot, target, path.at(T0), batch, dt, float(gain), float(damping), held,
                objective_named(robot, target, nullspace, nullspace_gain, engine), engine)  # fmt: skip
    check_multistep("track", chosen, loop.space)
    notes = _within_reach(robot, target, loop, n * dt, unreachable)

    begun = time.perf_counter()
    values, evaluations, steps = run_steps(
        chosen, lambda t, y: loop.rate(0, t / dt, y), start, dt, n, loop.space, startup, rtol, atol,
        kernel=loop.kernel(chosen), rate=loop.rate,
    )  # fmt: skip
    cost = Cost(evaluations, steps, time.perf_counter() - begun)

    notes += _after(robot, loop, values, cost)
    position, orientation = loop.errors(values)
    shape = (*batch, n + 1)
    return Tracking(
        np.arange(n + 1) * dt,
        values.swapaxes(0, 1).reshape(*shape, robot.nq),
        position.T.reshape(shape),
        orientation.T.reshape(shape),
        cost,
        chosen,
        tuple(notes),
    )


def _check_numbers(**values: Any) -> None:
    for name, x in values.items():
        if isinstance(x, bool) or not isinstance(x, (int, float, np.integer, np.floating)) or not (0 <= x < np.inf):
            raise ArgumentError(f"track: {name} = {x!r}, a finite number of 0 or more expected")


def _duration(path: Trajectory, t_end: float | None) -> float:
    if t_end is not None:
        return t_end
    if isinstance(path, Callback):
        raise ArgumentError("track: t_end [s] expected, a function of time does not say when it ends")
    return path.duration


def _start(robot: Robot, frame: Frame, path: Trajectory, q0: ArrayLike | None) -> tuple[np.ndarray, np.ndarray]:
    """The start (B, nq), and the pose (..., 4, 4) the trajectory starts from."""
    given = path.start if q0 is None else q0
    if given is None:
        raise ArgumentError("track: q0 expected, or a trajectory with a start (Circle(..., start=q0))")
    q = as_array(robot, "track", configuration("q0"), given)
    start = configuration("q of the trajectory's start")
    origin = q if path.start is None else as_array(robot, "track", start, path.start)
    for x in (q, origin):
        if not np.isfinite(x).all():
            where = tuple(int(i) for i in np.argwhere(~np.isfinite(x))[0])
            raise ArgumentError(f"track: q0 has entries that are not finite, the first at index {where}")
    try:
        batch = np.broadcast_shapes(q.shape[:-1], origin.shape[:-1])
    except ValueError:
        raise ShapeError(f"track: q0 {q.shape} and the trajectory's start {origin.shape} do not broadcast") from None
    T0 = np.broadcast_to(fk(robot, origin, frame), (*batch, 4, 4))
    return np.ascontiguousarray(np.broadcast_to(q, (*batch, robot.nq))).reshape(-1, robot.nq), T0


def _within_reach(robot: Robot, frame: Frame, loop: Loop, t_end: float, unreachable: str) -> list[str]:
    bound = None if unreachable == "ignore" else reach(robot, frame)
    if bound is None or not loop.n:
        return []
    times = np.linspace(0.0, t_end, min(LOOKS, max(2, int(4e6 / (18 * loop.n)))))
    rows = loop.desired(times)[0].reshape(-1, 3, 4)
    excess = bound.excess(rows).reshape(len(times), loop.n)
    if not excess.any():
        return []
    k, member = np.unravel_index(int(excess.argmax()), excess.shape)
    d = float(bound.distance(rows.reshape(len(times), loop.n, 3, 4)[k, member]))
    limit = f"reach only {bound.farthest:.4g} m" if d > bound.farthest else f"keep at least {bound.nearest:.4g} m away"
    text = (
        f"the trajectory leaves the workspace of {robot.name}: at t = {times[k]:.4g} s"
        + (f" in member {member} of the batch" if loop.batch else "")
        + f" a point of frame {frame.name!r} on the axis of joint {bound.last!r} would be {d:.4g} m from the axis of "
        f"joint {bound.first!r}, where the links between {limit}"
    )
    if unreachable == "raise":
        raise ArgumentError(
            f"track: {text}; a smaller or nearer trajectory is needed (unreachable='warn' runs it anyway)"
        )
    warnings.warn(f"track: {text}", DualpinWarning, stacklevel=3)
    return [text]


def _after(robot: Robot, loop: Loop, q: np.ndarray, cost: Cost) -> list[str]:
    """What the caller should know about the motion found."""
    notes = []
    if not np.isfinite(q).all():
        k = int(np.argwhere(~np.isfinite(q).all(axis=(1, 2)))[0, 0])
        notes.append(
            f"the motion is not finite from t = {k * loop.dt:.6g} s on: the loop is unstable at this gain and step"
        )
    for joint in robot:
        if joint.mimic is None and joint.model.additive:
            x = q[..., joint.q]
            lower, upper = robot.lower[joint.q], robot.upper[joint.q]
            beyond = ((x < lower - 1e-9) | (x > upper + 1e-9)).any(axis=(1, 2))
            if beyond.any():
                at = int(beyond.argmax()) * loop.dt
                notes.append(
                    f"joint {joint.name!r} passes its limits [{lower[0]:.4g}, {upper[0]:.4g}] at t = {at:.4g} s"
                )
    looks = np.unique(np.linspace(0, len(q) - 1, max(1, min(len(q), LOOKS // max(loop.n, 1)))).astype(int))
    seen = q[looks].reshape(-1, robot.nq)
    seen = seen[np.isfinite(seen).all(axis=-1)]
    if len(seen):
        s = np.linalg.svd(loop.jacobian(seen), compute_uv=False)
        ratio = s[:, -1] / s[:, 0]
        if ratio.min() < NEAR_SINGULAR:
            notes.append(f"near a singularity: the Jacobian's singular values come as close as 1 : {ratio.min():.2g}")
    for text in notes:
        warnings.warn(f"track: {text}", DualpinWarning, stacklevel=3)
    return notes


__all__ = ["Circle", "Tracking", "track"]
