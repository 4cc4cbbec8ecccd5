"""Recognise a result file by its contents."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..crosscheck.results import Report
from ..errors import ArgumentError
from ..renamed import Renamed

Row = dict[str, Any]
SPEED = {"robot", "term", "us_per_sample"}
"""The columns that make a row a measurement of speed."""
HEADERS = ("header", "versions", "settings", "machine", "environment")
"""Mappings that say where and with what a result was measured."""


@dataclass(frozen=True)
class Curve:
    """A sequence of numbers at equal distances, up to an end."""

    name: str
    xlabel: str
    end: float
    values: list[float]

    @property
    def points(self) -> list[tuple[float, float]]:
        n = len(self.values)
        return [(self.end * (k + 1) / n, y) for k, y in enumerate(self.values) if y is not None]


@dataclass(repr=False)
class Study:
    """One result file, read.

    Attributes
    ----------
    subject : str
        "validation", "speed", "integrators" or "records" (anything else that has rows).
    name : str
        Its name on the page: the file's name, or "validation".
    report : Report or None
        The validation.
    tables : dict of str to list of dict
        The rows of the other kinds.
    curves : dict of str to list of Curve
        Sequences over turns, time or samples, under what they belong to.
    header : dict of str to str
        Versions, machine, date, settings.
    title : str
        The document's own heading, if it has one.
    notes : list of str
        What it says about itself.
    """

    subject: str
    name: str
    report: Report | None = None
    tables: dict[str, list[Row]] = field(default_factory=dict)
    curves: dict[str, list[Curve]] = field(default_factory=dict)
    header: dict[str, str] = field(default_factory=dict)
    title: str = ""
    notes: list[str] = field(default_factory=list)
    kind = Renamed("subject")

    def __repr__(self) -> str:
        held = repr(self.report) if self.report is not None else f"{len(self.rows)} rows in {len(self.tables)} tables"
        return f"<Study {self.name!r}: {self.subject}, {held}>"

    @property
    def rows(self) -> list[Row]:
        """The rows of all tables."""
        return [row for rows in self.tables.values() for row in rows]


def read(path: str | Path) -> Study:
    """Read one result file.

    Parameters
    ----------
    path : str or Path
        JSON of `dualpin validate --json`, of `dualpin bench --json`, of the integrator study, or any
        document that holds lists of flat records.

    Returns
    -------
    Study

    Raises
    ------
    ArgumentError
        If the file cannot be read, is no JSON, or holds nothing that is known.

    Examples
    --------
    >>> import tempfile, dualpin as dp
    >>> from dualpin.report import read
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path, = dp.validate("ur5", samples=2, terms=["fk"]).write(folder, ["json"])
    ...     read(path).subject
    'validation'
    """
    path = Path(path)
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as e:
        raise ArgumentError(f"report: cannot read {path} ({e.strerror or e})") from None
    except ValueError as e:
        raise ArgumentError(f"report: {path} is not JSON ({e})") from None
    return study(data, f"{path.parent.name}/{path.name}" if path.parent.name else path.name)


def study(data: Any, name: str = "result") -> Study:
    """As `read`, from what the JSON document holds.

    Parameters
    ----------
    data : dict or list
    name : str
        What to call it.

    Returns
    -------
    Study

    Raises
    ------
    ArgumentError
        If it holds nothing that is known.

    Examples
    --------
    >>> from dualpin.report import study
    >>> study([{"robot": "panda", "term": "rnea", "us_per_sample": 0.05}]).subject
    'speed'
    """
    if isinstance(data, Mapping) and isinstance(data.get("robots"), list) and "refused" in data:
        try:
            report = Report.from_dict(dict(data))
        except (LookupError, TypeError, AttributeError) as e:
            raise ArgumentError(f"report: {name} is not a report of `dualpin validate --json` ({e!r})") from None
        return Study("validation", name, report, header=dict(report.versions))
    tables, curves = dict(_tables(data)), dict(_curves(data))
    if not tables and not curves:
        raise ArgumentError(
            f"report: {name} holds no result; expected a report of `dualpin validate --json`, the rows of "
            "`dualpin bench --json`, or lists of flat records"
        )
    columns = {key for rows in tables.values() for row in rows for key in row}
    kind = "speed" if columns >= SPEED else "integrators" if "method" in columns else "records"
    header = _header(data)
    said = data.get("notes") if isinstance(data, Mapping) else None
    notes = [str(n) for n in said] if isinstance(said, list) else []
    return Study(kind, name, tables=tables, curves=curves, header=header, title=header.pop("title", ""), notes=notes)


def _tables(data: Any, path: str = "") -> Iterable[tuple[str, list[Row]]]:
    """Every list of flat records in a document, and every mapping to flat records, by where it sits."""
    if isinstance(data, list) and data and all(isinstance(row, Mapping) for row in data):
        yield path or "rows", [dict(row) for row in data]
    elif isinstance(data, Mapping):
        flat = {k: v for k, v in data.items() if isinstance(v, Mapping) and _is_flat(v)}
        if path and len(flat) > 1:
            yield path, [{"of": k, **v} for k, v in flat.items()]
        if path and not path.endswith(HEADERS) and len(data) > 2 and all(is_number(v) for v in data.values()):
            yield path, [{"of": k, "value": v} for k, v in data.items()]
        for key, value in data.items():
            yield from _tables(value, f"{path}.{key}" if path else str(key))


def _curves(data: Any, path: str = "") -> Iterable[tuple[str, list[Curve]]]:
    """Every mapping whose entries hold a list "by_...": how far it goes is said beside it or above."""
    if not isinstance(data, Mapping):
        return
    found = []
    for name, entry in data.items():
        if not isinstance(entry, Mapping):
            continue
        for key, values in entry.items():
            if str(key).startswith("by_") and isinstance(values, list) and values:
                steps = entry.get("steps", data.get("turns", data.get("steps", len(values))))
                timed = "steps" in entry and is_number(data.get("dt"))
                xlabel = "time in s" if timed else "turns" if key == "by_turn" else "steps"
                found.append(Curve(str(name), xlabel, steps * data["dt"] if timed else steps, values))
    if found:
        yield path or "curves", found
    for key, value in data.items():
        yield from _curves(value, f"{path}.{key}" if path else str(key))


def is_number(x: object) -> bool:
    """Of JSON, where true and false are none."""
    return isinstance(x, (int, float)) and not isinstance(x, bool)


def _is_flat(entry: Mapping[str, Any]) -> bool:
    return (
        bool(entry)
        and any(is_number(v) for v in entry.values())
        and not any(isinstance(v, Mapping) for v in entry.values())
    )


def _header(data: Any) -> dict[str, str]:
    """The plain values of a document, and of its header."""
    found: dict[str, str] = {}
    if isinstance(data, Mapping):
        for key, value in data.items():
            if isinstance(value, Mapping) and key in HEADERS:
                found |= {str(k): str(v) for k, v in value.items() if isinstance(v, (str, int, float))}
            elif isinstance(value, (str, int, float)):
                found[str(key)] = str(value)
    return found
