"""The real-axis stability limit of a method, computed from its own steps."""

from __future__ import annotations

from functools import cache

import numpy as np

from ..errors import ArgumentError
from .methods import Mechanical, Method, Reference
from .step import step
from .tableaus import method_named

LARGEST = 64.0


def amplification(method: str | Method, z: float, held: bool = False) -> float:
    """The factor by which y' = -K y grows in the worst case, at K dt = z.

    With `held`, y on the right is that of the step's beginning in all its evaluations.

    The step is linear there: its matrix on (y, h f_{k-1}, h f_{k-2}, ...) is found by stepping unit
    vectors, and the factor is its spectral radius.

    Parameters
    ----------
    method : str or Method
    z : float
        K dt.
    held : bool

    Returns
    -------
    float

    Raises
    ------
    ArgumentError
        For a method that is not known.

    References
    ----------
    Hairer & Wanner (1996), IV.2 and V.1.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.integrators.amplification("euler", 0.5)
    0.5
    """
    chosen = method_named(method)
    if isinstance(chosen, (Mechanical, Reference)):
        raise ArgumentError(f"amplification: {chosen.name!r} has no step of a rate to measure")
    n = chosen.depth + 1
    unit = np.eye(n)
    past = tuple(unit[:, j : j + 1] for j in range(1, n))
    y, after = step(chosen, lambda i, x: -z * (unit[:, :1] if held else x), unit[:, :1], 1.0, past)
    return float(np.abs(np.linalg.eigvals(np.hstack([y, *after[: n - 1]]).T)).max())


@cache
def stability_limit(method: str | Method, tolerance: float = 1e-12, held: bool = False) -> float:
    """The largest K dt for which the closed loop e' = -K e does not grow; `held`: with the error of the step's start.

    Scanned upwards from 0 in hundredths, then bisected.

    Parameters
    ----------
    method : str or Method
    tolerance : float
        By how much the factor may exceed 1, for rounding.
    held : bool
        See `amplification`.

    Returns
    -------
    float
        K dt.

    Raises
    ------
    ArgumentError
        For a method that is not known.

    References
    ----------
    Hairer & Wanner (1996), IV.2 and V.1.

    Examples
    --------
    >>> import dualpin as dp
    >>> [round(dp.integrators.stability_limit(m), 3) for m in ("euler", "trapezoidal", "abm4", "rk4")]
    [2.0, 2.0, 1.285, 2.785]
    >>> [round(dp.integrators.stability_limit(m, held=True), 3) for m in ("euler", "trapezoidal", "abm4", "rk4")]
    [2.0, 2.0, 1.412, 2.0]
    """
    chosen = method_named(method)
    grows = 1 + 1e-12  # rounding of an eigenvalue of a small matrix
    high = 0.01
    while amplification(chosen, high, held) <= grows:
        high += 0.01
        if high > LARGEST:
            return float("inf")
    low = high - 0.01
    while high - low > tolerance:
        middle = (low + high) / 2
        low, high = (middle, high) if amplification(chosen, middle, held) <= grows else (low, middle)
    return low
