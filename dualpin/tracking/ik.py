"""Inverse kinematics: damped Gauss-Newton on the logarithm of a dual quaternion, with limits."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .. import call
from ..arguments import numbers
from ..call.arguments import as_array, check_robot
from ..errors import ArgumentError, ShapeError
from ..integrators.solve import Cost
from ..integrators.space import ConfigurationSpace
from ..model.robot import Frame, Robot
from ..spatial import from_matrix, to_matrix
from ..terms import configuration
from .rates import GAUSS_NEWTON

LONGEST = 1.0  # rad or m in one iteration: beyond, the linearisation at hand says nothing
FADING = 0.1  # of the damping, per unit of error: a tenth keeps far targets tame and near ones quadratic
STALLED = 12  # iterations without halving the error, after which a start is given up


@dataclass(frozen=True)
class Solved:
    """Configurations found for target poses.

    Attributes
    ----------
    q : ndarray, shape (..., nq)
        The best found, within the limits, also where there was no success.
    success : ndarray of bool, shape (...)
    error : ndarray, shape (..., 6)
        log of X^-1 X_d, the body twist [w; v] still missing [rad, m].
    iterations : ndarray of int, shape (...)
        Over all starts tried.
    starts : ndarray of int, shape (...)
        How many starts were tried.
    cost : Cost
    """

    q: np.ndarray
    success: np.ndarray
    error: np.ndarray
    iterations: np.ndarray
    starts: np.ndarray
    cost: Cost

    @property
    def success_rate(self) -> float:
        """Share of the targets reached."""
        return float(np.mean(self.success)) if self.success.size else 1.0


def ik(
    robot: Robot,
    target: ArrayLike,
    frame: str | int | Frame | None = None,
    *,
    q0: ArrayLike | None = None,
    tolerance: float = 1e-9,
    max_iterations: int = 100,
    restarts: int = 20,
    damping: float = 1e-3,
    limits: bool = True,
    seed: int = 0,
    engine: str = "auto",
) -> Solved:
    """Configurations that put a frame at a pose.

        e = log(x^* x_d),   dq = J^T (J J^T + mu^2 1)^-1 e,   mu = 0.1 s + damping sqrt(s),   s = min(|e|, 1)

    over dual quaternions x, with the body Jacobian J.  The damping fades with the error, so that
    the last iterations converge like Newton's.  A joint that would leave its limits stops there,
    and the others make up for it; targets not reached are tried again from random starts.

    Parameters
    ----------
    target : array_like, shape (..., 4, 4) or (..., 8)
        Homogeneous matrices or unit dual quaternions, frame -> world.
    frame : str, int or Frame, optional
        The last frame if not given.
    q0 : array_like, shape (..., nq), optional
        First guess; without it, the middle of the limits.
    tolerance : float
        On |e| in rad and m together.
    max_iterations : int
        For each start.
    restarts : int
        Random starts for targets that were not reached.
    damping : float
        In the unit of J's singular values; what keeps steps short at singularities.
    limits : bool
        Keep to the joints' limits.
    seed : int
        Of the random starts.

    Returns
    -------
    Solved

    Raises
    ------
    ArgumentError, ShapeError, FrameNotFoundError

    References
    ----------
    Wampler (1986), Nakamura & Hanafusa (1986) for damped least squares; Sugihara (2011) for a
    damping that follows the error.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> q, _, _ = robot.sample(20, seed=1)
    >>> found = dp.ik(robot, dp.fk(robot, q, "tool0"), "tool0")
    >>> found.success_rate
    1.0
    """
    check_robot(robot, "ik")
    goal = robot.frame(-1 if frame is None else frame)
    for name, x, least in (("max_iterations", max_iterations, 1), ("restarts", restarts, 0)):
        if isinstance(x, bool) or not isinstance(x, (int, np.integer)) or x < least:
            raise ArgumentError(f"ik: {name} = {x!r}, a whole number of {least} or more expected")
    for name, value in (("tolerance", tolerance), ("damping", damping)):
        if not isinstance(value, (int, float)) or not 0 < value < np.inf:
            raise ArgumentError(f"ik: {name} = {value!r}, a positive number expected")
    poses = _targets(target)
    guess = _inside(robot, robot.neutral) if q0 is None else as_array(robot, "ik", configuration("q0"), q0)
    if not np.isfinite(guess).all():
        raise ArgumentError("ik: q0 has entries that are not finite")
    try:
        batch = np.broadcast_shapes(poses.shape[:-2], guess.shape[:-1])
    except ValueError:
        raise ShapeError(f"ik: target {np.shape(target)} and q0 {guess.shape} do not broadcast") from None
    begun = time.perf_counter()
    wanted = np.ascontiguousarray(np.broadcast_to(poses[..., :3, :], (*batch, 3, 4))).reshape(-1, 12)
    n = len(wanted)
    search = _Search(robot, goal, damping, tolerance, max_iterations, limits, engine)
    start = np.ascontiguousarray(np.broadcast_to(guess, (*batch, robot.nq))).reshape(n, robot.nq)
    q, error, iterations = search.run(start, wanted)
    starts = np.ones(n, dtype=int)
    rng = np.random.default_rng(seed)
    for _ in range(restarts):
        left = np.flatnonzero(~(_size(error) <= tolerance))
        if not len(left):
            break
        fresh = robot.sample(len(left), seed=int(rng.integers(2**31)))[0]
        q_, error_, count = search.run(fresh, wanted[left])
        better = _size(error_) < _size(error[left])
        q[left[better]], error[left[better]] = q_[better], error_[better]
        iterations[left] += count
        starts[left] += 1
    cost = Cost(int(iterations.sum()), int(iterations.max(initial=0)), time.perf_counter() - begun)
    return Solved(
        q.reshape(*batch, robot.nq), (_size(error) <= tolerance).reshape(batch), error.reshape(*batch, 6),
        iterations.reshape(batch), starts.reshape(batch), cost,
    )  # fmt: skip


class _Search:
    """Damped Gauss-Newton from given starts, the whole batch at once; members that have arrived drop out."""

    def __init__(
        self, robot: Robot, frame: Frame, damping: float, tolerance: float, most: int, limits: bool, engine: str
    ) -> None:
        self.robot, self.frame, self.damping, self.tolerance = robot, frame, damping, tolerance
        self.most, self.engine, self.space = most, engine, ConfigurationSpace(robot)
        far = 0.0 if limits else np.inf
        self.lower: np.ndarray = robot.lower - far
        self.upper: np.ndarray = robot.upper + far
        # coordinates that are their own velocities: only these can be held at a limit
        pairs = [(j.q, j.v) for j in robot if j.mimic is None and j.model.additive]
        self.q_of = np.array([i for q, _ in pairs for i in range(q.start, q.stop)], dtype=int)
        self.v_of = np.array([i for _, v in pairs for i in range(v.start, v.stop)], dtype=int)

    def run(self, start: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        n = len(start)
        best, error = start.copy(), np.full((n, 6), np.inf)
        iterations = np.zeros(n, dtype=int)
        halved, since, last = np.full(n, np.inf), np.zeros(n, dtype=int), np.ones(n)
        going, q = np.arange(n), start.copy()
        free = np.ones((n, self.robot.nv))
        for _ in range(self.most + 1):
            if not len(going):
                break
            damping = FADING * np.minimum(last[going], 1.0) + self.damping * np.sqrt(np.minimum(last[going], 1.0))
            move, e = self._step(q, wanted[going], free, damping)
            last[going] = size = _size(e)
            improved = size < _size(error[going])
            best[going[improved]], error[going[improved]] = q[improved], e[improved]
            much = size < halved[going] / 2
            halved[going[much]] = size[much]
            since[going] = np.where(much, 0, since[going] + 1)
            stay = (size > self.tolerance) & (since[going] < STALLED) & np.isfinite(size)
            going, q, move, free = going[stay], q[stay], move[stay], free[stay]
            iterations[going] += 1
            longest = np.abs(move).max(axis=-1, initial=0.0)
            move = move * np.minimum(1.0, LONGEST / np.maximum(longest, LONGEST * 1e-9))[:, None]
            q, free = self._moved(q, move)
        return best, error, iterations

    def _step(
        self, q: np.ndarray, wanted: np.ndarray, free: np.ndarray, damping: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        out = call.run(
            self.robot, GAUSS_NEWTON, {"frame": self.frame}, [q, wanted, free, damping[:, None]], engine=self.engine
        )
        return out[:, : self.robot.nv], out[:, self.robot.nv :]

    def _moved(self, q: np.ndarray, move: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The next q, clipped to the limits, and 1 for each joint free to move on, 0 for those at a limit."""
        q = self.space.move(q, move)
        x = q[:, self.q_of]
        inside = np.clip(x, self.lower[self.q_of], self.upper[self.q_of])
        free = np.ones_like(move)
        free[:, self.v_of] = np.where(x == inside, 1.0, 0.0)
        q[:, self.q_of] = inside
        return q, free


