"""Newton's method in dual numbers, for one equation or a system."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..dual import Dual, stack
from ..errors import ArgumentError
from ..parts import array
from .arguments import AssumptionError, dual_array
from .linear import lstsq, solve

ROUNDING = 1e-9  # steps this small may be rounding, even for an ill-conditioned root


@dataclass
class NewtonResult:
    """The solution and the iterates."""

    x: Dual
    converged: bool
    iterates: list[Dual] = field(default_factory=list)
    """x_0, x_1, ..., the last of them `x`."""
    values: list[Dual] = field(default_factory=list)
    """f at all iterates except the last; see `residual`."""
    residual: float = np.inf
    """max |f(x)| over both parts."""

    @property
    def iterations(self) -> int:
        return len(self.iterates) - 1


def newton(
    f: Callable[[Any], Any],
    x0: Any,
    *,
    tol: float = 1e-13,
    max_iterations: int = 50,
    real_only: Sequence[int] = (),
    jacobian: Callable[[Any], Any] | None = None,
) -> NewtonResult:
    """Solve f(x) = 0 by Newton's method in dual numbers:  x <- x - J^-1 f, or x - J^+ f if not square.

    Parameters
    ----------
    f : callable
        A function of a scalar dual number; or of a list of n of them, with a sequence of m dual numbers as its
        result.  It uses the operations and functions of dual numbers (``np.sin``, ...) and is differentiated
        exactly.
    x0 : Dual or sequence of Dual
        The start; a sequence or a dual array (n,) for a system.
    tol : float
        Stop when a step changes no part by more than tol max(1, |x|), or when steps below 1e-9 no longer shrink.
    max_iterations : int
        Raises after this many iterations.
    real_only : sequence of int
        Indices of unknowns that are real: their dual parts stay as given.  Then the real and the dual equations
        are solved together.
    jacobian : callable, optional
        The dual derivative (or matrix) instead of the exact differentiation.

    Returns
    -------
    NewtonResult

    Raises
    ------
    SingularError
        If the real part of the derivative is singular.
    AssumptionError
        If the iteration does not converge.

    References
    ----------
    Pennestri & Stefanelli (2007), sec. 10.2-10.3.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> r = dp.algebra.newton(lambda x: x * x - dp.Dual(2.0, 1.0), dp.Dual(1.0))
    >>> round(float(r.x.real), 12), round(float(r.x.dual), 12), r.converged
    (1.414213562373, 0.353553390593, True)
    """
    if not callable(f):
        raise ArgumentError(f"newton: a function of x expected first, got {type(f).__name__}")
    scalar = not (x0.shape if isinstance(x0, Dual) else np.ndim(x0) if not isinstance(x0, (list, tuple)) else 1)
    start = [x0] if scalar else x0
    a, b = dual_array("newton: x0", start if isinstance(start, Dual) else [_dual(x) for x in start], 1)
    x = Dual(a.copy(), b.copy())
    n = x.shape[0]
    if any(not 0 <= i < n for i in real_only):
        raise ArgumentError(f"newton: real_only {tuple(real_only)} must name unknowns 0 to {n - 1}")
    result = NewtonResult(x, False)
    result.iterates.append(x[0] if scalar else x)
    last = np.inf
    for _ in range(max_iterations):
        F, J = _linearized(f, x, scalar, jacobian)
        result.values.append(F[0] if scalar else F)
        step = _step(F, J, list(real_only))
        x = x - step
        result.iterates.append(x[0] if scalar else x)
        size = max(1.0, float(np.abs(x.real).max()), float(np.abs(x.dual).max()))
        length = float(max(np.abs(step.real).max(), np.abs(step.dual).max()))
        # near a root steps shrink quadratically; if they no longer do, they are rounding
        result.converged = length <= tol * size or (length <= ROUNDING * size and length > last / 2)
        if result.converged:
            break
        last = length
    F, _ = _linearized(f, x, scalar, jacobian)
    result.x, result.residual = result.iterates[-1], float(max(np.abs(F.real).max(), np.abs(F.dual).max()))
    if not result.converged:
        raise AssumptionError(
            f"newton: not converged in {max_iterations} iterations (residual {result.residual:.3g}); "
            "begin nearer to a root"
        )
    return result


def _dual(x: Any) -> Dual:
    return x if isinstance(x, Dual) else Dual(np.asarray(x, dtype=float), 0.0)


def _linearized(f: Any, x: Dual, scalar: bool, jacobian: Any) -> tuple[Dual, Dual]:
    """f(x), shape (m,), and its dual derivative, shape (m, n)."""
    if jacobian is not None:
        argument = x[0] if scalar else x
        F, J = f(argument), jacobian(argument)
        return (stack([F]), stack([stack([J])])) if scalar else (Dual(*dual_array("f", F)), Dual(*dual_array("J", J)))
    n = x.shape[0]
    # dual numbers with dual parts: the inner eps differentiates by each unknown
    seeds, zero = np.eye(n), np.zeros(n)
    unknowns = [Dual(Dual(x.real[i] + zero, seeds[i]), Dual(x.dual[i] + zero, zero)) for i in range(n)]
    values = f(unknowns[0] if scalar else unknowns)
    rows = [_dual(v) for v in ([values] if scalar else values)]
    real, dual = ([_with_gradient(getattr(v, part), n) for v in rows] for part in ("real", "dual"))
    F, J = (Dual(*(np.array([x[k] for x in part]) for part in (real, dual))) for k in (0, 1))
    return F, J


def _with_gradient(part: Any, n: int) -> tuple[Any, np.ndarray]:
    """A part's value, and its derivatives by the n unknowns."""
    if not isinstance(part, Dual):
        return array(part), np.zeros(n)
    value, gradient = part.arrays
    return value[0], gradient


def _step(F: Dual, J: Dual, real_only: list[int]) -> Dual:
    m, n = J.shape
    if not real_only:
        return solve(J, F) if m == n else lstsq(J, F)
    # (J dx; J' dx + J dx') without the columns of dual parts that are not unknowns
    free = [i for i in range(n) if i not in real_only]
    big = np.block([[J.real, np.zeros((m, len(free)))], [J.dual, J.real[:, free]]])
    y = np.linalg.lstsq(big, np.concatenate((F.real, F.dual)), rcond=None)[0]
    dx = np.zeros(n, dtype=y.dtype)
    dx[free] = y[n:]
    return Dual(y[:n], dx)
