"""Initial value problems by any method: fixed steps, adaptive steps with dense output, SciPy."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import choice, numbers, real
from ..errors import ArgumentError, ShapeError
from .adaptive import adaptive_steps
from .methods import Mechanical, Method, PredictorCorrector, Reference, RungeKutta
from .scipy_reference import scipy_steps
from .space import Space
from .step import Past, step
from .tableaus import RK4, method_named

TimeRate = Callable[[float, np.ndarray], np.ndarray]
Kernel = Callable[[int, np.ndarray, Past], "tuple[np.ndarray, Past] | None"]
STARTUPS = ("paper", "rk4")


@dataclass(frozen=True)
class Cost:
    """Cost of a run: evaluations of the rate, steps taken, seconds of wall time."""

    evaluations: int
    steps: int
    seconds: float


@dataclass(frozen=True)
class Solution:
    """Values at times: t (n,), y (..., n, size), and what they cost."""

    t: np.ndarray
    y: np.ndarray
    cost: Cost


def step_count(what: str, dt: float, t_end: float) -> tuple[int, float]:
    """How many steps dt make t_end, and dt, or an error: dt must be positive and divide t_end."""
    dt, t_end = real(f"{what}: dt", dt, "s"), real(f"{what}: t_end", t_end, "s")
    if dt <= 0:
        raise ArgumentError(f"{what}: dt = {dt} s, a positive step expected")
    if t_end < 0:
        raise ArgumentError(f"{what}: t_end = {t_end} s, a duration of 0 s or more expected")
    n = round(t_end / dt)
    if abs(n * dt - t_end) > 1e-9 * max(dt, t_end):  # far above rounding of t_end / dt, far below a real remainder
        low = int(t_end / dt)
        raise ArgumentError(
            f"{what}: t_end = {t_end} s is not a whole number of steps dt = {dt} s; "
            f"the nearest are {low * dt:.12g} and {(low + 1) * dt:.12g}"
        )
    return n, dt


def fixed_steps(
    method: Method,
    rate: Callable[[int, float, np.ndarray], np.ndarray],
    y0: np.ndarray,
    dt: float,
    n: int,
    space: Space,
    startup: str = "paper",
    kernel: Kernel | None = None,
) -> tuple[np.ndarray, int]:
    """n steps from y0 (B, size): values (n + 1, B, size) and the number of evaluations.

    `rate(k, c, y)` is evaluated at the time (k + c) dt.  `kernel(k, y, past)`, where there is one,
    takes a whole step once enough is known of the past, or returns None to leave it to the rates.
    """
    y = np.empty((n + 1, *y0.shape))
    y[0] = y0
    past: Past = ()
    evaluations = 0
    for k in range(n):
        current = RK4 if startup == "rk4" and len(past) < method.depth else method
        done = kernel(k, y[k], past) if kernel and current is method and len(past) >= method.depth else None
        if done is None:
            nodes = current.nodes

            def evaluate(i: int, x: np.ndarray, k: int = k, nodes: tuple[float, ...] = nodes) -> np.ndarray:
                return rate(k, nodes[i], x)

            value, new = step(current, evaluate, y[k], dt, past, space)
            done = value, (new + past)[: method.depth] if current is not method else new
        y[k + 1], past = done
        evaluations += current.evaluations
    return y, evaluations


def check_multistep(what: str, method: Method, space: Space) -> None:
    """Refuse multistep methods where a base turns: rates in different frames cannot be combined."""
    if isinstance(method, PredictorCorrector) and not space.additive:
        raise ArgumentError(
            f"{what}: method {method.name!r} adds rates of several instants, which has no order on a floating or "
            "planar base; did you mean 'rkmk4'? methods on groups: euler, midpoint, heun, rk4, rkmk4, rk45, "
            "crouch_grossman3, crouch_grossman4"
        )


def solve(
    f: TimeRate,
    y0: ArrayLike,
    *,
    method: str | Method = "rk4",
    dt: float,
    t_end: float,
    startup: str = "paper",
    rtol: float = 1e-9,
    atol: float = 1e-12,
    space: Space | None = None,
) -> Solution:
    """Integrate y' = f(t, y) from y(0) = y0, or y' = y f(t, y) on a group.

    Parameters
    ----------
    f : callable
        (t, y) -> dy/dt, over arrays (..., size); called with the batch that y0 is.
    y0 : array_like, shape (..., size)
    method : str
        A name of `dualpin.integrators.METHODS`.
    dt : float
        The step; of adaptive methods and of SciPy's, the interval between the values returned [s].
    t_end : float
        A whole number of steps [s].
    startup : "paper" or "rk4"
        How a multistep method begins: with the lower orders as they become possible, or by RK4.
    rtol, atol : float
        Of adaptive methods and SciPy's: the local error kept below atol + rtol |y|.
    space : Space, optional
        How values move; without it coordinates add.

    Returns
    -------
    Solution
        t (n + 1,), y (..., n + 1, size), cost.

    Raises
    ------
    ArgumentError, ShapeError

    References
    ----------
    Hairer, Norsett & Wanner (1993), II and III; Munthe-Kaas (1998) on groups.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> run = dp.integrators.solve(lambda t, y: -y, [1.0], method="rk4", dt=0.1, t_end=1.0)
    >>> bool(abs(run.y[-1, 0] - np.exp(-1)) < 1e-6), run.cost.evaluations
    (True, 40)
    """
    chosen, space = method_named(method), space or Space()
    n, dt = step_count("solve", dt, t_end)
    choice("solve: startup", startup, STARTUPS)
    start = numbers("solve: y0", y0)
    if start.ndim == 0 or not np.isfinite(start).all():
        raise ShapeError(f"solve: y0 of shape (..., size) with finite entries expected, got shape {start.shape}")
    if isinstance(chosen, Mechanical):
        raise ArgumentError(f"solve: method {chosen.name!r} is for equations of motion; dualpin.simulate takes it")
    check_multistep("solve", chosen, space)
    batch = start.shape[:-1]

    def checked(t: float, y: np.ndarray) -> np.ndarray:
        out = np.asarray(f(t, y), dtype=float)
        if out.shape[:-1] != y.shape[:-1]:
            raise ShapeError(f"solve: f(t, y) of shape {y.shape} expected, got {out.shape}")
        return out

    t0 = time.perf_counter()
    y, evaluations, steps = run_steps(chosen, checked, start, dt, n, space, startup, rtol, atol)
    cost = Cost(evaluations, steps, time.perf_counter() - t0)
    return Solution(np.arange(n + 1) * dt, np.moveaxis(y, 0, len(batch)), cost)


def run_steps(
    method: Method, f: TimeRate, y0: np.ndarray, dt: float, n: int, space: Space, startup: str,
    rtol: float, atol: float, kernel: Kernel | None = None, rate: Any = None,
) -> tuple[np.ndarray, int, int]:  # fmt: skip
    """Values (n + 1, ..., size), evaluations and steps, by the kind of the method."""
    if isinstance(method, Reference):
        return scipy_steps(method, f, y0, dt, n, space, rtol, atol)
    if isinstance(method, RungeKutta) and method.adaptive:
        return adaptive_steps(method, f, y0, dt, n, space, rtol, atol)
    y, evaluations = fixed_steps(
        method, rate or (lambda k, c, y: f((k + c) * dt, y)), y0, dt, n, space, startup, kernel
    )
    return y, evaluations, n
