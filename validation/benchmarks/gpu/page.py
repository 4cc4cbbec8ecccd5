"""Results as Markdown."""

from __future__ import annotations

from typing import Any

from ..report import table


def rate(n: int, seconds: float) -> str:
    """Samples a second, in millions."""
    return f"{n / seconds / 1e6:,.0f}" if n / seconds > 1e7 else f"{n / seconds / 1e6:.2g}"


def title(row: dict[str, Any]) -> str:
    return f"{row['robot']}{' + floating' if row['floating'] else ''}"


def markdown(results: dict[str, Any]) -> str:
    m = results["machine"]
    dates = ", ".join(f"{date} ({section})" for section, date in results["dates"].items())
    text = [
        "# GPU kernels\n",
        f"Measured {dates} by `{results['command']}`: {m['device']}, {m['multiprocessors']} "
        f"multiprocessors, CUDA driver {m['driver'] // 1000}.{m['driver'] % 1000 // 10}, memory "
        f"{m['bytes_per_second'] / 1e12:.2f} TB/s by a copy on the device (read and written counted); "
        f"{m['cores']} cores, {m['system']}, Python {m['python']}, dualpin {m['dualpin']}, numpy {m['numpy']}, "
        f"llvmlite {m['llvmlite']}.\n",
    ]
    if "throughput" in results:
        text += throughput(results["throughput"])
    if "columns" in results:
        text += columns(results["columns"])
    if "peers" in results:
        text += peers(results["peers"], results.get("throughput", []))
    if "correctness" in results:
        text += correctness(results["correctness"])
    return "\n".join(text)


def throughput(rows: list[dict[str, Any]]) -> list[str]:
    batches = list(dict.fromkeys(r["batch"] for r in rows))
    lines: dict[tuple[str, str, str], list[str]] = {}
    for r in rows:
        cells = [
            rate(r["batch"], r[k]) if k in r else "-" for k in ("device_seconds", "call_seconds", "copied_seconds")
        ]
        line = lines.setdefault((title(r), f"`{r['term']}`", r["dtype"]), [])
        line.append(f"({r['left_out']})" if "left_out" in r else " / ".join(cells))
    right = all(r.get("equal", True) for r in rows)
    said = "All were equal to the host's kernels, bit for bit, before and after." if right else "SOME RESULTS DIFFER."
    return [
        "## Throughput\n",
        "Millions of samples a second: by the device's clock, data on the device / by calls from Python one after the "
        "other, data on the device / with arguments and results copied from and to ordinary memory of the host.  "
        f"{said}\n",
        table(["robot", "term", "type", *(f"{n:,}" for n in batches)], [[*key, *line] for key, line in lines.items()]),
    ]


def columns(rows: list[dict[str, Any]]) -> list[str]:
    right = all(r["equal"] for r in rows)
    said = "All were equal to the host's kernels, bit for bit." if right else "SOME RESULTS DIFFER."
    lines = [
        [title(r), f"`{r['term']}`", r["dtype"], f"{r['batch']:,}", rate(r["batch"], r["device_seconds"])] for r in rows
    ]
    return [
        "## Structures of arrays\n",
        f"Millions of samples a second by the device's clock, each entry's samples side by side in memory.  {said}\n",
        table(["robot", "term", "type", "samples", "millions a second"], lines),
    ]


def peers(rows: list[dict[str, Any]], ours: list[dict[str, Any]]) -> list[str]:
    mine = {(r["robot"], r["term"], r["dtype"], r["batch"]): r for r in ours if "call_seconds" in r}
    measured = [r for r in rows if "call_seconds" in r]
    batches = list(dict.fromkeys(r["batch"] for r in measured))
    found: dict[tuple[str, str, str, str], dict[int, dict[str, Any]]] = {}
    for r in measured:
        library = r["peer"].partition(",")[0]
        found.setdefault((r["robot"], r["term"], r["dtype"], library), {})[r["batch"]] = r
    lines = []
    for (robot, term, dtype, library), by_batch in sorted(found.items()):
        cells = []
        for n in batches:
            r, own = by_batch.get(n), mine.get((robot, term, dtype, n))
            if r is None:
                cells.append("-")
                continue
            seconds = own[r.get("clock", "call_seconds")] if own else 0.0
            ratio = f" ({r['call_seconds'] / seconds:.1f}x)" if seconds else ""
            cells.append(rate(n, r["call_seconds"]) + ratio + ("" if r["equal"] else " DIFFERS"))
        worst = max(r["difference"] for r in by_batch.values())
        lines.append([robot, f"`{term}`", dtype, library, *cells, f"{worst:.1e}"])
    absent = [
        f"- {r['peer']}, {r.get('robot', '')} {r.get('term', '')} {r['dtype']}, {r.get('batch', 0):,} samples: "
        + r["left_out"].splitlines()[0].partition(" [")[0]
        for r in rows
        if "left_out" in r
    ]
    return [
        "## Beside others\n",
        "Millions of samples a second, data on the device; in brackets, how many times as long as ours it takes.\n"
        "Libraries of JAX: by calls one after the other, as ours; GRiD: by the device's clock, as ours, and\n"
        "with the number of threads a sample that suits it best.  The last column: the largest scaled difference of\n"
        "torques from dualpin in double precision, before and after.  In single precision JAX multiplies matrices in\n"
        "TF32 by default; where torques differ by more than 0.2 % for that, the table says so.\n",
        table(["robot", "term", "type", "library", *(f"{n:,}" for n in batches), "difference"], lines),
        *(["Not measured:\n", *absent, ""] if absent else []),
    ]


def correctness(rows: list[dict[str, Any]]) -> list[str]:
    checked = [r for r in rows if "same_bits" in r]
    same = [r for r in checked if r["same_bits"]]
    lines = []
    for name in dict.fromkeys(map(title, rows)):
        of = [r for r in checked if title(r) == name]
        out = dict.fromkeys(r["term"] for r in rows if "left_out" in r and title(r) == name)
        wrong = dict.fromkeys(r["term"] for r in of if not r["same_bits"])
        states, fewest = sum(r["states"] for r in of), min((r["states"] for r in of), default=0)
        many = sum(r["states"] >= 1_000_000 for r in of)
        said = [", ".join(x) or "none" for x in (wrong, out)]
        lines.append([name, len(of), f"{states:,}", many, f"{fewest:,}", *said])
    failed = [f"- {title(r)} {r['term']} {r['dtype']}: {r['error']}" for r in rows if "error" in r]
    head = ["robot", "programs", "states in all", "with a million", "fewest states", "not the same bits", "left out"]
    return [
        "## Correctness\n",
        f"{len(same)} of {len(checked)} programs (a term of a robot in a type) give the bits of the host's kernel in "
        "every one of their states; those whose arguments and results would be larger than a gigabyte have fewer.\n",
        table(head, lines),
        *(["Failed:\n", *failed, ""] if failed else []),
    ]
