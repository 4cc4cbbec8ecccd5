"""The data of a method: coefficients, its declared order, and its stability limit.

A method is data.  `step.py` knows how to take a step with each of the four kinds, and nothing
about any particular one; to add a method, add its coefficients to `tableaus.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf

Row = tuple[float, ...]


@dataclass(frozen=True)
class Method:
    """What every method declares.

    Attributes
    ----------
    name, title, source : str
        Its name in code, its name in text, and a reference.
    order : int
        The global error is O(dt^order).
    stability_limit : float
        The largest K dt for which y' = -K y does not grow, from the coefficients.
    """

    name: str
    title: str
    order: int
    stability_limit: float
    source: str

    @property
    def nodes(self) -> Row:
        """Where in the step, as a fraction of it, the rate is evaluated; one entry an evaluation."""
        return (0.0,)

    @property
    def evaluations(self) -> int:
        """Evaluations of the rate in one step."""
        return len(self.nodes)

    @property
    def depth(self) -> int:
        """How many earlier rates a step uses."""
        return 0


@dataclass(frozen=True)
class RungeKutta(Method):
    """k_i = f(y + h sum_j a_ij k_j),  y' = y + h sum_i b_i k_i.

    On a group (a floating base) the same tableau is applied in the Lie algebra, in the way of
    Runge-Kutta-Munthe-Kaas.

    Attributes
    ----------
    A : rows of the strictly lower triangle
    b : weights of the result
    error : weights of the difference to the embedded result, for adaptive steps
    dense : for each stage the coefficients of theta, theta^2, ... in its weight b_i(theta)
    """

    A: tuple[Row, ...]
    b: Row
    error: Row = ()
    dense: tuple[Row, ...] = ()

    @cached_property
    def nodes(self) -> Row:
        return tuple(float(round(sum(row), 15)) for row in self.A)

    @property
    def adaptive(self) -> bool:
        return bool(self.error)


@dataclass(frozen=True)
class CrouchGrossman(Method):
    """Stages and result as products of exponentials: y exp(h a_i1 k_1) exp(h a_i2 k_2) ..."""

    A: tuple[Row, ...]
    b: Row

    @cached_property
    def nodes(self) -> Row:
        return tuple(float(round(sum(row), 15)) for row in self.A)


@dataclass(frozen=True)
class PredictorCorrector(Method):
    """Predict, evaluate, correct, evaluate (PECE), restarted from the corrected value.

        y* = y_k + h sum_j p_j f_{k-j},   y_{k+1} = y_k + h (c_0 f(y*) + sum_j c_{j+1} f_{k-j})

    Attributes
    ----------
    predictors, correctors : rows
        The m-th row is used when m rates f_k, f_{k-1}, ... are known; the last from then on.
    startup_order : int
        Order of the whole with this start-up; `order` is reached when the first values are better.
    """

    predictors: tuple[Row, ...]
    correctors: tuple[Row, ...]
    startup_order: int = 0

    @property
    def nodes(self) -> Row:
        return (0.0, 1.0)

    @property
    def depth(self) -> int:
        return len(self.predictors) - 1


@dataclass(frozen=True)
class Mechanical(Method):
    """A method for equations of motion only, in q and v or in q and momentum: `dualpin.simulate` takes it."""


@dataclass(frozen=True)
class Reference(Method):
    """A method of scipy.integrate.solve_ivp, to compare with; `scipy` is its name there."""

    scipy: str = ""


UNBOUNDED = inf
