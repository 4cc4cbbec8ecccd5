"""A report as Markdown: what was compared, the verdict, the worst error of each term."""

from __future__ import annotations

from .results import Report, RobotResult


def markdown(report: Report) -> str:
    verdict = "PASSED" if report.passed else "PARTIAL" if report.partial else "FAILED"
    settings = sorted({(r.samples, r.seed) for r in report.robots})
    lines = [
        f"# Validation: {verdict}",
        "",
        f"{len(report.robots)} robots, "
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
    failed = [r for r in report.robots if not r.passed]
    if failed:
        lines += ["", "## Out of tolerance", ""]
        for r in failed:
            lines += [f"- **{r.label}**: {r.error or ', '.join(k for k, t in r.terms.items() if not t.passed)}"]
    if report.refused:
        lines += ["", "## Refused files", "", "| file | by | reason |", "|---|---|---|"]
        lines += [
            f"| {r.name} | {'both' if r.by_pinocchio else 'dualpin only'} | {r.reason.replace('|', '/')} |"
            for r in report.refused
        ]
    remarks = [
        (r.label, note) for r in report.robots for note in r.notes if "mimic:" in note or len(report.robots) == 1
    ]
    if remarks:
        lines += ["", "## Remarks", "", *(f"- {label}: {note}" for label, note in remarks)]
    return "\n".join(lines) + "\n"


def _one(r: RobotResult) -> list[str]:
    rows = [
        f"| {name} | {t.max_scaled_error:.1e} | {t.tolerance:.1e} | {'yes' if t.passed else '**NO**'} "
        f"| {t.oracle} | {t.remark} |"
        for name, t in r.terms.items()
    ]
    head = ["| term | max scaled error | tolerance | passed | oracle | note |", "|---|---|---|---|---|---|"]
    return [f"## {r.label} (nv = {r.nv})", "", *head, *rows]


def _terms(report: Report) -> list[str]:
    """The worst robot of each term."""
    rows = ["## Terms", "", "| term | worst scaled error | of | its tolerance | robots |", "|---|---|---|---|---|"]
    for name in dict.fromkeys(t for r in report.robots for t in r.terms):
        having = [r for r in report.robots if name in r.terms and r.terms[name].compared]
        if having:
            worst = max(having, key=lambda r: r.terms[name].max_scaled_error)
            t = worst.terms[name]
            rows.append(f"| {name} | {t.max_scaled_error:.1e} | {worst.label} | {t.tolerance:.1e} | {len(having)} |")
    return rows


def _robots(report: Report) -> list[str]:
    rows = [
        "## Robots",
        "",
        "| robot | nv | worst scaled error | in | passed | not compared |",
        "|---|---|---|---|---|---|",
    ]
    for r in report.robots:
        compared = {k: t for k, t in r.terms.items() if t.compared}
        worst = max(compared, key=lambda k: compared[k].max_scaled_error, default="-")
        error = f"{compared[worst].max_scaled_error:.1e}" if compared else "-"
        missing = ", ".join(f"{k} ({t.note.split(' not')[0]})" for k, t in r.terms.items() if t.note)
        rows.append(f"| {r.label} | {r.nv} | {error} | {worst} | {'yes' if r.passed else '**NO**'} | {missing} |")
    return rows
