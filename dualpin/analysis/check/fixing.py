"""Certain corrections, made in the text of the file without other changes."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator
from xml.sax.saxutils import quoteattr

from ...errors import ArgumentError
from .findings import Checked, Edit

# skips comments, processing instructions, CDATA and declarations; attribute values of start tags are quoted
_MARKUP = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<![^>]*>"
    r"|<(?P<name>[^\s<>/!?=\"']+)(?P<attributes>(?:\s+[^\s<>/=\"']+\s*=\s*(?:\"[^\"]*\"|'[^']*'))*)\s*/?>",
    re.DOTALL,
)


def fixed(checked: Checked) -> str:
    """The file's text with every certain correction.

    Parameters
    ----------
    checked : Checked
        Of `dualpin.check`.

    Returns
    -------
    str
        Empty where there is neither a text nor a correction.

    Raises
    ------
    ArgumentError
        If it has no text that can be edited: a robot in memory, MJCF, a file with faults of markup.

    Examples
    --------
    >>> from dualpin.analysis.check import Checked, Edit, Finding, fixed
    >>> text = '<robot name="r"><link name="a"/></robot>'
    >>> found = Finding("named", "note", "a is no name", edits=[Edit(1, "name", "base")])
    >>> fixed(Checked("r", [found], text=text))
    '<robot name="r"><link name="base"/></robot>'
    """
    edits = [e for f in checked.findings for e in f.edits]
    if checked.text is None:
        if not edits:
            return ""
        raise ArgumentError(f"fix: {checked.name} has no text that can be changed element by element")
    return applied(checked.text, edits)


def diff(checked: Checked, name: str, new: str) -> str:
    r"""The corrections as a unified diff.

    Parameters
    ----------
    checked : Checked
        Of `dualpin.check`.
    name : str
        Of the file, in the first lines.
    new : str
        Its text with the corrections, of `fixed`.

    Returns
    -------
    str

    Examples
    --------
    >>> from dualpin.analysis.check import Checked, diff
    >>> print(diff(Checked("r", text="a\n"), "r.urdf", "b\n"), end="")
    --- r.urdf
    +++ r.urdf
    @@ -1 +1 @@
    -a
    +b
    """
    old = (checked.text or "").splitlines(keepends=True)
    return "".join(difflib.unified_diff(old, new.splitlines(keepends=True), name, name))


def applied(text: str, edits: Iterable[Edit]) -> str:
    """The text with attributes of some elements replaced."""
    wanted: dict[int, list[Edit]] = {}
    for e in edits:
        wanted.setdefault(e.element, []).append(e)
    out, at = [], 0
    for count, match in enumerate(_starts(text)):
        for e in wanted.get(count, ()):
            start, end = _value(match, e.attribute)
            if start >= at:  # the same change twice is one
                out += [text[at:start], quoteattr(e.value)]
                at = end
    return "".join([*out, text[at:]])


def _starts(text: str) -> Iterator[re.Match[str]]:
    return (m for m in _MARKUP.finditer(text) if m["name"])


def _value(tag: re.Match[str], attribute: str) -> tuple[int, int]:
    """The position of an attribute's quoted value in the text."""
    found = re.compile(rf"\s{re.escape(attribute)}\s*=\s*(\"[^\"]*\"|'[^']*')").search(
        tag.string, *tag.span("attributes")
    )
    if found is None:
        raise ArgumentError(f"fix: <{tag['name']}> has no attribute {attribute!r}")
    return found.span(1)