def _size(error: np.ndarray) -> np.ndarray:
    return np.sqrt((error * error).sum(axis=-1))


def _inside(robot: Robot, q: np.ndarray) -> np.ndarray:
    """The middle of finite limits, the neutral coordinate elsewhere."""
    low, high = robot.lower, robot.upper
    bounded = np.isfinite(low) & np.isfinite(high)
    with np.errstate(invalid="ignore"):
        return np.where(bounded, (low + high) / 2, np.clip(q, low, high))


def _targets(target: ArrayLike) -> np.ndarray:
    x = numbers("ik: target", target)
    if x.ndim >= 2 and x.shape[-2:] == (4, 4):
        from_matrix(x)  # says what is wrong with a matrix that is no pose
        poses = x
    elif x.ndim >= 1 and x.shape[-1] == 8:
        norm = np.linalg.norm(x[..., :4], axis=-1)
        if not (np.abs(norm - 1) < 1e-6).all():
            raise ArgumentError("ik: target: unit dual quaternions expected; the norm of the real part differs from 1")
        poses = to_matrix(x)
    else:
        raise ShapeError(f"ik: target of shape (..., 4, 4) or (..., 8) expected, got {x.shape}")
    if not np.isfinite(poses).all():
        raise ArgumentError("ik: target has entries that are not finite")
    return poses
