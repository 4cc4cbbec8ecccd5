"""A measured result as a document: title, versions and machine, date, settings, notes and rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ..machine import versions


def document(
    title: str,
    rows: Iterable[Mapping[str, Any]],
    *,
    settings: Mapping[str, Any] | None = None,
    notes: Iterable[str] = (),
    command: str = "",
    **more: Any,
) -> dict[str, Any]:
    """Rows with everything that is needed to understand and repeat them, ready for JSON.

    Parameters
    ----------
    title : str
        The heading of a page of it.
    rows : iterable of mappings
        Flat records.
    settings : mapping, optional
        The settings of the run, as plain values.
    notes : iterable of str
        Notes on the rows.
    command : str
        The command that does it again.
    **more
        Further parts of the document.

    Returns
    -------
    dict
        "title", "header" (versions, processor, date, command), "settings", "notes", "rows", and what else was given.

    Examples
    --------
    >>> from dualpin.report import document, study
    >>> found = document("two robots", [{"robot": "ur5", "mass": 18.4}, {"robot": "panda", "mass": 16.9}])
    >>> sorted(found), "processor" in found["header"]
    (['header', 'notes', 'rows', 'settings', 'title'], True)
    >>> study(found).title
    'two robots'
    """
    stated = versions()
    header = {"command": command, "date": stated.pop("date"), "processor": stated.pop("machine"), **stated}
    return {
        "title": title,
        "header": {k: v for k, v in header.items() if v},
        "settings": dict(settings or {}),
        "notes": list(notes),
        "rows": [dict(r) for r in rows],
        **more,
    }
