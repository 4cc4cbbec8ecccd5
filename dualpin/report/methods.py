"""Studies of integrators: error against cost, and error against step, a line a method."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from .chart import Chart, Series
from .read import Row, Study

COSTS = (
    ("evaluations", "evaluations of the right-hand side"), ("rhs_evaluations", "evaluations of the right-hand side"),
    ("seconds", "seconds"), ("wall_seconds", "seconds"), ("dt", "step in s"), ("h", "step in s"),
)  # fmt: skip
CHARTS = 12


@dataclass
class Methods:
    """The integrator section as it is shown: charts where rows allow, and every table."""

    study: Study
    charts: list[Chart] = field(init=False)

    def __post_init__(self) -> None:
        self.charts = [c for name, rows in self.study.tables.items() for c in _charts(name, rows)][:CHARTS]

    @property
    def tables(self) -> list[tuple[str, list[str], list[Row]]]:
        """(name, columns, rows) of every table; columns that hold lists or mappings are left out."""
        found = []
        for name, rows in self.study.tables.items():
            plain = (k for r in rows for k, v in r.items() if not isinstance(v, (list, dict)))
            found.append((name, list(dict.fromkeys(plain)), rows))
        return found


def _charts(name: str, rows: list[Row]) -> Iterable[Chart]:
    """Every error of a table against every cost it names, apart for each problem."""
    if not any("method" in r for r in rows):
        return
    numbers = {k for r in rows for k, v in r.items() if isinstance(v, (int, float)) and not isinstance(v, bool)}
    errors = [k for k in dict.fromkeys(k for r in rows for k in r) if k in numbers and _is_error(k)]
    costs = [(k, text) for k, text in COSTS if k in numbers]
    problems = [
        k for k in ("problem", "robot", "system", "study", "trajectory", "circle", "plane") if any(k in r for r in rows)
    ]
    for problem in dict.fromkeys(tuple(str(r.get(k, "")) for k in problems) for r in rows):
        some = [r for r in rows if tuple(str(r.get(k, "")) for k in problems) == problem and "method" in r]
        for error in errors:
            for cost, text in costs:
                if len({r.get(cost) for r in some}) < 3:
                    continue
                title = ", ".join(x for x in (*problem, name) if x)
                yield Chart(f"{title}: {_words(error)}", text, _words(error), _series(some, cost, error))


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


def _is_error(key: str) -> bool:
    return any(word in key for word in ("error", "drift"))


def _words(key: str) -> str:
    return key.replace("_", " ")
