"""Rows as tables on a terminal: all of them, as wide as the terminal is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..escape import line
from .show import console

GAP = "  "
KEYS = 2  # leading columns of words that every part of a wide table repeats


def show_rows(name: str, rows: Sequence[dict[str, Any]], columns: Sequence[str] | None = None) -> None:
    """Records as a whole table.

    A column that is the same in all rows is said once above it.  What does not fit the width becomes a second table
    with the same first columns.  Lists and mappings, which a cell does not hold, are named below.
    """
    for text in text_of(name, rows, columns, console().width):
        print(text)


def text_of(name: str, rows: Sequence[dict[str, Any]], columns: Sequence[str] | None, width: int) -> list[str]:
    """The lines of `show_rows`."""
    from ..report.matrix import number

    if not rows:
        return [f"{line(name)}: no rows"]
    every = list(dict.fromkeys(k for r in rows for k in r)) if columns is None else list(columns)
    nested = [k for k in every if any(isinstance(r.get(k), (list, tuple, dict)) for r in rows)]
    plain = [k for k in every if k not in nested]
    cells = {k: [line(number(r.get(k))) for r in rows] for k in plain}
    same = [k for k in plain if len(rows) > 1 and len(set(cells[k])) == 1] if columns is None else []
    lines = [f"{line(name)}: {len(rows)} {'row' if len(rows) == 1 else 'rows'}"] if name else []
    if any(cells[k][0] for k in same):
        lines.append("in all rows: " + ", ".join(f"{line(k)} {cells[k][0]}" for k in same if cells[k][0]))
    columns = [k for k in plain if k not in same]
    widths = {k: max(len(line(k)), *map(len, cells[k])) for k in columns}
    words = {k for k in columns if not any(isinstance(r.get(k), (int, float)) for r in rows)}
    for part in _parts(columns, widths, words, width):
        lines += [""] * bool(lines)
        texts = [[line(k), *cells[k]] for k in part]
        for row in zip(*texts, strict=True):
            padded = (c.ljust(widths[k]) if k in words else c.rjust(widths[k]) for k, c in zip(part, row, strict=True))
            lines.append(GAP.join(padded).rstrip())
    if nested:
        lines.append(f"not shown: {', '.join(map(line, nested))} (--json has them)")
    return lines


def _parts(columns: list[str], widths: dict[str, int], words: set[str], width: int) -> list[list[str]]:
    """The columns cut into tables that fit, each with the leading columns of words."""
    keys: list[str] = []
    for k in columns[:KEYS]:
        if k not in words or 2 * sum(widths[c] + len(GAP) for c in [*keys, k]) > width:
            break
        keys.append(k)
    parts, room = [list(keys)], width - sum(widths[k] + len(GAP) for k in keys)
    left = room
    for k in columns[len(keys):]:  # fmt: skip
        if widths[k] > left and len(parts[-1]) > len(keys):
            parts.append(list(keys))
            left = room
        parts[-1].append(k)
        left -= widths[k] + len(GAP)
    return parts
