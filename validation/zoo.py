"""A folder of URDFs that others wrote, read by both libraries and validated; run with ``make zoo DIR=...``.

Prints who reads what and how the readable ones compare, and writes it with the full report to ``--out``.  An
interrupted run is taken up where it stopped.  Reading happens in processes of their own, so that a file
which brings a library down is a line of the table and not the end of the run.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import re
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from pathlib import Path
from queue import SimpleQueue

from dualpin.crosscheck import Report
from dualpin.crosscheck.campaign import campaign
from dualpin.crosscheck.checks import Case
from dualpin.errors import ArgumentError, DualpinError, DualpinWarning
from dualpin.escape import line, markdown
from dualpin.files import write_text

SLOW = 10.0  # s; reading that takes longer is named in the table
READ = "read.jsonl"


@dataclass
class Reading:
    """How a file was read: "" and the reason of a refusal, or of a crash."""

    file: str
    dualpin: str
    """Empty if it was read."""
    pinocchio: str
    notes: list[str]
    seconds: float
    crashed: bool = False

    @property
    def group(self) -> str:
        return {(True, True): "both", (False, True): "only Pinocchio", (True, False): "only dualpin"}.get(
            (not self.dualpin, not self.pinocchio), "neither"
        )


def read(path: str, name: str) -> Reading:
    """One file, by both libraries."""
    from dualpin.crosscheck.oracles.pinocchio_model import build
    from dualpin.io.urdf import load

    ours, theirs, notes, start = "", "", [], time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        try:
            notes = list(load(Path(path)).notes)
        except DualpinError as e:
            ours = str(e)
    seconds = time.perf_counter() - start
    try:
        build(path, False, False)
    except DualpinError as e:
        theirs = str(e)
    return Reading(name, ours, theirs, notes, seconds)


def readings(files: list[tuple[str, str]], log: Path, jobs: int) -> Iterator[Reading]:
    """All files, those of an earlier run from its log."""
    done = {}
    if log.exists():
        for entry in log.read_text(encoding="utf-8").splitlines():
            try:
                reading = Reading(**json.loads(entry))
            except (ValueError, TypeError):
                break  # an incomplete last line
            done[reading.file] = reading
    write_text(log, "".join(json.dumps(asdict(r)) + "\n" for r in done.values()))
    readers: SimpleQueue[ProcessPoolExecutor] = SimpleQueue()
    for _ in range(jobs):
        readers.put(reader())
    threads = ThreadPoolExecutor(jobs)
    try:
        found = {name: threads.submit(apart, readers, path, name) for path, name in files if name not in done}
        with log.open("a", encoding="utf-8") as out:
            for _, name in files:
                if name in found:
                    done[name] = found[name].result()
                    out.write(json.dumps(asdict(done[name])) + "\n")
                    out.flush()
                yield done[name]
    finally:
        threads.shutdown(cancel_futures=True)
        while not readers.empty():
            readers.get().shutdown()


def reader() -> ProcessPoolExecutor:
    """One process, so that it is known which file ended it."""
    return ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))


def apart(readers: SimpleQueue[ProcessPoolExecutor], path: str, name: str) -> Reading:
    """`read`, in the next process that is free."""
    pool = readers.get()
    try:
        return pool.submit(read, path, name).result()
    except BrokenProcessPool:
        pool = reader()
        return Reading(name, "the process died", "the process died", [], 0.0, crashed=True)
    finally:
        readers.put(pool)


# --- the table -------------------------------------------------------------------------------------


def kind(text: str) -> str:
    """What a refusal or a note says, without the names and numbers of one file."""
    text = re.sub(r"^[^:]*(:\d+)?: ", "", text)
    text = re.split(r"; (did you mean|links:|types:|joints:)", text)[0]
    text = re.sub(r": (links?|joints?|lines?|tags?|prefix(es)?) ('|\d).*", "", text)
    text = re.sub(r"^limit: .*: farther", "limit: farther", text)
    text = re.sub(r"""'[^']*'|"[^"]*"|<xacro:[\w.-]+>""", "...", text)
    return re.sub(r"\d+", "N", text)[:110]


def note_kind(note: str) -> str:
    return kind(f"note: {note}")


def rows(of: Iterable[str], least: int = 1) -> list[str]:
    return [f"| {markdown(k)} | {n} |" for k, n in Counter(of).most_common() if n >= least]


