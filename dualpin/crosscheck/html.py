"""A report as one self-contained page without scripts: a matrix of robots and terms, coloured by error."""

from __future__ import annotations

from html import escape
from math import log10

from .results import Report, TermResult

_STYLE = """
:root { color-scheme: light dark; font: 15px/1.45 system-ui, sans-serif; }
body { max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-size: .85rem; }
th, td { padding: .2rem .5rem; border: 1px solid #8884; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; position: sticky; left: 0; background: Canvas; }
.verdict { font-size: 1.4rem; font-weight: 600; } .passed { color: #1a7f37; } .failed { color: #cf222e; }
td.bad { background: #cf222e; color: #fff; font-weight: 600; } td.none { opacity: .5; }
"""


def html(report: Report) -> str:
    verdict = "passed" if report.passed else "failed"
    terms = list(dict.fromkeys(t for r in report.robots for t in r.terms))
    head = "".join(f"<th scope=col>{escape(t)}</th>" for t in terms)
    rows = "".join(
        f"<tr><td>{escape(r.label)}</td><td>{r.nv}</td>" + "".join(_cell(r.terms.get(t)) for t in terms) + "</tr>"
        for r in report.robots
    )
    refused = "".join(
        f"<li>{escape(r.name)} ({'both libraries' if r.by_pinocchio else 'dualpin only'}): {escape(r.reason)}</li>"
        for r in report.refused
    )
    remarks = "".join(
        f"<li>{escape(r.label)}: {escape(n)}</li>" for r in report.robots for n in [*r.notes, r.error] if n
    )
    versions = "".join(f"<li>{escape(k)}: {escape(v)}</li>" for k, v in report.versions.items())
    samples = sorted({f"{r.samples} samples, seed {r.seed}" for r in report.robots})
    return (
        f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
        f"<title>dualpin validation: {verdict}</title><style>{_STYLE}</style>"
        f"<h1>Validation against Pinocchio</h1><p class='verdict {verdict}'>{verdict}"
        f"{' (partial)' if report.partial else ''}"
        f"</p><p>{len(report.robots)} robots; {escape('; '.join(samples))}. Each cell is the largest scaled error, "
        "max|x - ref| / max(1, max|ref|); its shade is the error's distance to the tolerance, which a hover shows.</p>"
        f"<div class=scroll><table><thead><tr><th scope=col>robot</th><th scope=col>nv</th>{head}</tr></thead>"
        f"<tbody>{rows}</tbody></table></div>"
        + (f"<h2>Refused files</h2><ul>{refused}</ul>" if refused else "")
        + (f"<h2>Remarks</h2><ul>{remarks}</ul>" if remarks else "")
        + f"<h2>Versions</h2><ul>{versions}</ul></html>"
    )


def _cell(t: TermResult | None) -> str:
    if t is None or not t.compared:
        return f"<td class=none title='{escape(t.note if t else '', quote=True)}'>-</td>"
    title = escape(f"tolerance {t.tolerance:.1e}: {t.reason}. {t.oracle}. {t.remark}", quote=True)
    if not t.passed:
        return f"<td class=bad title='{title}'>{t.max_scaled_error:.1e}</td>"
    ratio = t.max_scaled_error / t.tolerance if t.tolerance else 0.0
    shade = min(1.0, max(0.0, (log10(ratio) + 4) / 4)) if ratio > 0 else 0.0
    return f"<td style='background: rgb(210 153 34 / {0.55 * shade:.2f})' title='{title}'>{t.max_scaled_error:.1e}</td>"
