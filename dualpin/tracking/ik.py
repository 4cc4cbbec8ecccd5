"""Inverse kinematics: damped Gauss-Newton on the logarithm of a dual quaternion, with limits."""

from __future__ import annotations

import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import call
from ..arguments import count, numbers, real
from ..call.arguments import as_array, check_robot
from ..delegates import home
from ..errors import ArgumentError, DualpinWarning, ShapeError
from ..integrators.solve import Cost
from ..integrators.space import ConfigurationSpace
from ..model.joints import Axial
from ..model.limits import ranges
from ..model.robot import Frame, Robot
from ..spatial import from_matrix, to_matrix
from ..terms import configuration
from .rates import GAUSS_NEWTON
from .task import Rows, chain_length, rows_of, too_few

LONGEST = 1.0  # rad, or lengths of the chain, largest step of one iteration; the linearisation is poor beyond
FADING = 0.1  # damping per unit of error: steps to far targets stay short, convergence near the target stays quadratic
STALLED = 12  # iterations without halving the error, after which a start is given up


@dataclass(frozen=True)
class IKResult:
    """Configurations found for target poses.

    Attributes
    ----------
    q : ndarray, shape (..., nq)
        The best found, within the limits, also where there was no success.  Joints that turn without limit
        are within half a turn of the start.
    success : ndarray of bool, shape (...)
    error : ndarray, shape (..., 6)
        log of X^-1 X_d, the body twist [w; v] still missing [rad, m]; for other tasks than a pose what they
        lack, [turn; way], turns about the frame's axes and ways along the world's, 0 where nothing is asked.
    iterations : ndarray of int, shape (...)
        Over all starts tried.
    starts : ndarray of int, shape (...)
        How many starts were tried.
    cost : Cost
    notes : tuple of str
        What the caller should know: a start outside the limits, a task that needs more joints.
    """

    q: np.ndarray
    success: np.ndarray
    error: np.ndarray
    iterations: np.ndarray
    starts: np.ndarray
    cost: Cost
    notes: tuple[str, ...] = ()

    @property
    def success_rate(self) -> float:
        """Share of the targets reached."""
        return float(np.mean(self.success)) if self.success.size else 1.0

    def __repr__(self) -> str:
        n = self.success.size
        return f"<IKResult: {int(self.success.sum())} of {n} reached, q {self.q.shape}>"

    def _repr_html_(self) -> str:
        return str(home("IKResult._repr_html_")(self))

    def plot(self, axes: Any = None) -> Any:
        """Draw the remaining error of each target; returns the axes.  Needs ``pip install 'dualpin[figures]'``."""
        return home("IKResult.plot")(self, axes)


