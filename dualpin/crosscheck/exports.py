"""A report for other tools: JUnit XML for test runners, SARIF for code hosts."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import Any
from urllib.parse import quote
from xml.etree import ElementTree

from .. import __version__
from .findings import CONVENTIONS
from .results import DIFFERS, NOT_COMPARED, Report, RobotResult, TermResult

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
SARIF = "https://json.schemastore.org/sarif-2.1.0.json"


def junit(report: Report) -> str:
    """One suite a robot (and subject), one case a term: failed where it differs, skipped where it was not compared.

    Files that did not become a robot are cases of a suite of their own: failed, or skipped where Pinocchio refuses
    them too.
    """
    root = ElementTree.Element("testsuites", name="dualpin")
    for r in report.robots:
        failed = [t for t, x in r.terms.items() if not x.passed]
        skipped = [t for t, x in r.terms.items() if x.status == NOT_COMPARED]
        suite = ElementTree.SubElement(
            root, "testsuite", name=clean(r.label), tests=str(len(r.terms) + bool(r.error)), failures=str(len(failed)),
            skipped=str(len(skipped)), errors="1" if r.error else "0", time=f"{r.seconds:.3f}",
        )  # fmt: skip
        for term, t in r.terms.items():
            case = ElementTree.SubElement(suite, "testcase", classname=clean(r.label), name=term)
            if t.status == NOT_COMPARED:
                ElementTree.SubElement(case, "skipped", message=clean(t.reason or NOT_COMPARED))
            elif not t.passed:
                failure = ElementTree.SubElement(case, "failure", type=clean(t.verdict), message=_message(t))
                failure.text = clean(t.worst.get("reproduce", "") or t.remark)
        if r.error:
            case = ElementTree.SubElement(suite, "testcase", classname=clean(r.label), name="robot")
            ElementTree.SubElement(case, "error", message=clean(r.error))
    if report.refused:
        ours = [x for x in report.refused if not x.by_pinocchio]
        suite = ElementTree.SubElement(
            root, "testsuite", name="files", tests=str(len(report.refused)), failures=str(len(ours)),
            skipped=str(len(report.refused) - len(ours)), errors="0", time="0",
        )  # fmt: skip
        for x in report.refused:
            case = ElementTree.SubElement(suite, "testcase", classname="files", name=clean(x.name))
            if x.by_pinocchio:
                ElementTree.SubElement(case, "skipped", message=clean(f"refused by both: {x.reason}"))
            else:
                ElementTree.SubElement(case, "failure", type="refused", message=clean(x.reason))
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _message(t: TermResult) -> str:
    return clean(f"scaled error {t.max_scaled_error:.1e}, at most {t.tolerance:.0e} allowed; {t.remark}")


def clean(text: str) -> str:
    """Without what XML cannot hold."""
    return _FORBIDDEN.sub("", str(text))


def sarif(report: Report) -> str:
    """One result for each finding, each term that differs without one, each file refused, each robot not compared."""
    results = [x for r in report.robots for x in _results(r)]
    results += [
        _said("refused", "warning" if r.by_pinocchio else "error", r.reason, r.name, r.name) for r in report.refused
    ]
    return sarif_log(results, _rules(dict.fromkeys(x["ruleId"] for x in results)))


def _rules(names: Iterable[str]) -> list[dict[str, Any]]:
    """What code hosts show beside a result: what a key says, and what to do."""
    from .diagnosis.keys import keys

    known = keys()
    return [
        {"id": name, "shortDescription": {"text": known[name][0]}, "help": {"text": known[name][1]}}
        if name in known
        else {"id": name}
        for name in names
    ]


def sarif_log(results: list[dict[str, Any]], rules: list[dict[str, Any]]) -> str:
    """Results and the rules that they name, as one run of this tool."""
    tool = {"name": "dualpin", "version": __version__, "rules": rules}
    run = {"tool": {"driver": tool}, "results": results}
    return json.dumps({"$schema": SARIF, "version": "2.1.0", "runs": [run]}, indent=1) + "\n"


def _results(r: RobotResult) -> list[dict[str, Any]]:
    who = r.subject or r.name
    if r.error:
        return [_said("failed", "error", r.error, r.name, who)]
    out, seen = [], []
    for term, t in r.terms.items():
        for f in t.findings:
            if f not in seen:
                seen.append(f)
                text = f"{f}" + (f"; fix: {f.fix}" if f.fix else "")
                level = "note" if f.key in CONVENTIONS else "error"  # another convention is no mistake
                out.append(_said(f.key, level, text, r.name, who))
        if t.status == DIFFERS and not t.findings:
            text = f"{term}: scaled error {t.max_scaled_error:.1e}; {t.remark or t.verdict}"
            out.append(_said(f"differs/{term}", "warning" if t.passed else "error", text, r.name, who))
    if r.status == NOT_COMPARED and not out and r.reason:
        out.append(_said("not-compared", "warning", r.reason, r.name, who))
    return out


def _said(rule: str, level: str, text: str, file: str, who: str) -> dict[str, Any]:
    uri = quote(file.replace("\\", "/"), safe="/:@!$&'()*+,;=~")
    location = {"physicalLocation": {"artifactLocation": {"uri": uri}}, "logicalLocations": [{"name": who}]}
    return {"ruleId": rule, "level": level, "message": {"text": text}, "locations": [location]}
