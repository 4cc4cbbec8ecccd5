"""Thousands of robots on one page: all of them as a table that is drawn a page at a time, details of the worst."""

from __future__ import annotations

from typing import Any

# `RobotView` and `Cell` of `matrix`, which imports this file
View = Any
Cell = Any

MANY = 400
"""From how many robots a page is drawn in parts: their details would be 20 kB each."""
SHOWN = 200
"""Of how many robots details are given then."""
DOTS = 300
"""Of a strip chart's row, at most."""


def worst(robots: list[View]) -> list[View]:
    """Those that fail, differ, were not compared, or come nearest to a tolerance, in the order of the report."""
    order = {"✗": 0, "≠": 1, "–": 2, "✓": 3}
    chosen = sorted(robots, key=lambda r: (order[r.mark], -r.ratio))[:SHOWN]
    return sorted(chosen, key=lambda r: r.number)


def rows(robots: list[View], shown: list[View]) -> list[list[Any]]:
    """Of each robot: label, base, nv, mark, status, largest ratio, link or "", then shade and text of every cell."""
    linked = {r.number for r in shown}
    return [
        [
            r.result.label, r.base, r.result.nv, r.mark, r.result.status, float(f"{r.ratio:.3g}"),
            r.id if r.number in linked else "", *(f"{c.shade} {c.text}" for c in r.cells),
        ]
        for r in robots
    ]  # fmt: skip


def thinned(points: list[tuple[View, Cell]]) -> list[tuple[View, Cell]]:
    """The points of a row of dots: all that are out of tolerance, the largest, and some of the rest."""
    if len(points) <= DOTS:
        return points
    points = sorted(points, key=lambda rc: -(rc[1].ratio or 0.0))
    bad = [rc for rc in points if rc[1].shade == "bad"]
    rest = [rc for rc in points if rc[1].shade != "bad"]
    step = max(1, 2 * len(rest) // DOTS)
    return bad[:DOTS] + rest[: DOTS // 2] + rest[DOTS // 2 :: step]