def ik(
    robot: Robot,
    target: ArrayLike,
    frame: str | int | Frame | None = None,
    *,
    q0: ArrayLike | None = None,
    task: str | Sequence[int] = "pose",
    mask: Sequence[int] | None = None,
    position_only: bool = False,
    tolerance: float = 1e-9,
    max_iterations: int = 100,
    restarts: int = 20,
    damping: float = 1e-3,
    limits: bool = True,
    seed: int = 0,
    engine: str = "auto",
) -> IKResult:
    """Configurations that put a frame at a pose, or at a position.

        e = log(x^* x_d),   dq = J^T (J J^T + mu^2 1)^-1 e,   mu = 0.1 s + damping sqrt(s),   s = min(|e|, 1)

    over dual quaternions x, with the body Jacobian J, lengths in units of the chain's length.  The damping
    fades with the error, so that the last iterations converge like Newton's.  A joint that would leave its
    limits stops there, and the others make up for it; targets not reached are tried again from random starts.

    Parameters
    ----------
    robot : Robot
    target : array_like, shape (..., 4, 4) or (..., 8)
        Homogeneous matrices or unit dual quaternions, frame -> world.
    frame : str, int or Frame, optional
        The last frame if not given.
    q0 : array_like, shape (..., nq), optional
        First guess; without it, the middle of the limits.
    task : "pose", "position", "position+axis", or six booleans
        What of the target counts.  "position+axis": the frame's origin and the direction of its z-axis.  Six
        booleans name components [wx, wy, wz, vx, vy, vz], turns about the frame's axes and ways along the
        world's.
    mask : six booleans, optional
        The same as ``task=mask``.
    position_only : bool
        The same as ``task="position"``.
    tolerance : float
        On |e| in rad and m together.
    max_iterations : int
        For each start.
    restarts : int
        Random starts for targets that were not reached.
    damping : float
        In the unit of J's singular values; what keeps steps short at singularities.
    limits : bool
        Keep to the joints' limits, those of joints that follow others (mimic) included; a start outside
        is moved to the nearest limit, and a note says so.
    seed : int
        Of the random starts.
    engine : "auto", "compiled" or "numpy"
        How it is computed, see docs/engine.md.

    Returns
    -------
    IKResult

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
    >>> found = dp.ik(robot, dp.fk(robot, q, "tool0"), "tool0", task="position")
    >>> bool(np.abs(dp.fk(robot, found.q, "tool0")[:, :3, 3] - dp.fk(robot, q, "tool0")[:, :3, 3]).max() < 1e-9)
    True
    """
    check_robot(robot, "ik")
    goal = robot.frame(-1 if frame is None else frame)
    rows = rows_of("ik", task, mask, position_only)
    most = count("ik: max_iterations", max_iterations, 1)
    restarts = count("ik: restarts", restarts)
    tolerance, damping = real("ik: tolerance", tolerance, above=0), real("ik: damping", damping, above=0)
    poses = _targets(target)
    guess = _middle(robot) if q0 is None else as_array(robot, "ik", configuration("q0"), q0)
    if not np.isfinite(guess).all():
        raise ArgumentError("ik: q0 has entries that are not finite")
    try:
        batch = np.broadcast_shapes(poses.shape[:-2], guess.shape[:-1])
    except ValueError:
        raise ShapeError(f"ik: target {np.shape(target)} and q0 {guess.shape} do not broadcast") from None
    begun = time.perf_counter()
    wanted = np.ascontiguousarray(np.broadcast_to(poses[..., :3, :], (*batch, 3, 4))).reshape(-1, 12)
    n = len(wanted)
    search = _Search(robot, goal, rows, damping, tolerance, most, bool(limits), engine)
    start = np.array(np.broadcast_to(guess, (*batch, robot.nq))).reshape(n, robot.nq)
    notes = search.clip(start)
    q, error, iterations = search.run(start, wanted)
    starts = np.ones(n, dtype=int)
    rng = np.random.default_rng(count("ik: seed", seed))
    for _ in range(restarts):
        left = np.flatnonzero(~(_size(error) <= tolerance))
        if not len(left):
            break
        fresh = robot.sample(len(left), seed=int(rng.integers(2**31)))[0]
        search.clip(fresh)
        q_, error_, more = search.run(fresh, wanted[left])
        better = _size(error_) < _size(error[left])
        q[left[better]], error[left[better]] = q_[better], error_[better]
        iterations[left] += more
        starts[left] += 1
    success = _size(error) <= tolerance
    if (missed := int((~success).sum())) and (why := too_few(goal, rows)):
        notes.append(f"{why}; {missed} of {n} targets were not reached")
    for text in notes:
        warnings.warn(f"ik: {text}", DualpinWarning, stacklevel=2)
    search.unwind(q, start)
    cost = Cost(int(iterations.sum()), int(iterations.max(initial=0)), time.perf_counter() - begun)
    return IKResult(
        q.reshape(*batch, robot.nq), success.reshape(batch), error.reshape(*batch, 6),
        iterations.reshape(batch), starts.reshape(batch), cost, tuple(notes),
    )  # fmt: skip


