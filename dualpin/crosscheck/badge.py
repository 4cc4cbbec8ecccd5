"""A report as a badge: a small SVG that loads nothing, for the head of a README."""

from __future__ import annotations

from ..escape import html, line
from .results import AGREES, DIFFERS, NOT_COMPARED, Report

GREEN, AMBER, RED, GREY = "#2e7d32", "#a15c00", "#b3261e", "#616161"
"""Each at least 4.5 : 1 against white (WCAG 2.1, 1.4.3)."""
CONVENTION = "agrees under another convention"
_LETTER, _MARGIN = 6.6, 12  # px: width of an average letter at 11 px, and the margin at both sides of a text


def said(report: Report) -> tuple[str, str]:
    """What the badge says, and its colour.

    Terms that were not compared are counted against those that were; what a subject does not offer is not.
    """
    if report.partial:
        return "partial", AMBER
    if not report.passed or report.findings:
        return _failed(report)
    if report.status == NOT_COMPARED:
        return NOT_COMPARED, GREY
    terms = [(name, t) for r in report.robots for name, t in r.terms.items()]
    terms = [(name, t) for name, t in terms if not t.reason.startswith("not offered")]
    having, compared = {name for name, _ in terms}, {name for name, t in terms if t.compared}
    count = f"{len(compared)} {'of ' + str(len(having)) + ' ' if having != compared else ''}terms"
    robots = f", {len(report.robots)} robots" if len(report.robots) > 1 else ""
    if report.status == DIFFERS:  # and passed: the side that is judged is nearer to 50 digits
        verdicts = dict.fromkeys(t.verdict for _, t in terms if t.status == DIFFERS)
        return f"{' / '.join(verdicts)} | {count}{robots}", AMBER
    return f"{AGREES} | {count}{robots}", GREEN if having == compared else AMBER


def _failed(report: Report) -> tuple[str, str]:
    """The gravest failure."""
    if any(r.error for r in report.robots):
        return "failed", RED
    off = [t for r in report.robots for t in r.terms.values() if t.status == DIFFERS or t.findings]
    if off:
        if all(t.verdict.startswith(AGREES) for t in off):
            return CONVENTION, AMBER
        wrong = sum(not t.verdict.startswith(AGREES) for t in off)
        return f"{DIFFERS} | {wrong} {'term' if wrong == 1 else 'terms'}", RED
    if any(r.status == DIFFERS for r in report.robots):
        return DIFFERS, RED
    return ("refused", RED) if report.refused else (NOT_COMPARED, GREY)


def badge(report: Report, label: str = "dualpin") -> str:
    """The badge of a report as SVG.

    Parameters
    ----------
    report : Report
    label : str
        The left half.

    Returns
    -------
    str
        An SVG document of its own, 20 px high.

    Examples
    --------
    >>> import dualpin as dp
    >>> "dualpin: agrees | 2 terms" in dp.validate("ur5", samples=2, terms=["fk", "com"]).badge()
    True
    """
    text, color = said(report)
    left, right = _width(label), _width(text)
    title, shown, name = (html(line(x)) for x in (f"{label}: {text}", text, label))
    size = f'width="{left + right}" height="20"'
    return f"""<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="{title}">
<title>{title}</title>
<clipPath id="r"><rect {size} rx="3"/></clipPath>
<g clip-path="url(#r)">
<rect width="{left}" height="20" fill="#424242"/>
<rect x="{left}" width="{right}" height="20" fill="{color}"/>
</g>
<g fill="#fff" text-anchor="middle" font-family="Verdana, DejaVu Sans, sans-serif" font-size="11">
<text x="{left / 2:g}" y="14" textLength="{left - _MARGIN}" lengthAdjust="spacingAndGlyphs">{name}</text>
<text x="{left + right / 2:g}" y="14" textLength="{right - _MARGIN}" lengthAdjust="spacingAndGlyphs">{shown}</text>
</g>
</svg>
"""


def _width(text: str) -> int:
    """Of one half, in px; `textLength` fits any font into it."""
    return round(_LETTER * max(1, len(line(text)))) + _MARGIN
