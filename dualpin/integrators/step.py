"""One step, of any method, over arrays or columns of scalars.

The rate is a function f(i, y) of the evaluation's number i (its time is t + nodes[i] h) and the
value y.  Values move by a *space*: y + u where coordinates simply add, y exp(u) on a group.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ..errors import ArgumentError
from .column import combination
from .methods import CrouchGrossman, Method, PredictorCorrector, RungeKutta
from .space import Space

Rate = Callable[[int, Any], Any]
Past = tuple[Any, ...]


def step(method: Method, f: Rate, y: Any, h: Any, past: Past = (), space: Space = Space()) -> tuple[Any, Past]:  # noqa: B008
    """The value one step later, and the earlier rates for the next step (latest first).

    Parameters
    ----------
    method : Method
    f : callable
        The rate of y.
    y : value
        Of the space.
    h : scalar
        The step [s].
    past : tuple of rates
        Those that came before, latest first; as many as a multistep method looks back on.
    space : Space
        How a value moves along a rate; vectors by default.

    Returns
    -------
    y : value
        One step later.
    past : tuple of rates
        For the next step.

    Raises
    ------
    DualpinError
        Whatever the rate raises.

    References
    ----------
    Hairer, Norsett & Wanner (1993), II.1 and III.1; on groups, Munthe-Kaas (1998).

    Examples
    --------
    >>> from dualpin.integrators import method_named, step
    >>> y, past = step(method_named("rk4"), lambda i, y: -y, 1.0, 0.1)
    >>> round(y, 7)
    0.9048375
    """
    if isinstance(method, RungeKutta):
        K = stages(method, f, y, h, space)
        return space.move(y, combination(method.b, K, h)), K[:1]
    if isinstance(method, PredictorCorrector):
        return _pece(method, f, y, h, past, space)
    if isinstance(method, CrouchGrossman):
        return _crouch_grossman(method, f, y, h, space)
    raise ArgumentError(f"method {method.name!r} does not advance by steps of a rate")


def stages(method: RungeKutta, f: Rate, y: Any, h: Any, space: Space) -> Past:
    """k_i = f(y + h sum_j a_ij k_j); on a group k_i = dexp^-1(u_i) f(y exp(u_i)).  (Munthe-Kaas 1998)"""
    K: list[Any] = []
    for i, row in enumerate(method.A):
        u = combination(row, K, h)
        K.append(f(i, y) if u is None else space.straighten(u, f(i, space.move(y, u)), method.order))
    return tuple(K)


def _pece(method: PredictorCorrector, f: Rate, y: Any, h: Any, past: Past, space: Space) -> tuple[Any, Past]:
    known = (f(0, y), *past)
    predictor, corrector = (_row(rows, len(known)) for rows in (method.predictors, method.correctors))
    ahead = f(1, space.move(y, combination(predictor, known, h)))
    return space.move(y, combination(corrector, (ahead, *known), h)), known[: method.depth]


def _row(rows: Sequence[tuple[float, ...]], known: int) -> tuple[float, ...]:
    return rows[min(known, len(rows)) - 1]


def _crouch_grossman(method: CrouchGrossman, f: Rate, y: Any, h: Any, space: Space) -> tuple[Any, Past]:
    K: list[Any] = []
    for i, row in enumerate(method.A):
        K.append(f(i, _product(row, K, y, h, space)))
    return _product(method.b, K, y, h, space), tuple(K[:1])


def _product(weights: Sequence[float], K: Sequence[Any], y: Any, h: Any, space: Space) -> Any:
    """y exp(h w_1 k_1) exp(h w_2 k_2) ...   (Crouch & Grossman 1993)"""
    for w, k in zip(weights, K, strict=True):
        if w:
            y = space.move(y, k * (h * w))
    return y
