"""A report for other tools: JUnit XML for test runners, SARIF for code hosts."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import Any
from urllib.parse import quote
from xml.etree.ElementTree import Element, SubElement, indent, tostring

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
    root = Element("testsuites", name="dualpin")
    for r in report.robots:
        suite = SubElement(root, "testsuite", name=clean(r.label), time=f"{r.seconds:.3f}")
        for term, t in r.terms.items():
            if t.status == NOT_COMPARED:
                junit_case(suite, term, "skipped", t.reason or NOT_COMPARED)
            elif t.passed:
                junit_case(suite, term)
            else:
                text = t.worst.get("reproduce", "") or t.remark
                junit_case(suite, term, "failure", _message(t), text, type=clean(t.verdict))
        if r.error:
            junit_case(suite, "robot", "error", r.error)
    if report.refused:
        suite = SubElement(root, "testsuite", name="files", time="0")
        for x in report.refused:
            if x.by_pinocchio:
                junit_case(suite, x.name, "skipped", f"refused by both: {x.reason}")
            else:
                junit_case(suite, x.name, "failure", x.reason, type="refused")
    return junit_text(root)


def junit_case(suite: Element, name: str, kind: str = "", message: str = "", text: str = "", **more: str) -> None:
    """Add a case that passed, or the failure, error or skip `kind`."""
    case = SubElement(suite, "testcase", classname=suite.get("name", ""), name=clean(name))
    if kind:
        SubElement(case, kind, {"message": clean(message), **more}).text = clean(text) or None


def junit_text(root: Element) -> str:
    """The text of a document of suites, each with its numbers of cases."""
    for suite in root:
        suite.set("tests", str(len(suite)))
        for kind, count in (("failure", "failures"), ("skipped", "skipped"), ("error", "errors")):
            suite.set(count, str(len(suite.findall(f"testcase/{kind}"))))
    indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def _message(t: TermResult) -> str:
    return f"scaled error {t.max_scaled_error:.1e}, at most {t.tolerance:.0e} allowed; {t.remark}"


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
    from .diagnosis import keys

    known = keys.keys()
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
