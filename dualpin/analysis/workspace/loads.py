"""Static loads: joint torques relative to the effort limits, and the payload capacity."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import numbers, real
from ...call.arguments import check_robot
from ...errors import ArgumentError, ShapeError
from ...functions import fk, gravity, jacobian
from ...model.limits import effort_limits
from ...model.robot import Frame, Robot
from ...spatial.inertia import Inertia


def static_load(
    robot: Robot,
    q: ArrayLike,
    frame: str | int | Frame,
    payload: float | Inertia = 0.0,
    com: ArrayLike = (0.0, 0.0, 0.0),
    *,
    effort: ArrayLike | None = None,
) -> np.ndarray:
    """Torques that hold the robot and a payload at rest, over the effort limits, shape (..., nv).

        (g(q) - J_c^T m gravity) / effort         J_c of the payload's centre of mass

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    frame : str, int or Frame
        The frame that carries the payload.
    payload : float or Inertia
        Its mass [kg], or the body in the frame.
    com : array_like, shape (3,)
        Its centre of mass in the frame [m], where only a mass is given.
    effort : array_like, shape (nv,), optional
        Limits [N m, N]; by default the description's.  Joints without a limit (infinite or 0 there) have a share of 0.

    Returns
    -------
    ndarray, shape (..., nv)
        Beyond -1 to 1 the joint cannot hold it.

    Raises
    ------
    ArgumentError
        If no joint has a limit.
    FrameNotFoundError, ShapeError

    References
    ----------
    Lynch & Park (2017), 5.2, statics of open chains: tau = J^T F.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> from dualpin.analysis.workspace import static_load
    >>> static_load(dp.load("ur5"), np.zeros(6), "tool0", payload=5.0).round(3).tolist()
    [-0.0, -0.662, -0.233, -0.0, 0.0, 0.0]
    """
    check_robot(robot, "static_load")
    if isinstance(payload, Inertia):
        mass, centre = float(payload.mass), payload.central[0].array
    else:
        mass, centre = real("static_load: payload", payload, "kg", least=0), _point("static_load", com)
    return (gravity(robot, q) + mass * _unit(robot, q, frame, centre)) / _limits(robot, effort)


def payload_capacity(
    robot: Robot,
    q: ArrayLike,
    frame: str | int | Frame,
    com: ArrayLike = (0.0, 0.0, 0.0),
    *,
    effort: ArrayLike | None = None,
) -> np.ndarray:
    """The largest mass that can be held at rest, shape (...) [kg]; 0 where the arm cannot hold itself.

        |g_k + m u_k| <= effort_k for all joints k         u = -J_c^T gravity

    Motion, grippers and bearings are not considered.

    Parameters
    ----------
    robot, q, frame, com, effort
        As in `static_load`.

    Returns
    -------
    ndarray, shape (...)
        Infinite where the payload loads no joint with a limit.

    Raises
    ------
    ArgumentError
        If no joint has a limit.
    FrameNotFoundError, ShapeError

    References
    ----------
    Wang & Ravani (1988), dynamic load carrying capacity of mechanical manipulators; here at rest.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> float(dp.payload_capacity(dp.load("ur5"), np.zeros(6), "tool0").round(2))
    11.33
    """
    check_robot(robot, "payload_capacity")
    g, u = gravity(robot, q), _unit(robot, q, frame, _point("payload_capacity", com))
    limit = np.broadcast_to(_limits(robot, effort), g.shape)
    # each joint allows masses until it reaches the limit in the direction of the load
    felt = np.abs(u) > 1e-12 * (1 + np.abs(u).max(axis=-1, keepdims=True))
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(felt & np.isfinite(limit), (limit - np.sign(u) * g) / np.abs(u), np.inf)
    holds = (np.abs(g) <= limit).all(axis=-1)
    return np.where(holds, most.min(axis=-1, initial=np.inf), 0.0)


def _unit(robot: Robot, q: ArrayLike, frame: str | int | Frame, centre: np.ndarray) -> np.ndarray:
    """Torques that hold one kilogram at a point of the frame, (..., nv)."""
    at = robot.frame(frame)
    J = jacobian(robot, q, at, "local_world_aligned")
    arm = np.einsum("...ij,j->...i", fk(robot, q, at)[..., :3, :3], centre)
    # the point moves with v + w x arm
    moving = J[..., 3:, :] + np.cross(J[..., :3, :], arm[..., :, None], axisa=-2, axisb=-2, axisc=-2)
    return -np.einsum("...ij,i->...j", moving, robot.gravity.array)


def _point(what: str, com: ArrayLike) -> np.ndarray:
    x = numbers(f"{what}: com", com)
    if x.shape != (3,) or not np.isfinite(x).all():
        raise ShapeError(f"{what}: com: three finite numbers [m] expected, got {com!r}")
    return x


def _limits(robot: Robot, effort: ArrayLike | None) -> np.ndarray:
    """Effort limits, (nv,); infinite where there is none."""
    if effort is not None:
        x = numbers("effort", effort)
        if x.shape not in ((), (robot.nv,)) or not (x > 0).all():
            raise ShapeError(f"effort: ({robot.nv},) positive numbers [N m, N] expected, got {effort!r}")
        return np.broadcast_to(x, (robot.nv,))
    found = effort_limits(robot)
    if not np.isfinite(found).any():
        raise ArgumentError(f"{robot.name}: its description has no effort limits; give effort=")
    return found
