"""Measurements of speed: ratios to Pinocchio, and how the cost grows with batch, threads and degrees of freedom."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import exp, log
from statistics import fmean, stdev
from typing import Any

from .chart import Chart, Series
from .read import Row, Study

SERIES = 8  # more lines in one chart cannot be distinguished
CHARTS = 8
MATRICES = 2


@dataclass
class Ratios:
    """How many times faster than Pinocchio, robots x terms, under one setting."""

    setting: str
    terms: list[str]
    rows: list[tuple[str, list[tuple[float, str] | None]]]


@dataclass(frozen=True)
class Mean:
    """The geometric mean of ratios, and how they spread about it.

    Attributes
    ----------
    spread : float
        The geometric standard deviation: two thirds of the ratios are within mean / spread and mean * spread if their
        logarithms are normal.
    least, most : tuple of float and str
        The extreme ratios, and whose.
    """

    setting: str
    of: str
    count: int
    mean: float
    spread: float
    least: tuple[float, str]
    most: tuple[float, str]


@dataclass
class Speed:
    """The speed section as it is shown."""

    study: Study
    ratios: list[Ratios] = field(init=False)
    charts: list[Chart] = field(init=False)

    def __post_init__(self) -> None:
        rows = [r for r in self.study.rows if isinstance(r.get("us_per_sample"), (int, float))]
        self.rows = rows
        self.ratios = list(_ratios(rows))
        self.charts = [*_dof(rows), *_scaling(rows, "batch", "threads"), *_scaling(rows, "threads", "batch")][:CHARTS]

    @property
    def means(self) -> list[Mean]:
        """Geometric means of the ratios: of everything under a setting, then of each term."""
        return list(_means(self.rows))

    @property
    def others(self) -> list[tuple[str, list[str], list[Row]]]:
        """Tables of other measurements: (name, columns, rows)."""
        tables = ((name, rows) for name, rows in self.study.tables.items() if "us_per_sample" not in rows[0])
        return [(name, list(dict.fromkeys(k for r in rows for k in r)), rows) for name, rows in tables]

    @property
    def columns(self) -> list[str]:
        return list(dict.fromkeys(key for r in self.rows for key, v in r.items() if not isinstance(v, (list, dict))))


def speedup(row: Row) -> float | None:
    """Pinocchio's time over ours."""
    theirs, ours = row.get("pinocchio_us_per_sample"), row["us_per_sample"]
    return theirs / ours if isinstance(theirs, (int, float)) and ours else None


def _ratios(rows: list[Row]) -> Iterable[Ratios]:
    """For each number of threads a matrix at each of the batches that most was measured with."""
    cells: dict[Any, dict[Any, list[Row]]] = {}
    for r in rows:
        if speedup(r) is not None:
            cells.setdefault(r.get("threads", 1), {}).setdefault(r.get("batch"), []).append(r)
    for threads, batches in sorted(cells.items(), key=lambda item: str(item[0])):
        ends = {max(batches, key=_size), min(batches, key=_size)}
        most = sorted(batches, key=lambda b: (len(batches[b]), b in ends), reverse=True)[:MATRICES]
        for batch in sorted(most, key=_size, reverse=True):
            some = batches[batch]
            terms = list(dict.fromkeys(r["term"] for r in some))
            robots: dict[str, dict[str, Row]] = {}
            for r in some:
                robots.setdefault(label(r), {})[r["term"]] = r
            matrix = [(name, [_ratio(of.get(t)) for t in terms]) for name, of in robots.items()]
            threads_text = "1 thread" if threads == 1 else f"{threads} threads"
            yield Ratios(f"batch {batch}, {threads_text}", terms, matrix)


def _means(rows: list[Row]) -> Iterable[Mean]:
    timed = [(r, ratio) for r in rows if (ratio := speedup(r))]
    groups: dict[str, dict[str, list[tuple[float, str]]]] = {}
    for r, ratio in timed:
        threads = r.get("threads", 1)
        setting = f"batch {r.get('batch')}, {'1 thread' if threads == 1 else f'{threads} threads'}"
        for of in ("all terms", str(r["term"])):
            groups.setdefault(setting, {}).setdefault(of, []).append((ratio, f"{label(r)} {r['term']}"))
    for setting, terms in groups.items():
        for of, found in terms.items():
            logs = [log(x) for x, _ in found]
            spread = exp(stdev(logs)) if len(logs) > 1 else 1.0
            yield Mean(setting, of, len(found), exp(fmean(logs)), spread, min(found), max(found))


def _size(batch: Any) -> float:
    return batch if isinstance(batch, (int, float)) else 0.0


def label(row: Row) -> str:
    """The robot on its base."""
    return f"{row['robot']} floating" if row.get("floating") else str(row["robot"])


def _ratio(row: Row | None) -> tuple[float, str] | None:
    if row is None:
        return None
    return (
        speedup(row) or 0.0,
        f"{label(row)}, {row['term']}: {row['us_per_sample']:.4g} us a sample, "
        f"Pinocchio {row['pinocchio_us_per_sample']:.4g} us",
    )


def _dof(rows: list[Row]) -> Iterable[Chart]:
    """Cost against degrees of freedom, on one thread."""
    key = next((k for k in ("nv", "dof") if any(k in r for r in rows)), None)
    if key is None:
        return
    rows = [r for r in rows if r.get(key) is not None and r.get("threads", 1) == 1]
    batches = [r.get("batch", 1) for r in rows]
    # the batch that most degrees of freedom were measured with
    batch = max(batches, key=lambda b: (len({r[key] for r in rows if r.get("batch", 1) == b}), b), default=1)
    rows = [r for r in rows if r.get("batch", 1) == batch]
    if len({r[key] for r in rows}) > 3:
        title = f"Cost against degrees of freedom, batch {batch}"
        yield _chart(title, "degrees of freedom", rows, lambda r: r.get(key), "term")


def _scaling(rows: list[Row], key: str, fixed: str) -> Iterable[Chart]:
    """Cost against batch or threads, a chart a robot."""
    for robot in dict.fromkeys(label(r) for r in rows):
        some = [r for r in rows if label(r) == robot]
        values = {r.get(fixed, 1) for r in some}
        # the setting of the other quantity under which most was measured
        most = max(values, key=lambda v: len({r.get(key) for r in some if r.get(fixed, 1) == v}))
        some = [r for r in some if r.get(fixed, 1) == most]
        if len({r.get(key) for r in some}) > 2:
            terms = [
                t for t in {r["term"]: None for r in some} if len({r.get(key) for r in some if r["term"] == t}) > 2
            ]
            some = [r for r in some if r["term"] in terms]
            yield _chart(f"{robot}: cost against {key}, {fixed} {most}", key, some, lambda r: r.get(key), "term")


def _chart(title: str, xlabel: str, rows: list[Row], x: Callable[[Row], Any], by: str) -> Chart:
    names = list(dict.fromkeys(r[by] for r in rows))[:SERIES]
    series = []
    for name in names:
        points = [
            (x(r), r["us_per_sample"], f"{name}, {xlabel} {x(r)}: {r['us_per_sample']:.4g} us a sample")
            for r in rows
            if r[by] == name
        ]
        series.append(Series(str(name), points))
    return Chart(title, xlabel, "us a sample", series)
