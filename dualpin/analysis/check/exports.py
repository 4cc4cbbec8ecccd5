"""Findings for other tools: JUnit XML for test runners, SARIF for code hosts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ...crosscheck.exports import clean, junit_case, junit_text, sarif_log
from .findings import Checked, Finding
from .rules import RULES


def junit(checked: Sequence[Checked]) -> str:
    """One suite a file, one case a rule: failed where the rule found something."""
    root = Element("testsuites", name="dualpin check")
    for c in checked:
        suite = SubElement(root, "testsuite", name=clean(c.name))
        for rule in RULES:
            found = [f for f in c.findings if f.rule == rule]
            if found:
                message, text = f"{found[0].item}: {found[0].says}", "\n".join(map(str, found))
                junit_case(suite, rule, "failure", message, text, type=found[0].severity)
            else:
                junit_case(suite, rule)
    return junit_text(root)


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
