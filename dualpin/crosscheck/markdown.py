"""A report as Markdown: what was compared, the verdict, the worst error of each term."""

from __future__ import annotations

from ..escape import markdown as escape
from .findings import Finding
from .results import DIFFERS, NOT_COMPARED, Report, RobotResult, TermResult


def markdown(report: Report) -> str:
    verdict = report.verdict.upper()
    subjects = list(dict.fromkeys(f"{r.subject} {r.subject_version}".strip() for r in report.robots if r.subject))
    settings = sorted({(r.samples, r.seed) for r in report.robots})
    lines = [
        f"# {'Judgement of ' + ', '.join(subjects) if subjects else 'Validation'}: {verdict}",
        "",
        f"{len(report.robots)} robots ({report.headline}), "
        + ", ".join(f"{n} samples from seed {s}" for n, s in settings)
        + f"; {len(report.refused)} files refused.",
        "",
        "Scaled error of a term: the largest over the samples of max|x - ref| / max(1, max|ref|).",
        "",
        *(f"- {key}: {value}" for key, value in report.versions.items()),
        "",
    ]
    if len(report.robots) == 1:
        lines += _one(report.robots[0])
    else:
        lines += [*_terms(report), "", *_robots(report)]
    for title, status in (("Differs", DIFFERS), ("Not compared", NOT_COMPARED)):
        found = [r for r in report.robots if r.status == status]
        if found:
            lines += ["", f"## {title}", "", *(f"- **{escape(r.label)}**: {escape(r.remark)}" for r in found)]
    if report.findings:
        lines += ["", "## Findings", "", *(line for f in report.findings for line in _finding(f))]
    if report.refused:
        lines += ["", "## Refused files", "", "| file | by | reason |", "|---|---|---|"]
        lines += [
            f"| {escape(r.name)} | {'both' if r.by_pinocchio else 'dualpin only'} | {escape(r.reason)} |"
            for r in report.refused
        ]
    remarks = [
        (r.label, note) for r in report.robots for note in r.notes if "mimic:" in note or len(report.robots) == 1
    ]
    if remarks:
        lines += ["", "## Remarks", "", *(f"- {escape(label)}: {escape(note)}" for label, note in remarks)]
    return "\n".join(lines) + "\n"


def _finding(f: Finding) -> list[str]:
    """One cause, what else it may be, and what to do."""
    lines = [f"- `{f.key}` {escape(str(f))}"]
    lines += [f"    - as well explained by: {escape(' / '.join(f.alternatives))}"] if f.alternatives else []
    return lines + ([f"    - fix: {escape(f.fix)}"] if f.fix else [])


def _one(r: RobotResult) -> list[str]:
    rows = [
        f"| {name} | {' | '.join(t.figures)} | {_bold(t)} | {t.oracle} | {escape(t.remark)} |"
        for name, t in r.terms.items()
    ]
    head = ["| term | max scaled error | tolerance | verdict | oracle | remark |", "|---|---|---|---|---|---|"]
    return [f"## {escape(r.label)} (nv = {r.nv})", "", *head, *rows]


def _terms(report: Report) -> list[str]:
    """The worst robot of each term."""
    rows = ["## Terms", "", "| term | worst scaled error | of | its tolerance | robots |", "|---|---|---|---|---|"]
    for name in dict.fromkeys(t for r in report.robots for t in r.terms):
        having = [r for r in report.robots if name in r.terms and r.terms[name].compared]
        if having:
            worst = max(having, key=lambda r: r.terms[name].max_scaled_error)
            error, tolerance = worst.terms[name].figures
            rows.append(f"| {name} | {error} | {escape(worst.label)} | {tolerance} | {len(having)} |")
    return rows


def _robots(report: Report) -> list[str]:
    rows = ["## Robots", "", "| robot | nv | worst scaled error | in | verdict | remark |", "|---|---|---|---|---|---|"]
    for r in report.robots:
        worst, error = r.worst
        partly = ", ".join(f"{k} ({t.note.split(' not')[0]})" for k, t in r.terms.items() if t.note)
        remark = "; ".join(x for x in (r.remark, partly and f"samples not compared: {partly}") if x)
        rows.append(f"| {escape(r.label)} | {r.nv} | {error} | {worst} | {_bold(r)} | {escape(remark)} |")
    return rows


def _bold(of: TermResult | RobotResult) -> str:
    """The verdict, in bold where it fails."""
    return of.verdict if of.passed else f"**{of.verdict}**"
