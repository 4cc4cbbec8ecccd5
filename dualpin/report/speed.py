"""Measurements of speed: ratios to Pinocchio, and how the cost grows with batch, threads and degrees of freedom."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from .chart import Chart, Series
from .read import Row, Study

SERIES = 8  # more lines than that in one chart cannot be told apart
CHARTS = 8


@dataclass
class Ratios:
    """How many times faster than Pinocchio, robots x terms, under one setting."""

    setting: str
    terms: list[str]
    rows: list[tuple[str, list[tuple[float, str] | None]]]


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
    def columns(self) -> list[str]:
        return list(dict.fromkeys(key for r in self.rows for key, v in r.items() if not isinstance(v, (list, dict))))


def speedup(row: Row) -> float | None:
    """Pinocchio's time over ours."""
    theirs, ours = row.get("pinocchio_us_per_sample"), row["us_per_sample"]
    return theirs / ours if isinstance(theirs, (int, float)) and ours else None


def _ratios(rows: list[Row]) -> Iterable[Ratios]:
    """One matrix for each number of threads, at its largest batch, and one for single configurations."""
    settings = dict.fromkeys((r.get("threads", 1), r.get("batch")) for r in rows if speedup(r) is not None)
    by_threads: dict[Any, list[Any]] = {}
    for threads, batch in settings:
        by_threads.setdefault(threads, []).append(batch)
    for threads, batches in sorted(by_threads.items(), key=lambda item: str(item[0])):
        sizes = [b for b in batches if isinstance(b, (int, float))] or batches
        for batch in dict.fromkeys((max(sizes), min(sizes))):
            some = [r for r in rows if r.get("threads", 1) == threads and r.get("batch") == batch and speedup(r)]
            terms = list(dict.fromkeys(r["term"] for r in some))
            robots: dict[str, dict[str, Row]] = {}
            for r in some:
                robots.setdefault(r["robot"], {})[r["term"]] = r
            cells = [(name, [_ratio(of.get(t)) for t in terms]) for name, of in robots.items()]
            threads_text = "1 thread" if threads == 1 else f"{threads} threads"
            yield Ratios(f"batch {batch}, {threads_text}", terms, cells)


def _ratio(row: Row | None) -> tuple[float, str] | None:
    if row is None:
        return None
    return (
        speedup(row) or 0.0,
        f"{row['robot']}, {row['term']}: {row['us_per_sample']:.4g} us a sample, "
        f"Pinocchio {row['pinocchio_us_per_sample']:.4g} us",
    )


def _dof(rows: list[Row]) -> Iterable[Chart]:
    """Cost against degrees of freedom, at the largest batch of one thread."""
    key = next((k for k in ("nv", "dof") if any(k in r for r in rows)), None)
    if key is None:
        return
    rows = [r for r in rows if r.get("threads", 1) == 1]
    batch = max((r.get("batch", 1) for r in rows), default=1)
    rows = [r for r in rows if r.get("batch", 1) == batch]
    if len({r.get(key) for r in rows}) > 3:
        yield _chart(
            f"Cost against degrees of freedom, batch {batch}", "degrees of freedom", rows, lambda r: r.get(key), "term"
        )


def _scaling(rows: list[Row], key: str, fixed: str) -> Iterable[Chart]:
    """Cost against batch or threads, a chart a robot."""
    for robot in dict.fromkeys(r["robot"] for r in rows):
        some = [r for r in rows if r["robot"] == robot]
        values = {r.get(fixed, 1) for r in some}
        # the setting of the other quantity under which most was measured
        most = max(values, key=lambda v: len({r.get(key) for r in some if r.get(fixed, 1) == v}))
        some = [r for r in some if r.get(fixed, 1) == most]
        if len({r.get(key) for r in some}) > 2:
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
