"""SciPy's solve_ivp as a reference; imported when first asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..errors import ArgumentError
from ..extras import extra
from .methods import Reference
from .space import Space

TIGHTEST = 2.3e-14  # solve_ivp itself takes no smaller rtol (100 eps)


def scipy_steps(
    method: Reference,
    f: Callable[[float, np.ndarray], np.ndarray],
    y0: np.ndarray,
    dt: float,
    n: int,
    space: Space,
    rtol: float,
    atol: float,
) -> tuple[np.ndarray, int, int]:
    """Values (n + 1, ..., size) at the multiples of dt, evaluations, intervals.

    Where coordinates add, one call with dense output.  On a group, one call an interval for
    u' = dexp^-1(-u) f, u = 0 at its start, which is exact to the truncation of dexp^-1.
    """
    out = np.empty((n + 1, *y0.shape))
    out[0] = y0
    options = {"method": method.scipy, "rtol": max(rtol, TIGHTEST), "atol": atol}
    if n == 0:
        return out, 0, 0
    if space.additive:
        times = np.arange(n + 1) * dt
        shape = y0.shape
        found = _solve_ivp(
            lambda t, y: f(t, y.reshape(shape)).ravel(), (0.0, n * dt), y0.ravel(), t_eval=times, **options
        )
        return found.y.T.reshape(out.shape), int(found.nfev), n
    evaluations = 0
    for k in range(n):
        start = out[k]
        shape = f(k * dt, start).shape

        def chart(t: float, u: np.ndarray, start: np.ndarray = start, shape: tuple[int, ...] = shape) -> np.ndarray:
            v = u.reshape(shape)
            return space.straighten(v, f(t, space.move(start, v)), 6).ravel()

        found = _solve_ivp(chart, (k * dt, (k + 1) * dt), np.zeros(int(np.prod(shape))), **options)
        out[k + 1] = space.move(start, found.y[:, -1].reshape(shape))
        evaluations += int(found.nfev) + 1
    return out, evaluations, n


def _solve_ivp(
    f: Callable[[float, np.ndarray], np.ndarray], span: tuple[float, float], y0: np.ndarray, **options: Any
) -> Any:
    solve_ivp = extra("scipy.integrate", "integrators", f"method {options['method']!r}").solve_ivp

    def watched(t: float, y: np.ndarray) -> np.ndarray:
        rate = f(t, y)
        if not np.isfinite(rate).all():  # SciPy would not terminate
            raise ArgumentError(f"{options['method']}: the rate is not finite at t = {t:.6g} s")
        return rate

    found = solve_ivp(watched, span, y0, **options)
    if not found.success:
        raise ArgumentError(f"{options['method']}: {found.message}")
    return found