class _Search:
    """Damped Gauss-Newton from given starts, the whole batch at once; members that have arrived drop out."""

    def __init__(
        self, robot: Robot, frame: Frame, rows: Rows, damping: float, tolerance: float, most: int, limits: bool,
        engine: str,
    ) -> None:  # fmt: skip
        self.robot, self.damping, self.tolerance = robot, damping, tolerance
        self.most, self.engine, self.space = most, engine, ConfigurationSpace(robot)
        self.length = chain_length(robot, frame)
        self.options = {"frame": frame, "rows": rows, "length": self.length}
        # what can be clipped, and the velocity that is held at a limit: that of coordinates that are their own
        pairs = [(i, j.v.start + k if j.model.additive else -1) for j in robot if j.mimic is None
                 for k, (i, what) in enumerate(zip(range(j.q.start, j.q.stop), j.model.coordinates, strict=True))
                 if what != "quaternion"]  # fmt: skip
        self.q_of = np.array([i for i, _ in pairs], dtype=int)
        self.holds = np.array([k >= 0 for _, k in pairs], dtype=bool)
        self.v_of = np.array([k for _, k in pairs if k >= 0], dtype=int)
        self.unit = np.ones(robot.nv)  # of the displacements: 1 rad, or the chain's length
        for j in robot:
            self.unit[j.v] = [1.0 if any(x != 0 for x in s.real) else self.length for s in j.model.screws]
        crossed = robot.lower > robot.upper  # bound nothing
        self.lower = np.where(crossed | (not limits), -np.inf, robot.lower)[self.q_of]
        self.upper = np.where(crossed | (not limits), np.inf, robot.upper)[self.q_of]

    def clip(self, q: np.ndarray) -> list[str]:
        """Move starts to the limits in place, and say which joints were outside."""
        x = q[:, self.q_of]
        inside = np.clip(x, self.lower, self.upper)
        out = self.q_of[(x != inside).any(axis=0)]
        q[:, self.q_of] = inside
        names = [j.name for j in self.robot if j.mimic is None and any(j.q.start <= i < j.q.stop for i in out)]
        return [f"q0 is outside the limits of {', '.join(names)} and was moved to them"] if names else []

    def unwind(self, q: np.ndarray, start: np.ndarray) -> None:
        """Whole turns taken off in place, from angles without limit: to within half a turn of the start."""
        for i in endless(self.robot):
            q[:, i] -= 2 * np.pi * np.round((q[:, i] - start[:, i]) / (2 * np.pi))

    def run(self, start: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        n = len(start)
        best, error = start.copy(), np.full((n, 6), np.inf)
        iterations = np.zeros(n, dtype=int)
        halved, since, last = np.full(n, np.inf), np.zeros(n, dtype=int), np.ones(n)
        going, q = np.arange(n), start.copy()
        free = np.ones((n, self.robot.nv))
        scale = np.array([1.0] * 3 + [1 / self.length] * 3)
        for _ in range(self.most + 1):
            if not len(going):
                break
            damping = FADING * np.minimum(last[going], 1.0) + self.damping * np.sqrt(np.minimum(last[going], 1.0))
            move, e = self._step(q, wanted[going], free * self.unit, damping)
            last[going], size = _size(e * scale), _size(e)
            improved = size < _size(error[going])
            best[going[improved]], error[going[improved]] = q[improved], e[improved]
            much = size < halved[going] / 2
            halved[going[much]] = size[much]
            since[going] = np.where(much, 0, since[going] + 1)
            stay = (size > self.tolerance) & (since[going] < STALLED) & np.isfinite(size)
            going, q, move, free = going[stay], q[stay], move[stay], free[stay]
            iterations[going] += 1
            longest = np.abs(move / self.unit).max(axis=-1, initial=0.0)
            move = move * np.minimum(1.0, LONGEST / np.maximum(longest, LONGEST * 1e-9))[:, None]
            q, free = self._moved(q, move)
        return best, error, iterations

    def _step(
        self, q: np.ndarray, wanted: np.ndarray, weights: np.ndarray, damping: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        inputs = [q, wanted, weights, damping[:, None]]
        out = call.run(self.robot, GAUSS_NEWTON, self.options, inputs, engine=self.engine)
        return out[:, : self.robot.nv], out[:, self.robot.nv :]

    def _moved(self, q: np.ndarray, move: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The next q, clipped to the limits, and 1 for each joint free to move on, 0 for those at a limit."""
        q = self.space.move(q, move)
        x = q[:, self.q_of]
        inside = np.clip(x, self.lower, self.upper)
        free = np.ones_like(move)
        free[:, self.v_of] = np.where(x == inside, 1.0, 0.0)[:, self.holds]
        q[:, self.q_of] = inside
        return q, free


def endless(robot: Robot) -> list[int]:
    """Coordinates that a whole turn does not change: angles without limit that move nothing along their axis."""
    found = []
    for j in robot:
        if j.mimic is None and isinstance(j.model, Axial):
            pure = [u.real == 1 and u.dual == 0 for u in j.model.units]
            found += [i for i, p in zip(range(j.q.start, j.q.stop), pure, strict=True) if p]
    led = {i for j in robot if j.mimic is not None for i in range(j.q.start, j.q.stop)}
    return [i for i in found if i not in led and np.isinf(robot.lower[i]) and np.isinf(robot.upper[i])]


def _size(error: np.ndarray) -> np.ndarray:
    return np.sqrt((error * error).sum(axis=-1))


def _middle(robot: Robot) -> np.ndarray:
    """The middle of the limits, huge ones counting as none; the neutral orientation of a floating base."""
    lower, upper = ranges(robot)
    x = robot.neutral.copy()
    for j in robot:
        if j.mimic is None:
            for i, what in enumerate(j.model.coordinates, j.q.start):
                x[i] = x[i] if what == "quaternion" else (lower[i] + upper[i]) / 2
    return x


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
