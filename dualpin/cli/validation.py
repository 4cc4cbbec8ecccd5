"""`dualpin validate`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from ..errors import ArgumentError
from .app import Floating, Json, Mimic, Seed, Terms, app, robot_names
from .numbers import words
from .out import wrote
from .progress import Progress
from .show import formats, show
from .stdin import named

EXIT_FAILED, EXIT_INTERRUPTED = 1, 130


@app.command()
def validate(
    robots: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ROBOT...", help="Names or paths; - is standard input.", autocompletion=robot_names, callback=named
        ),
    ] = None,
    all_: Annotated[
        bool, typer.Option("--all", help="Every URDF of example-robot-data, fixed, floating and mimic.")
    ] = False,
    samples: Annotated[int, typer.Option("--samples", "-n", min=1, help="Random states a robot.")] = 100,
    seed: Seed = 0,
    terms: Terms = "",
    out: Annotated[
        Path | None, typer.Option("--out", help="Write report.json, .md and .html into this folder.")
    ] = None,
    floating: Floating = False,
    mimic: Mimic = False,
    engine: Annotated[str, typer.Option("--engine", help="auto, numpy, compiled, tiered or cuda.")] = "auto",
    arbitrate: Annotated[
        bool,
        typer.Option("--arbitrate", help="Arbitrate in 50 digits also agreeing terms that differ by more than 1e-13."),
    ] = False,
    against: Annotated[
        str | None, typer.Option("--against", help="Compare with this robot or file instead, and say what differs.")
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Fail if a term, robot or file was not compared.")] = False,
    jobs: Annotated[int, typer.Option("--jobs", "-j", min=0, help="Processes; 0: one a core.")] = 0,
    scheduler: Annotated[
        str, typer.Option("--scheduler", help="Compute there: tcp://host:port of Dask, or mpi under mpi4py.futures.")
    ] = "",
    store: Annotated[
        Path | None, typer.Option("--store", help="A file in which results stay, and are not computed again.")
    ] = None,
    json: Json = False,
) -> None:
    """Compare every term of robots with Pinocchio on random states.

    Exit code 1 if a term differs and dualpin is not known to be nearer the truth, if only dualpin
    refuses a file, or, with --strict, if anything was not compared.  With --out an interrupted run
    keeps what it has, and the same command takes it up again.

    Examples:  dualpin validate panda ur5 --samples 100  |  dualpin validate my_arm.urdf --floating --out out
    """
    from ..crosscheck.campaign import all_cases, campaign
    from ..crosscheck.campaign.executors import scheduler as scheduled
    from ..crosscheck.run import CHECKS, Case
    from ..io.catalogue import find

    if all_ and against:
        raise ArgumentError("validate: --against goes with one or more robots, not with --all")
    if against:
        find(against)
    if all_ == bool(robots):
        raise ArgumentError("validate: name robots, or give --all (not both)")
    for name in robots or []:
        if name in CHECKS and not Path(name).exists():
            raise ArgumentError(
                f"validate: {name!r} is a term, not a robot; terms go between commas: --terms rnea,crba"
            )
        find(name)  # a name that is nothing at all is no file to refuse
    cases = all_cases() if all_ else [Case(name, floating, mimic, against) for name in robots or []]
    workers = 1 if engine == "cuda" else min(jobs or os.cpu_count() or 1, len(cases))  # processes share no device
    chosen = words(terms) or None
    executor = scheduled(scheduler) if scheduler else None
    with Progress("validating", len(cases)) as tick:
        report = campaign(cases, samples, seed, chosen, engine, arbitrate, workers, out, tick, executor, store)
    written = report.write(out, formats()) if out else []
    if json:
        print(report.to_json())
    else:
        show(report)
    wrote(*written)
    if report.partial:
        raise typer.Exit(EXIT_INTERRUPTED)
    if not report.robots and any(r.by_pinocchio for r in report.refused) and not all_:
        raise typer.Exit(2)  # nothing could be read at all
    raise typer.Exit(0 if report.passed and (report.complete or not strict) else EXIT_FAILED)
