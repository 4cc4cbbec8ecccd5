"""Studies of integrators: error against cost, and error against step, a line a method."""

from __future__ import annotations

from dataclasses import dataclass, field

from .chart import Chart, Series
from .read import Curve, Row, Study

COSTS = (
    ("evaluations", "evaluations of the right-hand side"),
    ("rhs_evaluations", "evaluations of the right-hand side"),
    ("seconds", "seconds"),
    ("wall_seconds", "seconds"),
)
STEPS = (("dt", "step in s"), ("h", "step in s"))
APART = ("problem", "robot", "system", "study", "trajectory", "circle", "plane", "task", "gain", "feedback")
"""What makes two rows different problems."""
GROUPS = 4  # charts a table gets; the rest of it is in the table


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
    def tables(self) -> list[tuple[str, list[str], list[Row]]]:
        """(name, columns, rows) of every table; columns that hold lists or mappings are left out."""
        found = []
        for name, rows in self.study.tables.items():
            plain = (k for r in rows for k, v in r.items() if not isinstance(v, (list, dict)))
            found.append((name, list(dict.fromkeys(plain)), rows))
        return found


def _charts(name: str, rows: list[Row]) -> list[Chart]:
    """The first error of a table against the steps it was run with, or against cost."""
    if not any("method" in r for r in rows):
        return []
    numbers = [k for k in dict.fromkeys(k for r in rows for k in r) if any(_is_number(r.get(k)) for r in rows)]
    errors = [k for k in numbers if any(word in k for word in ("error", "drift", "peak"))]
    steps = [s for s in STEPS if len({r.get(s[0]) for r in rows}) > 2]
    against = [c for c in steps or COSTS if c[0] in numbers]
    apart = [k for k in APART if len({str(r.get(k)) for r in rows}) > 1]
    found = []
    for problem in dict.fromkeys(tuple((k, r.get(k)) for k in apart) for r in rows):
        some = [r for r in rows if "method" in r and all(r.get(k) == v for k, v in problem)]
        for x, text in against if errors else []:
            if len({r.get(x) for r in some}) > 2:
                title = ", ".join([_words(name), *(f"{k} {v}" for k, v in problem)])
                chart = Chart(f"{title}: {_words(errors[0])}", text, _words(errors[0]), _series(some, x, errors[0]))
                found += [chart] if chart.series else []
    return found[:GROUPS]


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
            if str(r["method"]) == method and _is_number(r.get(cost)) and _is_number(r.get(error))
        ]
        series.append(Series(method, points))
    return series


def _is_number(x: object) -> bool:
    return isinstance(x, (int, float)) and not isinstance(x, bool)


def _words(key: str) -> str:
    return key.replace("_", " ").replace(".", ", ")
