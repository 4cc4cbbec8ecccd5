"""The runs of all processors as Markdown, the newest first."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Iterator
from typing import Any


def markdown(runs: list[dict[str, Any]]) -> str:
    text = [
        "# Speed beside other libraries\n",
        "Written by `make bench-peers`. Each peer in a process and environment of its own, one thread, double\n"
        "precision, fixed base, three times the velocities of the description's limits; results are equal before\n"
        "and after, or the cell is left out and the list says by how much they differ. Cells: microseconds a sample\n"
        "of the peer / times as long as dualpin takes (above 1 dualpin is faster), by medians of runs in turns; in\n"
        "brackets the peer's spread. dualpin's batches have `out=` and store all results; loops in C and C++ do not\n"
        "store theirs, except that of our own exported C. Single calls of a peer from Python stand beside ours from\n"
        "Python; those in a loop of C or C++ beside our kernel in a loop of machine code (one state a call, results\n"
        "stored), and in parentheses beside our call from Python.\n",
    ]
    for run in runs:
        text += [_run(run)]
    return "\n".join(text)


def _run(run: dict[str, Any]) -> str:
    m = run["machine"]
    repetitions = _range(r.get("repetitions", 7) for r in run["rows"])
    text = [
        f"## {run['processor']}, {run['date']}\n",
        f"{m['cores']} cores, vectors of {m['vector_bits']} bits, {m['system']}, Python {m['python']}, "
        f"dualpin {m['dualpin']}, llvmlite {m['llvmlite']}; {repetitions} runs in turns, load "
        f"{_range(run['loads'])}, {run['seconds']} s.\n",
    ]
    rows = [r for r in run["rows"] if "ratio" in r]
    for many, title in ((True, "Batches"), (False, "One state a call")):
        for robot in dict.fromkeys(r["robot"] for r in rows):
            chosen = [r for r in rows if r["robot"] == robot and (r["batch"] > 1) == many]
            if chosen:
                size = f" of {chosen[0]['batch']}" if many else ""
                text += [f"### {title}{size}: {robot}\n", _table(chosen)]
    text += ["### Where dualpin is not the fastest\n"]
    text += [said for r in rows for said in _slower(r)] or ["In no cell of this run."]
    skipped: dict[tuple[str, str], list[str]] = {}
    for r in run["rows"]:
        if "skipped" in r and r["skipped"] != "not offered":
            why = skipped.setdefault((r["peer"], r["skipped"]), [])
            why.append(f"{r['robot']} {r.get('term', '')}".strip())
    if skipped:
        text += ["\n### Not measured\n"]
        text += [f"- {peer}: {', '.join(dict.fromkeys(x))}: {_plain(why)}" for (peer, why), x in skipped.items()]
    return "\n".join(text) + "\n"


def _range(values: Iterable[float]) -> str:
    found = sorted(set(values))
    return f"{found[0]}" if len(found) == 1 else f"{found[0]} to {found[-1]}" if found else "none"


def _slower(r: dict[str, Any]) -> Iterator[str]:
    """What is to be said of a cell in which the peer takes less: by its own like, and beside a call from Python."""
    ways = {"loop_": "our kernel in a loop", "": "our call from Python"} if "loop_us" in r else {"": "dualpin"}
    for way, what in ways.items():
        if r[f"{way}ratio"] < 1 and r["peer"] != OWN:
            many = "batch" if r["batch"] > 1 else "one state"
            yield (
                f"- {r['robot']} `{r['term']}`, {many}: {r['peer']} ({r['how']}) takes {r['peer_us']:.3g} us, "
                f"{what} {r[f'{way}us']:.3g} us."
            )


OWN = "dualpin_c"
"""The peer that is our own exported C."""


def _table(rows: list[dict[str, Any]]) -> str:
    terms = list(dict.fromkeys(r["term"] for r in rows))
    names = list(dict.fromkeys(r["peer"] for r in rows))
    ours = {t: statistics.median(r["us"] for r in rows if r["term"] == t) for t in terms}
    lines = ["| | how | " + " | ".join(f"`{t}`" for t in terms) + " |", "|" + "---|" * (len(terms) + 2)]
    lines += ["| **dualpin** | `robot.kernel(term)` | " + " | ".join(f"**{ours[t]:.3g}**" for t in terms) + " |"]
    loops = {t: [r["loop_us"] for r in rows if r["term"] == t and "loop_us" in r] for t in terms}
    if any(loops.values()):
        cells = [f"**{statistics.median(loops[t]):.3g}**" if loops[t] else "" for t in terms]
        lines += [f"| **dualpin** | its kernel in a loop of machine code | {' | '.join(cells)} |"]
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
    like, python = (r["loop_ratio"], f" ({r['ratio']:.3g})") if "loop_ratio" in r else (r["ratio"], "")
    return f"{r['peer_us']:.3g} / **{like:.3g}**{python} [{low:.3g}, {high:.3g}]"


def _plain(why: str) -> str:
    return " ".join(why.split())[:160].replace("|", "/").replace("<", "(").replace(">", ")")
