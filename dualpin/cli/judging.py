"""`dualpin judge` and `dualpin ask`."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ArgumentError
from .app import Floating, Json, Mimic, RobotName, Seed, Terms, app
from .numbers import words
from .out import wrote
from .show import formats

EXIT_INTERRUPTED = 130
Samples = Annotated[int, typer.Option("--samples", "-n", min=2, help="States asked.")]


@app.command()
def judge(
    robot: RobotName,
    subjects: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SUBJECT...", help="Shipped names, module:attribute, file.py:attribute, exchange folders."
        ),
    ] = None,
    command: Annotated[
        str, typer.Option("--command", help='A program that answers an exchange folder: "./my_program FOLDER".')
    ] = "",
    samples: Samples = 16,
    seed: Seed = 0,
    terms: Terms = "",
    floating: Floating = False,
    mimic: Mimic = False,
    diagnose: Annotated[bool, typer.Option("--diagnose/--no-diagnose", help="Look for the causes.")] = True,
    python: Annotated[str, typer.Option("--python", help="The interpreter of the subject's own environment.")] = "",
    limit: Annotated[
        float, typer.Option("--limit", min=0.1, help="Seconds after which a subject counts as hanging.")
    ] = 60.0,
    out: Annotated[
        Path | None, typer.Option("--out", help="Write report.json, .md, .html, junit.xml and .sarif into this folder.")
    ] = None,
    json: Json = False,
) -> None:
    """Compare dynamics code with dualpin term by term, and say why what differs differs.

    Exit code 0 if nothing was found, 1 if something was (or a subject did not answer at all), 2 for bad input.
    With --out an interrupted judgement keeps what it has, and the same command takes it up again.

    Examples:  dualpin judge panda pinocchio  |  dualpin judge arm.urdf my_code.py:Arm --out out
    |  dualpin judge arm.urdf --command "./my_program FOLDER"
    """
    from ..crosscheck.judging import judge_all
    from ..crosscheck.subjects import Command

    chosen: list[Any] = [*(subjects or []), *([Command(command, limit)] if command else [])]
    if not chosen:
        raise ArgumentError(
            "judge: name a subject, or give --command; `dualpin judge --help` says what a subject may be"
        )
    wanted = words(terms) or None
    with progress() as tick:
        report = judge_all(
            robot, chosen, samples, seed, terms=wanted, diagnose=diagnose, floating=floating, mimic=mimic,
            python=python or None, limit=limit, folder=out, progress=tick, interruptible=True,
        )  # fmt: skip
    written = report.write(out, (*formats(), "junit", "sarif")) if out else []
    if json:
        print(report.to_json())
    else:
        show_judgement(report)
    wrote(*written)
    if report.partial:
        raise typer.Exit(EXIT_INTERRUPTED)
    raise typer.Exit(0 if report.passed and not report.findings and not unanswered(report) else 1)


@app.command()
def ask(
    robot: RobotName,
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Where to write.")],
    language: Annotated[
        str, typer.Option("--language", "-l", help="Also write a program to fill in: c, cpp, python, matlab or julia.")
    ] = "",
    samples: Samples = 16,
    seed: Seed = 0,
    terms: Terms = "",
    floating: Floating = False,
    mimic: Mimic = False,
) -> None:
    """Write states and the expected formats of answers, for a program in any language.

    The program reads states.csv and writes answers/TERM.csv; `dualpin judge ROBOT FOLDER` then says what is right.

    Examples:  dualpin ask panda asked --language c  |  dualpin ask my_arm.urdf asked --terms rnea,crba
    """
    from ..crosscheck.subjects import asking, exchange, write_starter
    from ..crosscheck.subjects.questions import wanted

    names = wanted(words(terms) or None)
    given = asking(robot, samples, seed, names, floating=floating, mimic=mimic)
    program = write_starter(given, folder, language) if language else None  # refused before anything is written
    exchange.write(given, folder)
    print(f"wrote {folder / 'states.csv'}: {given.samples} states of {', '.join(given.robot.joint_names[:4])}, ...")
    if program:
        print(f"wrote {program}: fill in the functions, run it, then")
    print(f"dualpin judge {robot}{' --floating' if floating else ''}{' --mimic' if mimic else ''} {folder}")


@contextlib.contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """One line on stderr that says what is being done; nothing where stderr is no terminal."""
    if not sys.stderr.isatty():
        yield lambda what: None
        return
    from rich.console import Console

    with Console(stderr=True).status("asking") as status:
        yield lambda what: status.update(what)


def show_judgement(report: Any) -> None:
    """The terms of each subject, what was found, and where to look."""
    from .show import _plain, console, table

    out = console()
    for r in report.robots:
        who = f"{r.label} {r.subject_version}".rstrip()
        title = f"{who}: {r.nv} degrees of freedom, {r.samples} samples, seed {r.seed}"
        listing = table("term", "verdict", "max scaled error>", "line>", "n eps cond>", "remark", title=title)
        silent = [t for t, x in r.terms.items() if x.status == "not compared" and x.reason == "not offered"]
        for name, t in r.terms.items():
            if name not in silent:
                figures = ("-", "-", "-")
                if t.compared:
                    figures = (f"{t.max_scaled_error:.1e}", f"{t.tolerance:.0e}", f"{t.worst.get('n_eps_cond', 0):.2g}")
                at = f"at {t.worst.get('where')}" if t.status == "differs" and t.worst.get("where") else ""
                exact = t.note if t.status == "differs" else t.remark
                listing.add_row(name, _verdict(t), *figures, _plain("; ".join(x for x in (at, exact) if x)))
        if not r.reason:
            out.print(listing)
        else:
            out.print(f"{title}\n{_plain(r.reason)}")
        if silent and not r.reason:
            out.print(f"not offered: {', '.join(silent)}", markup=False)
        for note in r.notes:
            out.print(note, markup=False)
    for k, f in enumerate(report.findings, 1):
        who = f"{f.subject}: " if len(report.robots) > 1 else ""
        out.print(f"[bold]{k}. \\[{f.key}][/] {_plain(who + str(f))}")
        if f.alternatives:
            out.print(f"   as well explained by: {' | '.join(f.alternatives)}", markup=False)
        if f.apart:
            would = f"{f.apart['term']} would be {f.apart['first']:.9g} or {f.apart['other']:.9g}"
            out.print(f"   told apart by a state (in --json) in which {would}", markup=False)
        if f.fix:
            out.print(f"   fix: {f.fix}", markup=False)
    silent = unanswered(report)
    if silent:
        out.print(f"[bold red]not answered:[/] {_plain(', '.join(silent))}")
    if report.findings:
        out.print(f"[bold red]{len(report.findings)} found[/]")
    elif report.partial:
        out.print("[bold yellow]interrupted: not everything was judged[/]")
    elif not report.passed:
        out.print("[bold red]differs, cause unknown[/]")
    elif not silent:
        out.print("[bold green]nothing found[/]")


def unanswered(report: Any) -> list[str]:
    """Terms that a subject has but did not answer, and subjects that answered nothing."""
    out = []
    for r in report.robots:
        who = f"{r.subject} " if len(report.robots) > 1 else ""
        if all(t.status == "not compared" for t in r.terms.values()):
            out.append(f"{who}all terms")
            continue
        out += [
            f"{who}{n}"
            for n, t in r.terms.items()
            if t.status == "not compared" and not t.reason.startswith("not offered")
        ]
    return out


def _verdict(t: Any) -> str:
    color = {"agrees": "green", "not compared": "yellow"}.get(t.status, "red")
    return f"[{color}]{t.verdict}[/]"
