"""The loop around the integrator: trajectory, Jacobian, feedback, one kernel call a step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .. import call
from ..integrators.methods import Method, Reference, RungeKutta
from ..integrators.space import ConfigurationSpace
from ..integrators.step import Past
from ..model.robot import Frame, Robot
from ..terms import Term
from .rates import AIM, ERROR, RATE, tracking_step
from .task import Rows
from .trajectories import Bound

Objective = Callable[[np.ndarray], np.ndarray]
SINGULAR = 1e16
"""Loss above which elimination keeps fewer than eight digits: then the singular value decomposition decides."""
BLOCK = 400_000  # numbers sampled from the trajectory at a time: 3 MB, so that they stay in the cache


class Loop:
    """The terms that one run of `track` evaluates, over a batch q (B, nq)."""

    def __init__(
        self, robot: Robot, frame: Frame, motion: Bound, batch: tuple[int, ...], dt: float, gain: float, damping: float,
        held: bool, objective: Objective | None, rows: Rows, engine: str,
    ) -> None:  # fmt: skip
        self.robot, self.frame, self.motion, self.batch, self.dt = robot, frame, motion, batch, dt
        self.gain, self.damping, self.held, self.objective, self.engine = gain, damping, held, objective, engine
        self.n, self.rows = int(np.prod(batch, dtype=int)), rows
        self.space = ConfigurationSpace(robot)
        self._kept: tuple[int, np.ndarray] | None = None
        self._block: tuple[range, np.ndarray, np.ndarray] | None = None

    # samples of the trajectory

    def desired(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """[R p] (len(t), B, 12) and twists (len(t), B, 6)."""
        pose, twist = self.motion(t)
        n = len(t)
        return pose[..., :3, :].reshape(n, self.n, 12), twist.reshape(n, self.n, 6)

    def _samples(self, k: int, nodes: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Poses (B, nodes * 12) and twists (B, nodes * 6) of the step k, sampled many steps at a time."""
        if self._block is None or k not in self._block[0]:
            m = len(nodes)
            steps = range(k, k + max(1, min(1000, BLOCK // (18 * m * max(self.n, 1)))))
            times = ((np.array(steps)[:, None] + np.array(nodes)) * self.dt).ravel()
            pose, twist = self.desired(times)
            poses, twists = (
                np.ascontiguousarray(x.reshape(len(steps), m, self.n, x.shape[-1]).swapaxes(1, 2)).reshape(
                    len(steps), self.n, m * x.shape[-1]
                )
                for x in (pose, twist)
            )
            self._block = steps, poses, twists
        steps, poses, twists = self._block
        return poses[k - steps.start], twists[k - steps.start]

    # evaluations

    def run(self, term: Term, inputs: list[np.ndarray], **options: Any) -> np.ndarray:
        """A term on the arrays (B, size)."""
        return call.run(
            self.robot, term, {"frame": self.frame, "rows": self.rows, **options}, inputs, engine=self.engine
        )

    def _one(self, x: float, n: int) -> np.ndarray:
        return np.full((n, 1), x)

    def rate(self, k: int, c: float, q: np.ndarray, rows: Any = slice(None)) -> np.ndarray:
        """Joint rates at the time (k + c) dt; with held feedback, the error seen first in the step k."""
        at = self.desired(np.array([(k + c) * self.dt]))
        pose, twist = (np.ascontiguousarray(x[0][rows]) for x in at)
        if self.held and (self._kept is None or self._kept[0] != k or c == 0):
            self._kept = k, self.run(ERROR, [q, pose])
        error = self._kept[1] if self.held and self._kept else np.zeros((len(q), 6))
        drift = np.zeros((len(q), self.robot.nv)) if self.objective is None else self.objective(q)
        inputs = [q, pose, twist, error, np.ascontiguousarray(drift), self._one(self.gain, len(q))]
        out = self.run(RATE, [*inputs, self._one(self.damping, len(q))], held=self.held, damped=self.damping > 0)
        rate, bad = out[:, :-1], ~(out[:, -1] < SINGULAR)
        if bad.any():
            rate = rate.copy()
            rate[bad] = self._by_singular_values(*(x[bad] for x in inputs))
        return rate

    def _by_singular_values(self, *inputs: np.ndarray) -> np.ndarray:
        """z + J^+ aim by the singular value decomposition, used where elimination loses too many digits."""
        drift, m = inputs[4], len(self.rows)
        out = self.run(AIM, list(inputs), held=self.held)
        aim, J = out[:, :m], out[:, m:].reshape(len(out), -1, m).swapaxes(-1, -2)
        U, s, Vh = np.linalg.svd(J, full_matrices=False)
        cut = 1e-13 * s[:, :1]  # singular values below rounding of the largest are zero
        with np.errstate(divide="ignore", invalid="ignore"):
            gains = np.where(s > cut, s / (s * s + self.damping**2), 0.0)
        return drift + np.einsum("bki,bk->bi", Vh, gains * np.einsum("bik,bi->bk", U, aim))

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Of the task, (B, len(rows), nv)."""
        return task_jacobian(self.robot, self.frame, self.rows, q, self.engine)

    # whole steps

    def kernel(self, method: Method) -> Callable[[int, np.ndarray, Past], tuple[np.ndarray, Past] | None] | None:
        """A whole step as one term, unless something in it is not a formula."""
        if self.objective is not None or isinstance(method, Reference) or getattr(method, "adaptive", False):
            return None
        depth, nq = method.depth, self.robot.nq
        term, nodes, options = tracking_step(method, self.held, depth), method.nodes, {"damped": self.damping > 0}
        constants = [self._one(x, self.n) for x in (self.gain, self.damping, self.dt)]

        def advance(k: int, q: np.ndarray, past: Past) -> tuple[np.ndarray, Past] | None:
            inputs = [q, *self._samples(k, nodes), *constants]
            if depth:
                inputs.append(past[0] if depth == 1 else np.concatenate(past, axis=1))
            out = self.run(term, inputs, **options)
            y, latest = out[:, :nq], out[:, nq:-1]
            bad = ~(out[:, -1] < SINGULAR)
            if bad.any():
                y, latest = self._again(method, k, q, past, out, bad)
            return y, (latest, *past)[:depth]

        return advance

    def _again(
        self, method: Method, k: int, q: np.ndarray, past: Past, out: np.ndarray, bad: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The step of the members near a singularity once more, by exact rates."""
        from ..integrators.step import step

        nodes, out, self._kept = method.nodes, out.copy(), None
        y, after = step(
            method,
            lambda i, x: self.rate(k, nodes[i], x, bad),
            q[bad],
            self.dt,
            tuple(f[bad] for f in past),
            self.space,
        )
        nq = self.robot.nq
        out[bad, :nq] = y
        if method.depth:
            out[bad, nq:-1] = after[0]
        self._kept = None
        return out[:, :nq], out[:, nq:-1]

    # after the run

    def errors(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The task error in length [m] and angle [rad], for q (n + 1, B, nq)."""
        n = len(q)
        position, orientation = np.empty((n, self.n)), np.empty((n, self.n))
        at_once = max(1, BLOCK // (12 * max(self.n, 1)))
        for k in range(0, n, at_once):
            part = q[k : k + at_once]
            pose, _ = self.desired(np.arange(k, k + len(part)) * self.dt)
            e = self.run(ERROR, [np.ascontiguousarray(part).reshape(-1, self.robot.nq), pose.reshape(-1, 12)])
            e = e.reshape(len(part), self.n, 6)
            orientation[k : k + at_once], position[k : k + at_once] = (
                np.linalg.norm(x, axis=-1) for x in np.split(e, 2, -1)
            )
        return position, orientation


def task_jacobian(robot: Robot, frame: Frame, rows: Rows, q: np.ndarray, engine: str = "auto") -> np.ndarray:
    """The rows of the Jacobian that a task asks for, (B, len(rows), nv), for q (B, nq)."""
    zeros = [np.zeros((len(q), x.size(robot))) for x in AIM.arguments[1:]]
    inputs, options = [np.ascontiguousarray(q), *zeros], {"frame": frame, "rows": rows, "held": True}
    out = call.run(robot, AIM, options, inputs, engine=engine)[:, len(rows) :]
    return out.reshape(len(q), -1, len(rows)).swapaxes(-1, -2)


def whole_steps(method: Method) -> bool:
    """Whether the method takes equal steps."""
    return not isinstance(method, Reference) and not (isinstance(method, RungeKutta) and method.adaptive)
