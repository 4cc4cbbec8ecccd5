"""`dualpin bench`: figures measured here and now."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ArgumentError
from ..escape import line
from .app import Floating, Json, Terms, app, show_json
from .listing import show_rows
from .numbers import whole, words
from .out import Out, command, note, write_result
from .stdin import named


@app.command()
def bench(
    robots: Annotated[
        list[str], typer.Argument(metavar="ROBOT...", help="Names or paths; - is standard input.", callback=named)
    ],
    terms: Terms = "",
    batch: Annotated[str, typer.Option("--batch", help="Samples a call; 1 is a single call.")] = "1,4096",
    threads: Annotated[str, typer.Option("--threads", help="Thread counts, between commas.")] = "1",
    device: Annotated[str, typer.Option("--device", help="A GPU: cuda, cuda:1, ...; terms are measured there.")] = "",
    explain: Annotated[
        bool, typer.Option("--explain", help="With --device: registers, spills and occupancy; needs no GPU.")
    ] = False,
    against: Annotated[
        list[str] | None,
        typer.Option("--against", help="Other libraries, each in a process of its own; again for several, or all."),
    ] = None,
    floating: Floating = False,
    out: Out = None,
    json: Json = False,
) -> None:
    """Measure terms beside Pinocchio, in one run, after checking that both agree.

    With --against, beside other libraries, each in its environment, one thread, checked before and after; what is not
    installed is left out by name.  With --device, kernels on a GPU are measured instead, after checking that they give
    the bits of the host's.
    """
    from .. import bench as measure

    if explain and not device:
        raise ArgumentError("bench: --explain is of kernels on a GPU; --device cuda")
    if device:
        _on_device(robots, terms, batch, device, explain, floating, out, json)
        return

    if against:
        _against(robots, terms, batch, against, floating, out, json)
        return

    chosen = words(terms) or measure.TERMS_MEASURED
    batches, counts = whole(batch, "--batch"), whole(threads, "--threads")

    def tick(row: dict[str, Any]) -> None:
        if sys.stderr.isatty():
            print(f"{line(row['robot'])} {row['term']} batch {row['batch']}", file=sys.stderr)

    rows = measure.run(robots, chosen, batches, counts, floating=floating, progress=tick)
    if out:
        _write(out, rows, f"Speed of {', '.join(map(line, robots))} beside Pinocchio", measure.machine())
    if json:
        show_json(rows)
    else:
        show_rows("", rows, ("robot", "term", "batch", "threads", "us_per_sample", "pinocchio_us_per_sample", "ratio"))


def _against(
    robots: list[str], terms: str, batch: str, against: list[str], floating: bool, out: Path | None, json: bool
) -> None:
    from .. import bench as measure
    from .. import peers
    from ..peers.measuring import MEASURED

    if floating:
        raise ArgumentError("bench: --against is of robots on a fixed base")
    names = [name for text in against for name in words(text)]
    names = list(peers.NAMES) if names == ["all"] else names
    chosen = words(terms) or MEASURED
    sizes = [n for n in whole(batch, "--batch") if n > 1] or [4096]

    def tick(row: dict[str, Any]) -> None:
        if sys.stderr.isatty():
            print(f"{line(row['robot'])} {row['peer']} {row.get('term', '')} {row.get('batch', '')}", file=sys.stderr)

    rows = [row for size in sizes for row in peers.run(robots, names, chosen, size, progress=tick)]
    if out:
        _write(out, rows, f"Speed of {', '.join(map(line, robots))} beside {', '.join(names)}", measure.machine())
    if json:
        show_json(rows)
        return
    measured = [r for r in rows if "skipped" not in r]
    show_rows("", measured, ("robot", "term", "batch", "peer", "how", "us", "peer_us", "ratio"))
    for r in rows:
        if r.get("skipped", "not offered") != "not offered":
            what = " ".join(str(r[k]) for k in ("robot", "peer", "term", "batch") if k in r)
            note(f"{what}: {r['skipped']}")


def _on_device(
    robots: list[str], terms: str, batch: str, device: str, explain: bool, floating: bool, out: Path | None, json: bool
) -> None:
    from .. import bench_device as measure

    chosen = words(terms) or ["rnea", "aba", "crba", "fk"]
    if explain:
        rows = measure.explained(robots, chosen, device, floating=floating)
        columns: tuple[str, ...] = ("robot", "term", "dtype", "operations", "registers", "stack", "spill_stores")
        columns += ("spill_loads", "shared", "occupancy", "architecture")
    else:
        rows = measure.run(robots, chosen, whole(batch.removeprefix("1,"), "--batch"), device, floating=floating)
        columns = ("robot", "term", "dtype", "batch", "us_per_call", "million_per_second", "device")
    if out:
        from ..bench import machine

        _write(out, rows, f"Speed of {', '.join(map(line, robots))} on {device}", machine())
    if json:
        show_json(rows)
        return
    said = [r for r in rows if "reason" in r]
    show_rows("", [r for r in rows if "reason" not in r], columns)
    for r in said:
        note(f"{r['robot']} {r['term']} {r['dtype']}: {r['reason']}")


def _write(folder: Path, rows: list[dict[str, Any]], title: str, machine: dict[str, Any]) -> None:
    from ..report import document

    found = document(title, rows, command=command())
    found["header"] |= {k: str(v) for k, v in machine.items()}
    write_result(folder, "bench", found)
