"""Reports as JSON documents, and back.

Reasons of tolerances are long and few: a document lists them once, and each term has the number of its own.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

from .results import Refusal, Report, RobotResult


def document(report: Report) -> dict[str, Any]:
    """What `restored` reads, in plain data."""
    robots = [asdict(r) for r in report.robots]
    terms = [t for r in robots for t in r["terms"].values()]
    reasons = list(dict.fromkeys(t["tolerance_reason"] for t in terms))
    for t in terms:
        t["tolerance_reason"] = reasons.index(t["tolerance_reason"])
    return {
        "passed": report.passed,
        "status": report.status,
        "engine": report.engine,
        "processor": report.processor,
        "partial": report.partial,
        "tolerance_reasons": reasons,
        "robots": robots,
        "refused": [asdict(r) for r in report.refused],
        "versions": report.versions,
    }


def restored(data: dict[str, Any]) -> Report:
    """The report of a document of this version or an earlier one, which had the reasons in the terms."""
    reasons, robots = data.get("tolerance_reasons", ()), []
    for r in data["robots"]:
        terms = {
            name: {**t, "tolerance_reason": reasons[t["tolerance_reason"]]} if reasons else t
            for name, t in r["terms"].items()
        }
        robots.append(RobotResult.from_dict({**r, "terms": terms}))
    refused = [Refusal(**r) for r in data["refused"]]
    return Report(robots, refused, data["versions"], data.get("partial", False))


def text(report: Report) -> str:
    """The document as JSON: not-a-number as null, infinities as the largest number."""
    return json.dumps(_finite(document(report)), indent=1)


def _finite(x: Any) -> Any:
    if isinstance(x, dict):
        return {k: _finite(v) for k, v in x.items()}
    if isinstance(x, list):
        return [_finite(v) for v in x]
    if isinstance(x, float) and x != x:
        return None
    if isinstance(x, float) and abs(x) == float("inf"):
        return 1.7976931348623157e308 if x > 0 else -1.7976931348623157e308
    return x
