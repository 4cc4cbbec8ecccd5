"""Follow a trajectory by integrating joint rates, in open or closed loop."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import choice, real
from ..call.arguments import as_array, check_robot
from ..delegates import home
from ..errors import ArgumentError, DualpinWarning, ShapeError
from ..functions import fk
from ..integrators.methods import Mechanical, Method
from ..integrators.solve import STARTUPS, Cost, check_multistep, run_steps, step_count
from ..integrators.tableaus import method_named
from ..model.robot import Frame, Robot
from ..terms import configuration
from .loop import Loop, whole_steps
from .nullspace import objective_named
from .remarks import after, feasible, unstable
from .task import rows_of
from .trajectories import Callback, Circle, Trajectory, as_trajectory

FEEDBACKS = ("stage", "held")


@dataclass(frozen=True)
class TrackingResult:
    """A followed trajectory.

    Attributes
    ----------
    t : ndarray, shape (n + 1,)
        [s]
    q : ndarray, shape (..., n + 1, nq)
    position_error : ndarray, shape (..., n + 1)
        |p_d - p| [m]
    orientation_error : ndarray, shape (..., n + 1)
        |log(R_d R^T)| [rad]; of both only what the task asks for, so that a position has no orientation error
    cost : Cost
        .evaluations of the joint rates (each with one pseudo-inverse), .steps, .seconds
    method : Method
    warnings : tuple of str
        One a kind, each begins with its kind: "limits", "singular", "rank", "unstable", "unreachable".
    """

    t: np.ndarray
    q: np.ndarray
    position_error: np.ndarray
    orientation_error: np.ndarray
    cost: Cost
    method: Method
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        p, o = (float(np.max(x, initial=0.0)) for x in (self.position_error, self.orientation_error))
        said = f", {len(self.warnings)} warnings" if self.warnings else ""
        return f"<TrackingResult: {self.method.name}, q {self.q.shape}, errors up to {p:.3g} m, {o:.3g} rad{said}>"

    def _repr_html_(self) -> str:
        return str(home("TrackingResult._repr_html_")(self))

    def plot(self, axes: Any = None) -> Any:
        """Draw the errors over time; returns the axes.  Needs ``pip install 'dualpin[figures]'``."""
        return home("TrackingResult.plot")(self, axes)


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
    task: str | Sequence[int] = "pose",
    engine: str = "auto",
) -> TrackingResult:
    """Follow a trajectory of a frame by differential kinematics.

        dq/dt = J^+ (V_d + K e) + (1 - J^+ J) z,   e = (log(R_d R^T), p_d - p)

    with J at the frame's origin in world axes, of all three the components that the task asks for, and
    J^+ = J^T (J J^T + damping^2)^-1, for damping 0 the Moore-Penrose inverse.  gain 0 is the open loop,
    which drifts; with gain K the linear error decays as exp(-K t) as long as K dt stays below the method's
    stability limit.

    Parameters
    ----------
    robot : Robot
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
        What to do about a trajectory that leaves the workspace, or that needs more joints than carry the
        frame; both are checked before the run.
    task : "pose", "position", "position+axis", or six booleans
        What of the trajectory counts.  "position+axis": the frame's origin and the direction of its z-axis.
        Six booleans name components [wx, wy, wz, vx, vy, vz], turns about the frame's axes and ways along
        the world's.
    engine : "auto" or "numpy"

    Returns
    -------
    TrackingResult

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
    rows = rows_of("track", task)
    choice("track: feedback", feedback, FEEDBACKS)
    choice("track: startup", startup, STARTUPS)
    choice("track: unreachable", unreachable, ("raise", "warn", "ignore"))
    given = {"gain": gain, "damping": damping, "nullspace_gain": nullspace_gain, "rtol": rtol, "atol": atol}
    gain, damping, nullspace_gain, rtol, atol = (real(f"track: {k}", x, least=0) for k, x in given.items())
    held = feedback == "held"
    if isinstance(chosen, Mechanical):
        raise ArgumentError(f"track: method {chosen.name!r} is for equations of motion; dualpin.simulate takes it")
    if held and not whole_steps(chosen):
        raise ArgumentError(f"track: feedback 'held' needs equal steps, which method {chosen.name!r} does not take")
    n, dt = step_count("track", dt, _duration(path, t_end))
    start, T0 = _start(robot, target, path, q0)
    batch = T0.shape[:-2]
    loop = Loop(robot, target, path.at(T0), batch, dt, gain, damping, held,
                objective_named(robot, target, nullspace, nullspace_gain, engine), rows, engine)  # fmt: skip
    check_multistep("track", chosen, loop.space)
    notes = [*feasible(loop, start, n * dt, unreachable), *unstable(chosen, gain, dt, held)]

    begun = time.perf_counter()
    values, evaluations, steps = run_steps(
        chosen, lambda t, y: loop.rate(0, t / dt, y), start, dt, n, loop.space, startup, rtol, atol,
        kernel=loop.kernel(chosen), rate=loop.rate,
    )  # fmt: skip
    cost = Cost(evaluations, steps, time.perf_counter() - begun)

    notes += after(loop, values)
    for text in notes:
        warnings.warn(f"track: {text}", DualpinWarning, stacklevel=2)
    position, orientation = loop.errors(values)
    shape = (*batch, n + 1)
    return TrackingResult(
        np.arange(n + 1) * dt,
        values.swapaxes(0, 1).reshape(*shape, robot.nq),
        position.T.reshape(shape),
        orientation.T.reshape(shape),
        cost,
        chosen,
        tuple(notes),
    )


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
    origin = (
        q if path.start is None else as_array(robot, "track", configuration("q of the trajectory's start"), path.start)
    )
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


__all__ = ["Circle", "TrackingResult", "track"]
