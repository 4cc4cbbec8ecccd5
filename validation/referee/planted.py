"""Which planted mistakes are named on which robot: `python -m validation.referee.planted [ROBOT...]`.

A student's code (`tests/crosscheck/planted.py`) makes one mistake at a time, or two; the diagnosis of `dp.judge` must
name it and nothing else.  Results of robots that are not asked are kept.
Writes planted.json and planted.md beside this file.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.subjects import QUESTIONS, asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.planted import FIXED, MISTAKES, PAIRS
from tests.crosscheck.student import Student

HERE = Path(__file__).parent
ROBOTS = {
    "probe": ("urdf/probe/probe.urdf", False),
    "panda": ("panda", False),
    "ur5": ("ur5", False),
    "solo12": ("solo12", True),
}
SAMPLES = 8


def outcome(asked: Any, wrong: tuple[str, ...]) -> dict[str, Any]:
    """What a mistake leads to: whether it shows, and what is said."""
    answers = ask_here(Student(asked.text, asked.floating, wrong), asked, lambda what: None)
    case = Case(answers)
    shows = bool(answers.history) or any(not case.score(t).right for t in answers.terms)
    found = diagnose(case)
    keys = sorted({f.key for f in found.findings})
    right = all(set(keys) & set(MISTAKES[w]) for w in wrong) and set(keys) <= {k for w in wrong for k in MISTAKES[w]}
    verdict = "invisible" if not shows and not keys else "named" if right else "missed"
    return {"verdict": verdict, "keys": keys, "seconds": round(found.seconds, 2)}


def main(names: list[str]) -> None:
    file = HERE / "planted.json"
    results = json.loads(file.read_text()) if file.exists() else {}
    for name in names or list(ROBOTS):
        robot, floating = ROBOTS[name]
        asked = asking(robot, SAMPLES, 0, tuple(QUESTIONS), floating=floating)
        chosen = [(m,) for m in (MISTAKES if floating else FIXED)] + (list(PAIRS) if name == "probe" else [])
        results[name] = {}
        for wrong in chosen:
            results[name]["+".join(wrong)] = found = outcome(asked, wrong)
            print(name, "+".join(wrong), found, file=sys.stderr, flush=True)
        old = json.loads(file.read_text()) if file.exists() else {}
        file.write_text(json.dumps({**old, name: results[name]}, indent=1) + "\n")
    write(json.loads(file.read_text()))


def write(results: dict[str, dict[str, Any]]) -> None:
    robots = [r for r in ROBOTS if r in results]
    lines = [
        "# Planted mistakes", "",
        "`python -m validation.referee.planted` switches one mistake on in a student's code",
        f"(tests/crosscheck/planted.py: NumPy, world frame, link by link; {SAMPLES} states); it must be named.",
        "*named*: by its key, and nothing else; *invisible*: nothing on this robot depends on it;",
        "**missed**: not named, or something else besides; -: not run on this robot.",
        "",
        "| robot | single mistakes | visible | named | pairs named |", "|---|---|---|---|---|",
    ]  # fmt: skip
    for r in robots:
        single = {k: x for k, x in results[r].items() if "+" not in k}
        pairs = [x["verdict"] == "named" for k, x in results[r].items() if "+" in k]
        visible = [x for x in single.values() if x["verdict"] != "invisible"]
        named = sum(x["verdict"] == "named" for x in visible)
        both = f"{sum(pairs)} of {len(pairs)}" if pairs else "-"
        lines.append(f"| {r} | {len(single)} | {len(visible)} | {named} | {both} |")
    lines += ["", "| mistake | " + " | ".join(robots) + " |", "|---|" + "---|" * len(robots)]
    for m in dict.fromkeys(m for r in robots for m in results[r]):
        cells = [results[r].get(m) for r in robots]
        lines.append(f"| {m} | " + " | ".join(_cell(c) for c in cells) + " |")
    (HERE / "planted.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _cell(found: dict[str, Any] | None) -> str:
    if found is None:
        return "-"
    if found["verdict"] == "missed":
        return f"**missed**: {', '.join(found['keys']) or 'nothing'}"
    return "invisible" if found["verdict"] == "invisible" else ", ".join(found["keys"])


if __name__ == "__main__":
    main(sys.argv[1:])
