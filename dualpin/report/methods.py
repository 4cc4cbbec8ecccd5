"""Studies of integrators: error against cost, and error against step, a line a method."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite

import numpy as np

from .chart import Chart, Series
from .read import Curve, Row, Study, is_number

COSTS = (
    ("evaluations", "evaluations of the right-hand side"),
    ("rhs_evaluations", "evaluations of the right-hand side"),
    ("seconds", "seconds"),
    ("wall_seconds", "seconds"),
)
STEPS = (("dt", "step in s"), ("h", "step in s"))
APART = ("problem", "robot", "system", "study", "trajectory", "circle", "plane", "task", "gain", "feedback")
"""What makes two rows different problems."""
GROUPS = 4  # problems of a table that get charts; the rest of it is in the table


FLOOR = 1e-12
"""Errors below this are rounding, or the tolerance of a reference: no slope is fitted through them."""
CEILING = 0.1
"""Errors above this are no longer proportional to a power of the step."""


@dataclass(frozen=True)
class Order:
    """The exponent p of  error = c dt^p  of a method, by least squares in logarithms.

    Attributes
    ----------
    scatter : float
        The largest factor between the line and a point.
    points : int
        Steps the line is fitted to: those with errors between rounding and saturation.
    """

    problem: str
    method: str
    error: str
    order: float
    scatter: float
    points: int


@dataclass
class Methods:
    """The integrator section as it is shown: charts where rows allow, and every table."""

    study: Study
    charts: list[Chart] = field(init=False)

    def __post_init__(self) -> None:
        tables = sorted(self.study.tables.items(), key=lambda item: "work" not in item[0])
        self.charts = [c for name, rows in tables for c in _charts(name, rows)]
        self.charts += [_over(name, curves) for name, curves in self.study.curves.items()]

    @property
    def orders(self) -> list[Order]:
        """The order of every method, fitted to its errors against its steps, problem by problem."""
        return [o for rows in self.study.tables.values() for o in _orders(rows)]

    @property
    def tables(self) -> list[tuple[str, list[str], list[Row]]]:
        """(name, columns, rows) of every table; columns that hold lists or mappings are left out."""
        found = []
        for name, rows in self.study.tables.items():
            plain = (k for r in rows for k, v in r.items() if not isinstance(v, (list, dict)))
            found.append((name, list(dict.fromkeys(plain)), rows))
        return found


def _orders(rows: list[Row]) -> list[Order]:
    found = []
    step = next((s for s, _ in STEPS if len({r.get(s) for r in rows}) > 1), None)
    error = next(iter(_errors(rows)), None)
    if step is None or error is None:
        return []
    for problem, some in _problems(rows):
        for method in dict.fromkeys(str(r["method"]) for r in some):
            points = [(r[step], r[error]) for r in some if str(r["method"]) == method
                      and is_number(r.get(step)) and is_number(r.get(error))]  # fmt: skip
            points = sorted(p for p in points if p[0] > 0 and FLOOR < p[1] < CEILING and isfinite(p[1]))
            if len({h for h, _ in points}) > 1:
                h, e = np.log10(np.array(points)).T
                order, offset = np.polyfit(h, e, 1)
                scatter = float(10 ** np.abs(order * h + offset - e).max())
                found.append(Order(problem, method, _words(error), float(order), scatter, len(points)))
    return found


def _errors(rows: list[Row]) -> list[str]:
    """The columns that hold an error."""
    numbers = [k for k in dict.fromkeys(k for r in rows for k in r) if any(is_number(r.get(k)) for r in rows)]
    return [k for k in numbers if any(word in k for word in ("error", "drift", "peak"))]


def _problems(rows: list[Row]) -> list[tuple[str, list[Row]]]:
    """(what sets it apart, its rows) of every problem in a table."""
    apart = [k for k in APART if len({str(r.get(k)) for r in rows}) > 1]
    found = []
    for problem in dict.fromkeys(tuple((k, r.get(k)) for k in apart) for r in rows):
        some = [r for r in rows if "method" in r and all(r.get(k) == v for k, v in problem)]
        found.append((", ".join(f"{k} {v}" for k, v in problem), some))
    return found


def _charts(name: str, rows: list[Row]) -> list[Chart]:
    """The first error of a table against what the runs cost, and against the steps they were run with."""
    errors = _errors(rows)
    if not errors or not any("method" in r for r in rows):
        return []
    against = [(x, text) for x, text in (*COSTS, *STEPS) if any(is_number(r.get(x)) for r in rows)]
    found = []
    for problem, some in _problems(rows):
        for x, text in against:
            if len({r.get(x) for r in some}) > 2:
                of = ", ".join(filter(None, [_words(name) if name != "rows" else "", problem]))
                title = f"{of}{': ' if of else ''}{_words(errors[0])} against {text}"
                chart = Chart(title, text, _words(errors[0]), _series(some, x, errors[0]))
                found += [chart] if chart.series else []
    return found[: GROUPS * len(against)]


def _over(name: str, curves: list[Curve]) -> Chart:
    """Sequences over time or turns."""
    series = [Series(c.name, [(x, y, f"{c.name}\n{c.xlabel} {x:.6g}: {y:.3g}") for x, y in c.points]) for c in curves]
    return Chart(f"{_words(name)} over {curves[0].xlabel}", curves[0].xlabel, _words(name), series)


def _series(rows: list[Row], cost: str, error: str) -> list[Series]:
    series = []
    for method in dict.fromkeys(str(r["method"]) for r in rows):
        points = [
            (r[cost], r[error], f"{method}\n{_words(cost)} {r[cost]:.4g}\n{_words(error)} {r[error]:.3g}")
            for r in rows
            if str(r["method"]) == method and is_number(r.get(cost)) and is_number(r.get(error))
        ]
        series.append(Series(method, points))
    return series


def _words(key: str) -> str:
    return key.replace("_", " ").replace(".", ", ")
