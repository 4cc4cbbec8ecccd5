"""Embedded Runge-Kutta pairs with a controlled step and dense output."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..errors import ArgumentError
from .methods import RungeKutta
from .space import Space
from .step import combination, stages

SAFETY, SMALLEST, LARGEST = 0.9, 0.2, 10.0  # usual bounds on the change of the step (Hairer et al., II.4)
TINY = 1e-12  # of the whole time: with steps this small the run would not end


def adaptive_steps(
    method: RungeKutta,
    f: Callable[[float, np.ndarray], np.ndarray],
    y0: np.ndarray,
    dt: float,
    n: int,
    space: Space,
    rtol: float,
    atol: float,
) -> tuple[np.ndarray, int, int]:
    """Values (n + 1, ..., size) at the multiples of dt, evaluations, steps.

    One step for the whole batch, so small that the local error of every member stays below
    atol + rtol |displacement| in every coordinate's rate; the values between come from the pair's
    own interpolant, which on a group lives in the Lie algebra of the step's start.
    """
    t_end, out = n * dt, np.empty((n + 1, *y0.shape))
    out[0] = y0
    if n == 0:
        return out, 0, 0
    weights = np.array(method.error)
    y, t, done, steps = y0, 0.0, 0, 0
    k0 = f(0.0, y)
    evaluations = 1
    if not np.isfinite(k0).all():
        raise ArgumentError(f"{method.name}: the rate is not finite at the start")
    h = min(dt, _first_step(k0, rtol, atol, t_end))
    while done < n:
        h = min(h, t_end - t) if t_end - t > 1.01 * h else t_end - t

        def rate(i: int, x: np.ndarray, t: float = t, h: float = h, first: np.ndarray = k0) -> np.ndarray:
            return f(t + method.nodes[i] * h, x) if i else first

        K = stages(method, rate, y, h, space)
        evaluations += method.evaluations - 1
        u = combination(method.b, K, h)
        with np.errstate(all="ignore"):  # too long a step can overflow; a shorter one is tried
            error = np.abs(h * np.tensordot(weights, np.stack(K), 1))
            scale = atol + rtol * np.maximum(np.abs(u), 1.0)
            size = np.sqrt(np.mean((error / scale) ** 2, axis=-1)).max(initial=0.0)
        if not size <= 1 and h <= TINY * t_end:
            finite = all(np.isfinite(k).all() for k in K)
            why = "no error below the tolerance: the rate jumps there, or rtol is too small" if finite else (
                "a rate that is not finite: the solution leaves the numbers there")  # fmt: skip
            raise ArgumentError(f"{method.name}: the step fell to {h:.3g} s at t = {t:.6g} s, with {why}")
        factor = LARGEST if size == 0 else SAFETY * size ** (-1 / method.order) if np.isfinite(size) else 0.0
        if not size <= 1:
            h *= max(SMALLEST, factor)
            continue
        steps += 1
        reached = t + h
        while done < n and (done + 1) * dt <= reached * (1 + 1e-14):
            done += 1
            theta = min((done * dt - t) / h, 1.0)
            out[done] = space.move(y, dense_displacement(method, K, h, theta))
        y, t = space.move(y, u), reached
        k0 = K[-1] if space.additive else f(t, y)  # first same as last
        evaluations += not space.additive
        h *= min(LARGEST, max(SMALLEST, factor))
    return out, evaluations, steps


def dense_displacement(method: RungeKutta, K: tuple[np.ndarray, ...], h: float, theta: float) -> np.ndarray:
    """u(theta) = h sum_i b_i(theta) k_i: the displacement at a fraction theta of the step."""
    powers = theta ** np.arange(1, len(method.dense[0]) + 1)
    return h * np.tensordot(np.array(method.dense) @ powers, np.stack(K), 1)


def _first_step(k: np.ndarray, rtol: float, atol: float, t_end: float) -> float:
    """A step that moves a hundredth, or a thousandth of the whole."""
    speed = float(np.abs(k).max(initial=0.0))
    return min(0.01 / speed if speed > 0 else t_end, t_end) * max(min((rtol + atol) ** 0.2 * 50, 1.0), 1e-3)
