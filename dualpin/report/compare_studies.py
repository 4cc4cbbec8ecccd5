"""What changed between two studies of integrators: errors, evaluations, and notes on a run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from .changes import LAST_DIGITS, Change, Comparison
from .read import Row, Study, is_number

MEASURED = ("error", "drift", "peak", "late", "seconds", "evaluations", "steps", "wall", "cost")
"""Words in the name of a column that holds results of a run; all other plain columns are its settings."""
ERRORS = ("error", "drift", "peak", "late")


def studies(found: Comparison, old: Study, new: Study) -> Iterable[Change]:
    """The differences of runs with the same settings, table by table; changed settings come first."""
    for name, rows in old.tables.items():
        if not any("method" in r for r in rows):
            continue
        before, after = _runs(rows), _runs(new.tables.get(name, []))
        for setting in sorted(before.keys() - after.keys()):
            yield Change("missing", setting, "run", "absent", True)
        for setting in sorted(after.keys() - before.keys()):
            yield Change("new", setting, "absent", "run", False)
        for setting, row in after.items():
            if setting in before:
                yield from _run(found, setting, before[setting], row)


def _run(found: Comparison, setting: str, old: Row, new: Row) -> Iterable[Change]:
    for key in (k for k in new if _is(k, ERRORS) and k in old):
        x, y = old[key], new[key]
        finite = [is_number(v) for v in (x, y)]
        if not all(finite):
            if finite[0] != finite[1]:
                yield Change("error", f"{setting}: {key}", _text(x), _text(y), not finite[1], 1.0)
            continue
        found.compared += 1
        factor = max(abs(y), LAST_DIGITS) / max(abs(x), LAST_DIGITS)
        yield from found.changed("error", f"{setting}: {key}", f"{x:.2e}", f"{y:.2e}", factor)
    for key in ("evaluations", "rhs_evaluations"):
        if isinstance(old.get(key), int) and isinstance(new.get(key), int) and old[key]:
            yield from found.changed("evaluations", setting, str(old[key]), str(new[key]), new[key] / old[key])
    said, says = _kinds(old), _kinds(new)
    for kind in says - said:
        yield Change("remark", setting, "-", kind, True)
    for kind in said - says:
        yield Change("remark", setting, kind, "-", False, 0.5)


def _runs(rows: Sequence[Row]) -> dict[str, Row]:
    """The rows by their settings: the columns that are not measurements."""
    keys = [k for k in dict.fromkeys(k for r in rows for k in r) if not _is(k, MEASURED)]
    plain = [k for k in keys if not any(isinstance(r.get(k), (list, dict)) for r in rows)]
    return {", ".join(f"{k} {_text(r[k])}" for k in plain if r.get(k) is not None): r for r in rows}


def _is(column: str, words: Sequence[str]) -> bool:
    return any(w in column for w in words)


def _kinds(row: Row) -> set[str]:
    """The kinds of the notes on a run: the words before the colon."""
    return {str(w).partition(":")[0] for w in row.get("warnings") or ()}


def _text(x: Any) -> str:
    return "not finite" if x is None else f"{x:g}" if isinstance(x, float) else str(x)
