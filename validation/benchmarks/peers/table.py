"""The runs of all processors as Markdown, the newest first."""

from __future__ import annotations

import statistics
from typing import Any


def markdown(runs: list[dict[str, Any]]) -> str:
    text = [
        "# Speed beside other libraries\n",
        "Written by `make bench-peers`. Each peer in a process and environment of its own, one thread, double\n"
        "precision, fixed base, three times the velocities of the description's limits; results are equal before\n"
        "and after, or the cell is left out and the list says by how much they differ. Cells: microseconds a sample\n"
        "of the peer / times as long as dualpin takes (above 1 dualpin is faster), by medians of runs in turns; in\n"
        "brackets the peer's spread. dualpin's batches have `out=` and store all results. Loops in C and C++ do not\n"
        "store theirs, and their single calls are without Python, where dualpin's are calls from Python.\n",
    ]
    for run in runs:
        text += [_run(run)]
    return "\n".join(text)


def _run(run: dict[str, Any]) -> str:
    m = run["machine"]
    text = [
        f"## {run['processor']}, {run['date']}\n",
        f"{m['cores']} cores, vectors of {m['vector_bits']} bits, {m['system']}, Python {m['python']}, "
        f"dualpin {m['dualpin']}, llvmlite {m['llvmlite']}; {run['repetitions']} runs in turns, load {run['load']}, "
        f"{run['seconds']} s.\n",
    ]
    rows = [r for r in run["rows"] if "ratio" in r]
    for many, title in ((True, "Batches"), (False, "One state a call")):
        for robot in dict.fromkeys(r["robot"] for r in rows):
            chosen = [r for r in rows if r["robot"] == robot and (r["batch"] > 1) == many]
            if chosen:
                size = f" of {chosen[0]['batch']}" if many else ""
                text += [f"### {title}{size}: {robot}\n", _table(chosen)]
    slower = [r for r in rows if r["ratio"] < 1]
    text += ["### Where dualpin is not the fastest\n"]
    if slower:
        text += [
            f"- {r['robot']} `{r['term']}`, {'batch' if r['batch'] > 1 else 'one state'}: {r['peer']} ({r['how']}) "
            f"takes {r['peer_us']:.3g} us, dualpin {r['us']:.3g} us."
            for r in slower
        ]
    else:
        text += ["In no cell of this run."]
    skipped: dict[tuple[str, str], list[str]] = {}
    for r in run["rows"]:
        if "skipped" in r and r["skipped"] != "not offered":
            why = skipped.setdefault((r["peer"], r["skipped"]), [])
            why.append(f"{r['robot']} {r.get('term', '')}".strip())
    if skipped:
        text += ["\n### Not measured\n"]
        text += [f"- {peer}: {', '.join(dict.fromkeys(x))}: {_plain(why)}" for (peer, why), x in skipped.items()]
    return "\n".join(text) + "\n"


def _table(rows: list[dict[str, Any]]) -> str:
    terms = list(dict.fromkeys(r["term"] for r in rows))
    names = list(dict.fromkeys(r["peer"] for r in rows))
    ours = {t: statistics.median(r["us"] for r in rows if r["term"] == t) for t in terms}
    lines = ["| | how | " + " | ".join(f"`{t}`" for t in terms) + " |", "|" + "---|" * (len(terms) + 2)]
    lines += ["| **dualpin** | `robot.kernel(term)` | " + " | ".join(f"**{ours[t]:.3g}**" for t in terms) + " |"]
    for name in names:
        found = {r["term"]: r for r in rows if r["peer"] == name}
        first = next(iter(found.values()))
        cells = [_cell(found.get(t)) for t in terms]
        how = " / ".join(dict.fromkeys(r["how"] for r in found.values()))
        lines.append(f"| {name} {first['version']} | {how} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _cell(r: dict[str, Any] | None) -> str:
    if r is None:
        return ""
    low, high = r["peer_spread"]
    return f"{r['peer_us']:.3g} / **{r['ratio']:.3g}** [{low:.3g}, {high:.3g}]"


def _plain(why: str) -> str:
    return " ".join(why.split())[:160].replace("|", "/").replace("<", "(").replace(">", ")")