def table(read_: list[Reading], report: Report | None) -> str:
    """The table as Markdown."""
    lines = ["| read by | files |", "|---|---|"]
    groups = Counter(r.group for r in read_)
    lines += [f"| {g} | {groups[g]} |" for g in ("both", "only Pinocchio", "only dualpin", "neither")]
    lines += [f"| (a process died) | {sum(r.crashed for r in read_)} |"]
    for group in ("only Pinocchio", "neither"):
        of = [r for r in read_ if r.group == group]
        if of:
            lines += [
                "",
                f"| refused by dualpin, read by {'Pinocchio' if 'P' in group else 'neither'} | files |",
                "|---|---|",
            ]
            lines += rows(kind(r.dualpin) for r in of)
    of = [r for r in read_ if r.group == "only dualpin"]
    if of:
        lines += [
            "",
            "| read by dualpin only: its notes | files |",
            "|---|---|",
            *rows(note_kind(n) for r in of for n in r.notes),
        ]
    lines += ["", "| notes | files |", "|---|---|", *rows(k for r in read_ for k in {note_kind(n) for n in r.notes})]
    slow = sorted((r for r in read_ if r.seconds > SLOW), key=lambda r: -r.seconds)
    lines += [f"\nslow: {', '.join(f'{r.file} {r.seconds:.1f} s' for r in slow)}"] if slow else []
    if report is not None:
        lines += ["", *verdicts(report)]
    return "\n".join(lines) + "\n"


def verdicts(report: Report) -> list[str]:
    """How the readable ones compare, on a fixed and on a floating base."""
    lines = ["| base | robots | agrees | differs, dualpin nearer | differs otherwise | not compared | failed |",
             "|---|---|---|---|---|---|---|"]  # fmt: skip
    for floating in (False, True):
        robots = [r for r in report.robots if r.floating == floating]
        found = Counter(r.verdict for r in robots)
        other = sum(n for v, n in found.items() if v.startswith("differs") and v != "differs, dualpin nearer")
        lines.append(
            f"| {'floating' if floating else 'fixed'} | {len(robots)} | {found['agrees']} "
            f"| {found['differs, dualpin nearer']} | {other} | {found['not compared']} "
            f"| {sum(not r.passed for r in robots)} |"
        )
    odd = [r for r in report.robots if not r.passed or r.status == "differs"]
    if odd:
        lines += ["", "| differs or failed | verdict | why |", "|---|---|---|"]
        lines += [f"| {markdown(r.label)} | {r.verdict} | {markdown(r.remark[:200])} |" for r in odd]
    missing = [r.reason or "terms" for r in report.robots if r.status == "not compared"]
    if missing:
        lines += ["", "| not compared because | robots |", "|---|---|", *rows(kind(f"x: {m}") for m in missing)]
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(
        description="Read a folder of URDFs with both libraries, validate, print the table."
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--out", type=Path, default=Path("out/zoo"), help="where the table and the report go")
    parser.add_argument("--samples", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--engine", default="numpy", help="compiling costs more than a few samples of many robots")
    parser.add_argument("--read-only", action="store_true", help="do not validate")
    arguments = parser.parse_args()
    root = arguments.folder
    below = (p for p in sorted(root.rglob("*")) if p.suffix.lower() == ".urdf" and p.is_file())
    files = [(str(p), p.relative_to(root).as_posix()) for p in below]
    if not files:
        print(f"zoo: no *.urdf below {line(str(root))}", file=sys.stderr)
        return 2
    arguments.out.mkdir(parents=True, exist_ok=True)
    found: list[Reading] = []
    try:
        for reading in readings(files, arguments.out / READ, arguments.jobs):
            found.append(reading)
            tick("reading", len(found), len(files), reading.file)
    except KeyboardInterrupt:
        print("\nzoo: interrupted; the same command goes on", file=sys.stderr)
        return 130
    paths = {name: path for path, name in files}
    cases = [
        Case(paths[r.file], floating, title=r.file)
        for r in sorted(found, key=lambda r: Path(paths[r.file]).stat().st_size)
        if not r.dualpin and not r.crashed
        for floating in (False, True)
    ]  # fmt: skip
    report = None
    if not arguments.read_only and cases:
        report = campaign(
            cases, arguments.samples, arguments.seed, engine=arguments.engine, arbitrate=True, jobs=arguments.jobs,
            folder=arguments.out, progress=lambda result, done, total: tick("validating", done, total, result.name),
        )  # fmt: skip
        report.write(arguments.out, ("json", "md"))
    text = table(found, report)
    write_text(arguments.out / "zoo.md", text)
    print(text)
    if report is not None and report.partial:
        return 130
    return 0 if report is None or report.passed else 1


def tick(what: str, done: int, total: int, name: str) -> None:
    if sys.stderr.isatty():
        print(
            f"\r\x1b[K{what} {done}/{total} {line(name)[:60]}",
            end="\n" if done == total else "",
            file=sys.stderr,
            flush=True,
        )
    elif done % 100 == 0 or done == total:
        print(f"{what} {done}/{total}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except ArgumentError as e:
        print(f"zoo: {e}", file=sys.stderr)
        sys.exit(2)
