"""An outcome as a table, and its small cases as files."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..files import write_text, writing
from .run import Outcome
from .small import SmallCase


def to_dict(outcome: Outcome) -> dict[str, Any]:
    """As plain data for JSON."""
    return {
        "passed": outcome.passed,
        "partial": outcome.partial,
        "robots": outcome.robots,
        "seed": outcome.seed,
        "verdicts": dict(outcome.verdicts),
        "kinds": [
            {"term": term, "nearer": nearer, "robots": len(numbers), "first": numbers[:10]}
            for (term, nearer), numbers in outcome.kinds.items()
        ],
        "compared": dict(outcome.compared),
        "worst": outcome.worst,
        "not_compared": [{"term": t, "reason": r, "robots": n} for (t, r), n in outcome.silent.most_common()],
        "cases": [asdict(c) for c in outcome.cases],
        "versions": outcome.versions,
    }


def to_markdown(outcome: Outcome) -> str:
    """Tables of what agreed, what differed and who is nearer, and what could not be compared."""
    v = outcome.versions
    lines = [
        f"# {outcome.robots} random robots",
        "",
        f"`dualpin fuzz --robots {outcome.robots} --seed {outcome.seed}`: dualpin {v['dualpin']}, Pinocchio "
        f"{v.get('pinocchio', '')}, numpy {v['numpy']}, {v['date']}.",
        "",
        ", ".join(f"{n} {verdict}" for verdict, n in outcome.verdicts.most_common()) + ".",
        "",
        "## What differs",
        "",
        "| term | nearer to 50 digits | robots | a small robot that shows it | difference | allowed "
        "| dualpin off by | Pinocchio off by |",
        "| --- | --- | ---: | --- | ---: | ---: | --- | --- |",
    ]
    shown = {(c.term, c.nearer): c for c in reversed(outcome.cases)}
    for kind, numbers in outcome.kinds.items():
        cells = _cells(shown[kind]) if kind in shown else [""] * 5
        lines.append(f"| {' | '.join([*kind, str(len(numbers)), *cells])} |")
    lines += [
        "",
        "## What agrees",
        "",
        "| term or identity | robots | largest error / tolerance |",
        "| --- | ---: | ---: |",
    ]
    lines += [f"| {t} | {n} | {outcome.worst.get(t, 0.0):.3f} |" for t, n in outcome.compared.items()]
    lines += ["", "## What was not compared", "", "| term or identity | why | robots |", "| --- | --- | ---: |"]
    lines += [f"| {t} | {reason.replace('|', '/')} | {n} |" for (t, reason), n in outcome.silent.most_common()]
    return "\n".join(lines) + "\n"


def _cells(case: SmallCase) -> list[str]:
    off = [_off(case, who) for who in ("dualpin", "oracle")]
    return [f"[{_name(case)}](cases/{_name(case)}.json)", f"{case.error:.1e}", f"{case.tolerance:.1e}", *off]


def _off(case: SmallCase, who: str) -> str:
    """The error by the definition in 50 digits (scaled), and the proved bounds of the entry."""
    found = [f"{case.against_50_digits[who]:.1e}"] if who in case.against_50_digits else []
    if who in case.enclosed:
        least, most = case.enclosed[who]
        found.append(f"proved {least:.3g}" + (f" to {most:.3g}" if f"{most:.3g}" != f"{least:.3g}" else ""))
    return ", ".join(found)


def _name(case: SmallCase) -> str:
    return f"{case.term.replace(': ', '-')}-{case.nearer}-{case.spec.name}"


def write(outcome: Outcome, folder: str | Path) -> list[Path]:
    """README.md, fuzz.json and, for each small case, a JSON file and a URDF where one can hold it.

    Raises
    ------
    ArgumentError
        If the folder cannot be written.
    """
    folder = Path(folder)
    texts = {"README.md": to_markdown(outcome), "fuzz.json": json.dumps(to_dict(outcome), indent=1) + "\n"}
    for case in outcome.cases:
        texts[f"cases/{_name(case)}.json"] = case.spec.to_json() + "\n"
        if case.urdf:
            texts[f"cases/{_name(case)}.urdf"] = case.urdf
    with writing(f"fuzz: cannot write into {folder}"):
        for name, text in texts.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            write_text(folder / name, text)
    return [folder / name for name in texts]
