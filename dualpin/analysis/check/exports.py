"""Findings for other tools: JUnit XML for test runners, SARIF for code hosts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree

from ...crosscheck.exports import clean, sarif_log
from .findings import Checked, Finding
from .rules import RULES


def junit(checked: Sequence[Checked]) -> str:
    """One suite a file, one case a rule: failed where the rule found something."""
    root = ElementTree.Element("testsuites", name="dualpin check")
    for c in checked:
        by_rule = {rule: [f for f in c.findings if f.rule == rule] for rule in RULES}
        suite = ElementTree.SubElement(
            root, "testsuite", name=clean(c.name), tests=str(len(by_rule)),
            failures=str(sum(bool(x) for x in by_rule.values())), errors="0", skipped="0",
        )  # fmt: skip
        for rule, found in by_rule.items():
            case = ElementTree.SubElement(suite, "testcase", classname=clean(c.name), name=rule)
            if found:
                failure = ElementTree.SubElement(
                    case, "failure", type=found[0].severity, message=clean(f"{found[0].item}: {found[0].says}")
                )
                failure.text = clean("\n".join(map(str, found)))
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def sarif(checked: Sequence[Checked]) -> str:
    """One result for each finding."""
    used = {f.rule for c in checked for f in c.findings}
    rules = [
        {"id": r.id, "shortDescription": {"text": r.says}, "defaultConfiguration": {"level": r.severity}}
        for r in RULES.values()
        if r.id in used
    ]
    return sarif_log([_result(f) for c in checked for f in c.findings], rules)


def _result(f: Finding) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": {"uri": f.file}}
    if f.line:
        place["region"] = {"startLine": f.line}
    text = "; ".join(
        x for x in (f"{f.item}: {f.says}" if f.item else f.says, f.why, f"fix: {f.fix}" if f.fix else "") if x
    )
    location = {"physicalLocation": place, "logicalLocations": [{"name": f.item or "robot"}]}
    return {"ruleId": f.rule, "level": f.severity, "message": {"text": text}, "locations": [location]}
