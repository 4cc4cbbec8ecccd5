"""Results as Markdown: those of one processor, and the index of all."""

from __future__ import annotations

import re
from typing import Any

TARGETS = {
    # term: (arms, humanoids, tiago_dual)
    "rnea": (40, 25, 20), "fk": (15, 10, 5), "jacobian": (15, 10, 5), "crba": (30, 10, 6), "aba": (30, 25, 25),
    "coriolis": (24, 10, 7), "rnea_derivatives": (15, 7, None),
}  # fmt: skip
GROUP = {"ur5": 0, "panda": 0, "talos": 1, "g1": 1, "tiago_dual": 2}


def table(head: list[str], rows: list[list[Any]]) -> str:
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(cell(x) for x in row) + " |" for row in rows]) + "\n"


def cell(x: Any) -> str:
    return f"{x:.3g}" if isinstance(x, float) else str(x)


def ratios(rows: list[dict[str, Any]], batch: int) -> str:
    """Terms by robots: microseconds a sample / times faster, with the aim where one is set."""
    names = list(dict.fromkeys((r["robot"], r["floating"]) for r in rows))
    terms = list(dict.fromkeys(r["term"] for r in rows))
    found = {(r["term"], r["robot"], r["floating"]): r for r in rows if r["batch"] == batch}
    lines = []
    for term in terms:
        line: list[Any] = [f"`{term}`"]
        for name, floating in names:
            r = found.get((term, name, floating))
            if r is None:
                line.append("")
                continue
            aim = TARGETS.get(term, (None,) * 3)[GROUP.get(name, 1)] if batch > 1 and not floating else None
            short = f" (aim {aim})" if aim and r["best_ratio"] < aim else ""
            filled = r["best_pinocchio_us_per_sample"] / max(r.get("fill_us_per_sample", 0.0), 1e-9)
            if short and filled < 2 * aim:
                short = f" (aim {aim}; filling the result alone {filled:.1f})"
            line.append(f"{r['best_us_per_sample']:.3g} / **{r['best_ratio']:.1f}** / {r['ratio']:.1f}{short}")
        lines.append(line)
    return table(["", *(f"{n}{' + floating' if f else ''}" for n, f in names)], lines)


INDEX = ("ur5", "panda", "talos")
"""Robots whose rows the index shows for each processor."""


def named(processor: str) -> str:
    """The name of a processor's file: "AMD EPYC (znver4)" is amd-epyc-znver4."""
    return "-".join(re.findall(r"[a-z0-9]+", re.sub(r"\((R|TM)\)", " ", processor).lower()))


def span(made: dict[str, dict[str, Any]], key: str) -> str:
    """The values of all parts of a run: one, or the first and the last."""
    found = sorted({x[key] for x in made.values()})
    return f"{found[0]}" if len(found) == 1 else f"{found[0]} to {found[-1]}"


def commits(made: dict[str, dict[str, Any]]) -> str:
    return ", ".join(dict.fromkeys(x["commit"] for x in made.values()))


def index(every: dict[str, dict[str, Any]]) -> str:
    """All processors by the names of their files: when each was measured, and a few rows side by side."""
    rows = [
        [f"[{r['machine']['processor']}](results/{name}.md)", r["machine"]["cores"], r["machine"]["vector_bits"],
         span(r["made"], "date"), span(r["made"], "dualpin"), commits(r["made"]), span(r["made"], "load"),
         len(r["made"])]
        for name, r in every.items()
    ]  # fmt: skip
    text = [
        "# Speed beside Pinocchio\n",
        "Written by `python -m validation.benchmarks`, which measures on the processor that it runs on and keeps the "
        "tables of all others with their dates.\n",
        table(["processor", "cores", "bits of a vector", "date", "dualpin", "commit", "load", "parts"], rows),
        "## Batches of 4096 on one thread\n",
        "Microseconds a sample / times faster than Pinocchio (its loops in C++ for `rnea` and `aba`, otherwise a loop "
        "in Python), by the shortest runs.\n",
    ]
    found = {
        (name, r["robot"], r["term"]): f"{r['best_us_per_sample']:.3g} / {r['best_ratio']:.1f}"
        for name, results in every.items()
        for r in results.get("main", ())
        if r["batch"] > 1 and not r["floating"] and r["robot"] in INDEX
    }
    cells = dict.fromkeys(x[1:] for x in found)
    lines = [[f"{robot} `{term}`", *(found.get((name, robot, term), "") for name in every)] for robot, term in cells]
    return "\n".join([*text, table(["", *(r["machine"]["processor"] for r in every.values())], lines)])


def markdown(results: dict[str, Any]) -> str:
    """The tables of one processor."""
    m, made, key = results["machine"], results["made"], "load"
    text = [
        f"# Speed beside Pinocchio: {m['processor']}\n",
        f"Measured {span(made, 'date')} by `{results['command']}`: {m['processor']}, {m['cores']} cores, vectors of "
        f"{m['vector_bits']} bits, {m['system']}; Python {m['python']}, dualpin {span(made, 'dualpin')} "
        f"(commit {commits(made)}), numpy {m['numpy']}, llvmlite {m['llvmlite']}, pin {m['pin']} ({m['pin_is']}).  "
        "float64.\n",
        "Both measured in turns in one process, after they were found to agree.  Load average after each part: "
        f"{', '.join(f'{name} {about[key]}' for name, about in made.items())}.\n",
    ]
    if "main" in results:
        text += [
            "## Batches of 4096 on one thread\n",
            "Microseconds a sample / times faster than Pinocchio, by the shortest runs of both / by the medians: "
            "against `rneaInParallel(1)` and `abaInParallel(1)`, "
            "its C++ loops, and for other terms against a Python loop over its calls. Where an aim is missed and "
            "writing is why, the last figure is what NumPy's `fill` of an array like the result would reach.\n",
            ratios(results["main"], 4096),
            "## One configuration\n",
            "`robot.kernel(term)` with `out=` against Pinocchio's call from Python.\n",
            ratios(results["main"], 1),
        ]
    if "single" in results:
        keys = ["robot", "term", "kernel_us", "function_us", "pinocchio_us"]
        rows = [
            [*(r[k] for k in keys), r["pinocchio_us"] / r["kernel_us"], r["pinocchio_us"] / r["function_us"]]
            for r in results["single"]
        ]
        text += [
            "## One configuration: kernel, function, Pinocchio\n",
            table([*keys, "ratio", "ratio (function)"], rows),
        ]
    for name, title, keys in (
        ("batch", "By batch (panda)", ["term", "batch", "us_per_sample", "pinocchio_us_per_sample", "ratio"]),
        ("threads", "Two threads", ["robot", "term", "batch", "one_us", "two_us", "speedup"]),
        ("dof", "By degrees of freedom (serial chains, batch 1024)",
         ["dof", "term", "operations", "us_per_sample", "pinocchio_us_per_sample", "ratio"]),
        ("memory", "Memory", ["robot", "term", "bytes_per_sample", "scratch_bytes", "operations"]),
        ("compile", "Trace and compile, cold", ["robot", "term", "operations", "seconds", "kilobytes"]),
        ("cold_start", "A new process to its first torques", ["robot", "cold_s", "warm_s"]),
    ):  # fmt: skip
        if name in results:
            text += [f"## {title}\n", table(keys, [[r[k] for k in keys] for r in results[name]])]
    return "\n".join(text)
