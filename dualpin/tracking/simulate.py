"""Forward dynamics over time: by any method, on the group, with energy and momentum recorded."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import call
from ..arguments import count, real
from ..call.arguments import as_array, check_robot
from ..delegates import home
from ..errors import ArgumentError, DualpinWarning, ShapeError
from ..functions import aba, centroidal_momentum_matrix, crba, kinetic_energy, minv, potential_energy
from ..integrators.methods import Mechanical, Method
from ..integrators.solve import Cost, Kernel, check_multistep, run_steps, step_count
from ..integrators.space import StateSpace
from ..integrators.tableaus import method_named
from ..model.robot import Robot
from ..terms import TAU, Q, V
from .loop import whole_steps
from .losses import Losses, check_inertia, file_losses
from .rates import dynamics_step, variational_sweep

Controller = Callable[[float, np.ndarray, np.ndarray], np.ndarray]
SWEEPS = 60  # at most, for the implicit equations: contraction is proportional to dt, so a few suffice
CONVERGED = 2e-15  # relative change of the velocity at which a further sweep changes rounding only


@dataclass(frozen=True)
class SimulationResult:
    """A simulated motion.

    Attributes
    ----------
    t : ndarray, shape (n + 1,)
        [s]
    q, v : ndarray, shapes (..., n + 1, nq), (..., n + 1, nv)
    energy : ndarray, shape (..., n + 1)
        Kinetic and potential [J]; constant for passive motion.
    momentum : ndarray, shape (..., n + 1, 6)
        [l; p] about the centre of mass, world axes [N m s, N s]; constant for a free-floating
        robot without gravity, whatever the joints do.
    energy_drift, momentum_drift : float
        The largest departure from the start; infinite where the motion is not finite.
    energy_loss : ndarray, shape (..., n + 1)
        Energy dissipated by damping and friction since the start [J], by the trapezoidal rule over the values kept; of
        passive motion energy + energy_loss is constant.
    cost : Cost
    method : Method
    notes : tuple of str
        Where damping and friction come from; where the motion ceases to be finite.
    """

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    energy: np.ndarray
    momentum: np.ndarray
    cost: Cost
    method: Method
    energy_loss: np.ndarray
    notes: tuple[str, ...] = ()

    @property
    def energy_drift(self) -> float:
        return _largest(self.energy - self.energy[..., :1])

    @property
    def momentum_drift(self) -> float:
        return _largest(self.momentum - self.momentum[..., :1, :])

    def __repr__(self) -> str:
        said = f", {len(self.notes)} notes" if self.notes else ""
        return (
            f"<SimulationResult: {self.method.name}, {len(self.t)} values to t = {self.t[-1]:.6g} s, q {self.q.shape}, "
            f"energy drift {self.energy_drift:.3g} J{said}>"
        )

    def _repr_html_(self) -> str:
        return str(home("SimulationResult._repr_html_")(self))

    def plot(self, axes: Any = None) -> Any:
        """Draw the coordinates and the energy over time, on two axes, which are returned (extra `figures`)."""
        return home("SimulationResult.plot")(self, axes)


def _largest(x: np.ndarray) -> float:
    return float(np.abs(x).max(initial=0.0)) if np.isfinite(x).all() else float("inf")


def simulate(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike | Controller | None = None,
    *,
    method: str | Method = "rk4",
    dt: float = 1e-3,
    t_end: float = 1.0,
    hold: bool = False,
    passive: Sequence[str] = (),
    every: int = 1,
    dissipation: str | None = None,
    rtol: float = 1e-9,
    atol: float = 1e-12,
    engine: str = "auto",
) -> SimulationResult:
    """Let a robot move under joint torques and gravity.

        dv/dt = M^-1 (tau - C v - g),   dq/dt = q v   (on the group where a base floats)

    Parameters
    ----------
    robot : Robot
    q : array_like, shape (..., nq)
    v : array_like, shape (..., nv)
        The start; leading axes are a batch.
    tau : array_like (..., nv), or callable, optional
        Constant torques, or a controller (t, q, v) -> tau over the batch; none without it.
    method : str
        Runge-Kutta methods work on the group by themselves.  "variational" is symplectic, implicit
        and of second order, for robots without a floating or planar base: its energy error stays
        bounded.  "semi_implicit_euler" is symplectic only where the inertia does not depend on the
        configuration; of an arm it loses or gains energy like any method of first order.
    dt, t_end : float
        Step and duration [s].
    hold : bool
        Sample a controller once a step (as a computer does) rather than at every evaluation.
    passive : sequence of str
        Joints that get no torque, whatever tau says: they swing.  Those that the robot itself calls
        passive (see `Robot.attach`) need not be named.
    every : int
        Keep every so many-th step only.
    dissipation : "file" or None
        "file": every joint is slowed by the damping and the dry friction of its description,
        d v + f v / sqrt(v^2 + (1e-3/s)^2); the result's notes say of which joints.  None: no losses.
    rtol, atol : float
        Of adaptive methods and SciPy's.
    engine : "auto", "compiled" or "numpy"
        How it is computed, see docs/engine.md.

    Returns
    -------
    SimulationResult

    Raises
    ------
    ArgumentError
        Also where the mass matrix is singular: the message names the joint that moves no mass.
    ShapeError, FrameNotFoundError

    Warns
    -----
    DualpinWarning
        Where the motion ceases to be finite.

    Notes
    -----
    The variational method extremises the action sum of h L(q + h v / 2, v).  With the momentum p
    and dL/dq = C^T v - g, which holds for the Christoffel C,

        p_k = M v - h/2 F,   p_{k+1} = M v + h/2 F,   q_{k+1} = q_k + h v,   F = C^T v - g + tau

    with M, C, g in the middle of the step.

    References
    ----------
    Featherstone (2008), 7.3; Munthe-Kaas (1998); Marsden & West (2001), 2.6.1.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> run = dp.simulate(robot, np.zeros(6), np.zeros(6), dt=1e-2, t_end=0.2)
    >>> run.q.shape, bool(run.energy_drift < 1e-3)
    ((21, 6), True)
    """
    check_robot(robot, "simulate")
    chosen = method_named(method)
    n, dt = step_count("simulate", dt, t_end)
    every = count("simulate: every", every, 1)
    if n % every:
        raise ArgumentError(f"simulate: every = {every!r}, a whole number that divides the {n} steps expected")
    q_, v_ = as_array(robot, "simulate", Q, q), as_array(robot, "simulate", V, v)
    for name, x in (("q", q_), ("v", v_)):
        if not np.isfinite(x).all():
            raise ArgumentError(f"simulate: {name} has entries that are not finite")
    constant = None if callable(tau) else np.zeros(robot.nv) if tau is None else as_array(robot, "simulate", TAU, tau)
    try:
        shapes = [q_.shape[:-1], v_.shape[:-1]] + ([] if constant is None else [constant.shape[:-1]])
        batch = np.broadcast_shapes(*shapes)
    except ValueError:
        raise ShapeError(f"simulate: the leading axes of q {q_.shape}, v {v_.shape} and tau do not broadcast") from None
    rtol, atol = real("simulate: rtol", rtol, least=0), real("simulate: atol", atol, least=0)
    if dissipation not in (None, "file"):
        raise ArgumentError(f"simulate: dissipation = {dissipation!r}, 'file' or None expected")
    losses = file_losses(robot) if dissipation else None
    run = _Run(robot, batch, constant if constant is not None else tau, dt, hold, passive, losses, engine)
    start = np.concatenate([run.flat(q_), run.flat(v_)], axis=-1)
    check_multistep("simulate", chosen, run.space)
    check_inertia("simulate", robot, start[:, : robot.nq], engine)
    begun = time.perf_counter()
    if isinstance(chosen, Mechanical):
        values, evaluations, steps = _MECHANICAL[chosen.name](run, start, n, every)
    else:
        if hold and not whole_steps(chosen):
            raise ArgumentError(f"simulate: hold needs equal steps, which method {chosen.name!r} does not take")
        values, evaluations, steps = _in_pieces(run, chosen, start, n, every, rtol, atol)
    cost = Cost(evaluations, steps, time.perf_counter() - begun)
    y = values.swapaxes(0, 1).reshape(*batch, len(values), -1)
    found_q, found_v = np.ascontiguousarray(y[..., : robot.nq]), np.ascontiguousarray(y[..., robot.nq :])
    notes = [*(losses.notes if losses else ()), *_finite(robot, values, dt * every, engine)]
    t = np.arange(len(values)) * (dt * every)
    with np.errstate(all="ignore"):  # what is not finite was said above
        energy = kinetic_energy(robot, found_q, found_v, engine=engine) + potential_energy(
            robot, found_q, engine=engine
        )
        momentum = np.zeros((*energy.shape, 6))  # of a robot that is all armature there is none
        if robot.mass:
            A = centroidal_momentum_matrix(robot, found_q, engine=engine)
            momentum = np.einsum("...ij,...j->...i", A, found_v)
        lost = losses.energy(t, found_v) if losses else np.zeros_like(energy)
    return SimulationResult(t, found_q, found_v, energy, momentum, cost, chosen, lost, tuple(notes))


def _finite(robot: Robot, values: np.ndarray, dt: float, engine: str) -> list[str]:
    """Why a motion (n + 1, B, nq + nv) is not finite: a joint that moves no mass, which is an error, or the step."""
    bad = ~np.isfinite(values).all(axis=-1)
    if not bad.any():
        return []
    k = int(np.argmax(bad.any(axis=1)))
    before = values[k - 1][bad[k] & ~bad[k - 1]] if k else values[0]
    check_inertia(f"simulate: at t = {(k - 1) * dt:.6g} s", robot, before[:, : robot.nq], engine)
    text = f"not finite: the motion is not finite from t = {k * dt:.6g} s on; a smaller dt is needed"
    warnings.warn(f"simulate: {text}", DualpinWarning, stacklevel=3)
    return [text]


class _Run:
    """The equations of motion over a flat batch (B, nq + nv)."""

    def __init__(
        self, robot: Robot, batch: tuple[int, ...], tau: Any, dt: float, hold: bool, passive: Sequence[str],
        losses: Losses | None, engine: str,
    ) -> None:  # fmt: skip
        self.robot, self.batch, self.dt, self.hold, self.engine = robot, batch, dt, hold, engine
        self.losses = losses
        self.n, self.space = int(np.prod(batch, dtype=int)), StateSpace(robot)
        self.active = np.ones(robot.nv)
        for name in (*passive, *(j.name for j in robot if j.passive)):
            self.active[robot.joint(name).v] = 0.0
        self.controller: Controller | None = tau if callable(tau) else None
        self.constant = None if callable(tau) else self.flat(tau) * self.active
        self._held: tuple[int, np.ndarray] | None = None

    def flat(self, x: np.ndarray) -> np.ndarray:
        return np.ascontiguousarray(np.broadcast_to(x, (*self.batch, x.shape[-1]))).reshape(self.n, -1)

    def torque(self, t: float, y: np.ndarray) -> np.ndarray:
        if self.constant is not None:
            return self.constant
        assert self.controller is not None
        nq, nv = self.robot.nq, self.robot.nv
        z = y.reshape(*self.batch, -1)
        tau = np.asarray(self.controller(t, z[..., :nq], z[..., nq:]), dtype=float)
        if tau.shape not in ((*self.batch, nv), (nv,)):
            raise ShapeError(
                f"simulate: controller({t:g}, q, v) of shape {(*self.batch, nv)} expected, got {tau.shape}"
            )
        return self.flat(tau) * self.active

    def rate(self, k: int, c: float, y: np.ndarray) -> np.ndarray:
        """(v, dv/dt) at the time (k + c) dt."""
        if self.hold:
            if self._held is None or self._held[0] != k:
                self._held = k, self.torque(k * self.dt, y)
            tau = self._held[1]
        else:
            tau = self.torque((k + c) * self.dt, y)
        q, v = y[:, : self.robot.nq], y[:, self.robot.nq :]
        tau = tau - self.losses.torque(v) if self.losses else tau
        return np.concatenate([v, aba(self.robot, q, v, tau, engine=self.engine)], axis=-1)

    def loss_inputs(self) -> list[np.ndarray]:
        """Damping and friction as the terms take them."""
        both = (self.losses.viscous, self.losses.dry) if self.losses else ()
        return [np.tile(x, (self.n, 1)) for x in both]

    def kernel(self, method: Method) -> Kernel | None:
        """A whole step as one term, where the torque stays the same during it."""
        if method.depth or not whole_steps(method) or not (self.hold or self.constant is not None):
            return None
        term, nq = dynamics_step(method, self.losses is not None), self.robot.nq
        constants = [np.full((self.n, 1), self.dt), *self.loss_inputs()]

        def advance(k: int, y: np.ndarray, past: tuple[np.ndarray, ...]) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
            tau = self.torque(k * self.dt, y)
            q, v = np.ascontiguousarray(y[:, :nq]), np.ascontiguousarray(y[:, nq:])
            return call.run(self.robot, term, {}, [q, v, tau, *constants], engine=self.engine), ()

        return advance


def _in_pieces(
    run: _Run, method: Method, start: np.ndarray, n: int, every: int, rtol: float, atol: float
) -> tuple[np.ndarray, int, int]:
    """All steps, keeping every so many-th; in pieces only where that saves memory and forgets no past."""
    dt = run.dt
    kernel = run.kernel(method)

    def go(y: np.ndarray, first: int, count: int) -> tuple[np.ndarray, int, int]:
        shifted: Kernel | None = None if kernel is None else lambda k, x, past: kernel(first + k, x, past)
        return run_steps(
            method, lambda t, x: run.rate(first, t / dt, x), y, dt, count, run.space, "rk4", rtol, atol,
            kernel=shifted, rate=lambda k, c, x: run.rate(first + k, c, x),
        )  # fmt: skip

    if every == 1 or method.depth or not whole_steps(method):
        values, evaluations, steps = go(start, 0, n)
        return values[::every], evaluations, steps
    piece = every * max(1, 10_000 // every)
    kept, evaluations, y = [start[None]], 0, start
    for first in range(0, n, piece):
        values, more, _ = go(y, first, min(piece, n - first))
        kept.append(values[every::every].copy())
        y, evaluations = values[-1], evaluations + more
    return np.concatenate(kept), evaluations, n


def _semi_implicit(run: _Run, start: np.ndarray, n: int, every: int) -> tuple[np.ndarray, int, int]:
    """v' = v + h a(q, v),  q' = q exp(h v')."""
    nq, nv, dt, y = run.robot.nq, run.robot.nv, run.dt, start
    out = np.empty((n // every + 1, *start.shape))
    out[0] = start
    for k in range(n):
        v = y[:, nq:] + dt * run.rate(k, 0.0, y)[:, nv:]
        moved = run.space.move(y, np.concatenate([dt * v, np.zeros_like(v)], axis=-1))
        y = np.concatenate([moved[:, :nq], v], axis=-1)
        if (k + 1) % every == 0:
            out[(k + 1) // every] = y
    return out, n, n


def _variational(run: _Run, start: np.ndarray, n: int, every: int) -> tuple[np.ndarray, int, int]:
    """Sweep the discrete Euler-Lagrange equations of each step until the velocity stands still."""
    robot, dt = run.robot, run.dt
    nq = robot.nq
    if not run.space.additive:
        raise ArgumentError(
            "simulate: method 'variational' needs coordinates that add, not a floating or planar base; "
            "did you mean 'rkmk4'?"
        )
    sweeps, nv = 10 if robot.nv <= 3 else 2, robot.nv
    term, constants = variational_sweep(run.losses is not None), [np.full((run.n, 1), dt), *run.loss_inputs()]
    q, v = start[:, :nq].copy(), start[:, nq:].copy()
    p = np.einsum("bij,bj->bi", crba(robot, q, engine=run.engine), v)
    qs, ps = np.empty((n // every + 1, *q.shape)), np.empty((n // every + 1, *p.shape))
    qs[0], ps[0], evaluations = q, p, 0
    before = v
    for k in range(n):
        tau = run.torque((k + 0.5) * dt, np.concatenate([q, v], axis=-1))
        v, before = 2 * v - before, v  # the first guess: the last two velocities, continued
        for _ in range(SWEEPS):
            out = call.run(robot, term, {"sweeps": sweeps}, [q, p, v, tau, *constants], engine=run.engine)
            v, force, last = out[:, :nv], out[:, nv : 2 * nv], out[:, 2 * nv :]
            change = np.abs(v - last).max(initial=0.0)
            evaluations += sweeps
            if not change > CONVERGED * (1 + np.abs(v).max(initial=0.0)):
                break
        else:
            if change > 1e-10 * (1 + np.abs(v).max(initial=0.0)):
                raise ArgumentError(
                    f"simulate: the implicit step at t = {k * dt:.6g} s does not converge; a smaller dt is needed"
                )
        q, p = q + dt * v, p + dt * force
        if (k + 1) % every == 0:
            qs[(k + 1) // every], ps[(k + 1) // every] = q, p
    inverse = minv(robot, qs, engine=run.engine)
    return np.concatenate([qs, np.einsum("...ij,...j->...i", inverse, ps)], axis=-1), evaluations, n


_MECHANICAL = {"semi_implicit_euler": _semi_implicit, "variational": _variational}
