"""Results as Markdown."""

from __future__ import annotations

from typing import Any

from ..report import table


def rate(n: int, seconds: float) -> str:
    """Samples a second, in millions."""
    return f"{n / seconds / 1e6:,.0f}" if n / seconds > 1e7 else f"{n / seconds / 1e6:.2g}"


def markdown(results: dict[str, Any]) -> str:
    m = results["machine"]
    text = [
        "# GPU kernels\n",
        f"Measured {results['when']} by `{results['command']}`: {m['device']}, {m['multiprocessors']} multiprocessors, CUDA "
        f"driver {m['driver'] // 1000}.{m['driver'] % 1000 // 10}, memory {m['bytes_per_second'] / 1e12:.2f} TB/s by a copy on "
        f"the device (read and written counted); {m['cores']} cores, {m['system']}, Python {m['python']}, dualpin "
        f"{m['dualpin']}, numpy {m['numpy']}, llvmlite {m['llvmlite']}.\n",
    ]
    if "throughput" in results:
        text += throughput(results["throughput"])
    if "peers" in results:
        text += peers(results["peers"], results.get("throughput", []))
    if "correctness" in results:
        text += correctness(results["correctness"])
    return "\n".join(text)


def throughput(rows: list[dict[str, Any]]) -> list[str]:
    batches = list(dict.fromkeys(r["batch"] for r in rows))
    keys = list(dict.fromkeys((r["robot"], r["floating"], r["term"], r["dtype"]) for r in rows))
    found = {(r["robot"], r["floating"], r["term"], r["dtype"], r["batch"]): r for r in rows}
    equal = all(r.get("equal", True) for r in rows)
    lines = []
    for robot, floating, term, dtype in keys:
        line: list[Any] = [f"{robot}{' + floating' if floating else ''}", f"`{term}`", dtype]
        for n in batches:
            r = found[robot, floating, term, dtype, n]
            cells = [rate(n, r[k]) if k in r else "-" for k in ("device_seconds", "call_seconds", "copied_seconds")]
            line.append(" / ".join(cells) if "left_out" not in r else f"({r['left_out']})")
        lines.append(line)
    said = (
        "All results were equal to the host's kernels, bit for bit, before and after."
        if equal
        else "SOME RESULTS DIFFER."
    )
    return [
        "## Throughput\n",
        "Millions of samples a second: by the device's clock, data on the device / by calls from Python one after the other, "
        f"data on the device / with arguments and results copied from and to ordinary memory of the host.  {said}\n",
        table(["robot", "term", "type", *(f"{n:,}" for n in batches)], lines),
    ]


def peers(rows: list[dict[str, Any]], ours: list[dict[str, Any]]) -> list[str]:
    mine = {(r["robot"], r["term"], r["dtype"], r["batch"]): r for r in ours if "call_seconds" in r}
    batches = list(dict.fromkeys(r["batch"] for r in rows if "batch" in r))
    keys = list(dict.fromkeys((r["robot"], r["term"], r["dtype"], r["peer"]) for r in rows if "call_seconds" in r))
    found = {(r["robot"], r["term"], r["dtype"], r["peer"], r.get("batch")): r for r in rows if "term" in r}
    lines = []
    for robot, term, dtype, peer in sorted(keys):
        line: list[Any] = [robot, f"`{term}`", dtype, peer]
        for n in batches:
            r = found.get((robot, term, dtype, peer, n), {})
            own = mine.get((robot, term, dtype, n))
            if "call_seconds" not in r:
                line.append("-")
                continue
            ratio = f" ({r['call_seconds'] / own['call_seconds']:.0f}x)" if own else ""
            line.append(rate(n, r["call_seconds"]) + ratio + ("" if r["equal"] else " DIFFERS"))
        lines.append(
            [
                *line,
                f"{max(found[robot, term, dtype, peer, n].get('difference', 0.0) for n in batches if (robot, term, dtype, peer, n) in found):.1e}",
            ]
        )
    absent = [f"- {r['peer']}, {r['dtype']}: {r['left_out']}" for r in rows if "left_out" in r]
    return [
        "## Beside others\n",
        "Millions of samples a second by calls one after the other, data on the device; in brackets, how many times longer it "
        "takes than the same calls of dualpin.  The last column: the largest scaled difference from dualpin in double "
        "precision, before and after.\n",
        table(["robot", "term", "type", "library", *(f"{n:,}" for n in batches), "difference"], lines),
        *(["Not measured:\n", *absent, ""] if absent else []),
    ]


def correctness(rows: list[dict[str, Any]]) -> list[str]:
    checked = [r for r in rows if "same_bits" in r]
    same = [r for r in checked if r["same_bits"]]
    lines = []
    for robot, floating in dict.fromkeys((r["robot"], r["floating"]) for r in rows):
        of = [r for r in checked if (r["robot"], r["floating"]) == (robot, floating)]
        out = [r["term"] for r in rows if "left_out" in r and (r["robot"], r["floating"]) == (robot, floating)]
        wrong = [r["term"] for r in of if not r["same_bits"]]
        fewest = min((r["states"] for r in of), default=0)
        lines.append(
            [f"{robot}{' + floating' if floating else ''}", len(of), sum(r["states"] for r in of), f"{fewest:,}",
             ", ".join(wrong) or "none", ", ".join(dict.fromkeys(out)) or "none"]
        )  # fmt: skip
    failed = [f"- {r['robot']} {r['term']} {r['dtype']}: {r['error']}" for r in rows if "error" in r]
    return [
        "## Correctness\n",
        f"{len(same)} of {len(checked)} programs (a term of a robot in a type) give the bits of the host's kernel in every one "
        "of their states; results too large for a gigabyte have fewer states.\n",
        table(
            ["robot", "programs", "states in all", "fewest states", "not the same bits", "too long, left out"], lines
        ),
        *(["Failed:\n", *failed, ""] if failed else []),
    ]
