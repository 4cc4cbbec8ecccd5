"""The table of the referee as Markdown: who agrees in what, and every cause by its name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from dualpin.crosscheck.findings import CONVENTIONS
from dualpin.crosscheck.subjects import QUESTIONS
from dualpin.machine import versions

Reports = dict[str, dict[str, dict[str, Any]]]
HEAD = """# Libraries, judged

Twenty robots of example-robot-data (six of them on a floating base), 16 random states each, every term that a library
has, asked in the library's own words. A number counts robots. A term *agrees* if every entry is within 1e-9 of
dualpin, or within what the condition of the mass matrix allows; 50 digits decide who is right where the last digits
differ. *Convention*: the answers agree once they are read as the library means them; that is no error. *Differs*: the
cause is below, by name, or said to be unknown. *Silent*: the library refused the robot, raised, crashed or hung.

A file is given to a library as it is; what it does by default with damping, friction or `<mimic>` counts as its answer,
and is worded as what it is: another meaning of "inverse dynamics", not a fault of arithmetic.
Libraries with a compiler of their own (JaxSim, Brax, MJX) were asked about three robots, since each takes minutes.
Where numbers of a library add up to fewer robots than these, the others were not run.
What dualpin itself lacks, and some of these libraries have: contacts, closed loops, soft bodies, actuators, tendons,
collision, simulation; see "Where dualpin is not the best choice" in the documentation. `make referee` makes this page;
`dualpin judge ROBOT SUBJECT` shows one pair in full, with a state and a call that reproduces the difference. Faults of
libraries, each in a file that shows it: [bugs](bugs); what releases changed: [history](history).
"""


def page(reports: Reports) -> str:
    """The whole page."""
    machine = versions()
    made = f"dualpin {machine['dualpin']}, {machine['machine']}; written {machine['date']}"
    lines = [HEAD, f"{made}. Cells that were not judged again stand as they were.", "", *summary(reports), ""]
    for title, robots in reports.items():
        lines += [*library(title, robots), ""]
    return "\n".join(lines)


def summary(reports: Reports) -> list[str]:
    """Libraries x terms."""
    terms = [t for t in QUESTIONS if any(verdict(r, t) != "not offered" for x in reports.values() for r in x.values())]
    rows = [f"| library | {' | '.join(terms)} |", "|---" * (len(terms) + 1) + "|"]
    for title, robots in reports.items():
        version = next((r["version"] for r in robots.values() if r["version"]), "")
        rows.append(f"| {title} {version} | {' | '.join(cell(robots, t) for t in terms)} |")
    return ["## Terms", "", *rows, "", "agrees / convention / differs / silent; empty: not offered"]


def cell(robots: dict[str, dict[str, Any]], term: str) -> str:
    """Robots by verdict; a library that has read a robot, and has no such term, is not silent about another."""
    read = [verdict(r, term) for r in robots.values() if not r["reason"]]
    if read and set(read) == {"not offered"}:
        return ""
    counts = {
        w: sum(verdict(r, term) == w for r in robots.values()) for w in ("agrees", "convention", "differs", "silent")
    }
    return "/".join(map(str, counts.values())) if any(counts.values()) else ""


def verdict(robot: dict[str, Any], term: str) -> str:
    """agrees, convention, differs, silent or not offered."""
    if robot["reason"]:
        return "silent"
    t = robot["terms"].get(term, {"status": "not compared", "reason": "not offered"})
    if t["status"] == "agrees":
        return "agrees"
    if t["status"] == "differs":
        keys = [f["key"] for f in t["findings"]]
        return "convention" if keys and set(keys) <= CONVENTIONS else "differs"
    return "not offered" if t.get("reason", "").startswith("not offered") else "silent"


def library(title: str, robots: dict[str, dict[str, Any]]) -> list[str]:
    """The causes found in one library, and what it did not answer."""
    version = next((r["version"] for r in robots.values() if r["version"]), "")
    lines = [f"## {title} {version}".rstrip(), ""]
    causes: dict[tuple[str, str, str], dict[str, set[str]]] = {}
    for label, term, finding in found(robots):
        at = causes.setdefault(
            (finding["key"], _short(finding["says"]), finding.get("fix", "")), {"of": set(), "in": set()}
        )
        at["of"].add(label)
        at["in"].add(term)
    unnamed = [
        f"{label}: {name} ({t.get('reason', '')})" for label, r in robots.items() for name, t in r["terms"].items()
        if t["status"] == "differs" and not t["findings"]
    ]  # fmt: skip
    silent: dict[str, set[str]] = {}
    for label, r in robots.items():
        if r["reason"]:
            silent.setdefault(_refused(r), set()).add(label)
        for name, t in r["terms"].items():
            if not r["reason"] and verdict(r, name) == "silent":
                silent.setdefault(f"{name}: {_short(t.get('reason', ''))}", set()).add(label)
    if causes:
        lines += ["| key | what it is | terms | robots | what to change |", "|---|---|---|---|---|"]
        for (key, says, fix), at in sorted(causes.items()):
            which = ", ".join(t for t in QUESTIONS if t in at["in"])
            lines.append(f"| {key} | {_cell(says)} | {which} | {_few(sorted(at['of']))} | {_cell(fix)} |")
    lines += [f"- cause unknown: {x}" for x in unnamed]
    lines += [f"- silent, {_cell(why)}: {_few(sorted(of))}" for why, of in sorted(silent.items())]
    return lines if len(lines) > 2 else [*lines, "Nothing found."]


def found(robots: dict[str, dict[str, Any]]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for label, r in robots.items():
        for term, t in r["terms"].items():
            for finding in t["findings"]:
                yield label, term, finding


def _short(text: str) -> str:
    """The kind of a message: without the names of joints and the figures that follow a colon."""
    return (
        " ".join(text.split())[:160].rsplit(": ", 1)[0]
        if text.count(": ") and len(text) > 60
        else " ".join(text.split())
    )


def _refused(robot: dict[str, Any]) -> str:
    """Why a library did not read a robot: what in the file, where that was found, and its own message."""
    told = robot.get("refusal")
    return (
        f"refused: {told['says'].split(': it says')[0]}; to be read: {told['fix']}" if told else _short(robot["reason"])
    )


def _few(names: list[str]) -> str:
    return ", ".join(names) if len(names) <= 6 else f"{', '.join(names[:5])} and {len(names) - 5} more"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;").replace("\n", " ")
