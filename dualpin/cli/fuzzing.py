"""`dualpin fuzz`: random robots, as many as wanted."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from ..errors import ArgumentError, UrdfError
from ..escape import line
from .app import Json, Seed, app, show_json
from .progress import Progress

EXIT_FOUND, EXIT_INTERRUPTED = 1, 130


@app.command()
def fuzz(
    robots: Annotated[
        int, typer.Option("--robots", min=1, help="How many; a larger number later continues --store.")
    ] = 1000,
    seed: Seed = 0,
    store: Annotated[Path | None, typer.Option("--store", help="A file in which results stay.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Write tables and minimal robots into this folder.")] = None,
    small: Annotated[int, typer.Option("--small", min=0, help="How many robots of each kind are reduced.")] = 1,
    jobs: Annotated[int, typer.Option("--jobs", "-j", min=0, help="Processes; 0: one a core.")] = 0,
    scheduler: Annotated[str, typer.Option("--scheduler", help="As of `dualpin validate`.")] = "",
    replay: Annotated[
        Path | None, typer.Option("--replay", help="Examine one robot again, from a JSON file of --out.")
    ] = None,
    json: Json = False,
) -> None:
    """Examine random robots: every term against Pinocchio, and identities that must hold.

    Every difference is arbitrated by the term's definition in 50 digits, and one robot of each kind is
    reduced to a minimal one.  Exit code 1 where dualpin is wrong.

    Examples:  dualpin fuzz --robots 100000 --seed 7 --store all.sqlite --out out
    """
    from ..crosscheck.campaign.executors import scheduler as scheduled
    from ..fuzz import Spec, examine
    from ..fuzz import fuzz as fuzzed
    from ..fuzz.write import to_dict, to_markdown, write

    if replay is not None:
        from ..crosscheck.results import Report
        from ..crosscheck.run import provenance
        from .show import show

        try:
            spec = Spec.from_json(replay.read_text(encoding="utf-8"))
        except (OSError, ValueError, LookupError, TypeError) as e:
            raise UrdfError(f"fuzz: {replay} is no robot of `dualpin fuzz --out` ({e})") from None
        report = Report([examine(spec)], versions=provenance("numpy"))
        print(report.to_json()) if json else show(report)
        raise typer.Exit(0 if report.passed else EXIT_FOUND)
    executor = scheduled(scheduler) if scheduler else None
    if out is not None and out.exists() and not out.is_dir():
        raise ArgumentError(f"fuzz: --out {out} is no folder")
    with Progress("examining", robots) as tick:
        outcome = fuzzed(
            robots, seed, jobs=jobs or os.cpu_count() or 1, executor=executor, store=store, small=small, progress=tick
        )
    paths = write(outcome, out) if out else []
    if json:
        show_json(to_dict(outcome))
    else:
        print(to_markdown(outcome), end="")
    if paths:
        print(f"wrote {len(paths)} files into {line(str(out))}", file=sys.stderr)
    if outcome.partial:
        raise typer.Exit(EXIT_INTERRUPTED)
    raise typer.Exit(0 if outcome.passed else EXIT_FOUND)
