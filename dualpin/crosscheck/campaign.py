"""Many robots at once: in several processes, interruptible, and resumed where it stopped."""

from __future__ import annotations

import json
import multiprocessing
import signal
import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..engine.jit.threads import available, set_num_threads
from ..errors import ArgumentError, DualpinError, DualpinWarning
from ..files import write_text
from ..io.catalogue import catalogue, find
from ..io.urdf import load
from .checks import Case, Check, chosen
from .results import NOT_COMPARED, Refusal, Report, RobotResult
from .run import attempt, provenance

PARTIAL = "partial.jsonl"
Result = RobotResult | Refusal


def all_cases() -> list[Case]:
    """Every URDF file of example-robot-data, on a fixed and a floating base, and with mimic where it has any."""
    names = list(catalogue())
    if not names:
        raise ArgumentError("--all needs the robots of example-robot-data (pip install example-robot-data)")
    cases = []
    for name in names:
        cases += [Case(name), Case(name, floating=True)]
        if _coupled(name):
            cases.append(Case(name, mimic=True))
    return cases


def _coupled(name: str) -> bool:
    if b"mimic" not in find(name).read_bytes():
        return False  # without reading all of it as a robot
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        try:
            return load(name, mimic=True).coupled
        except DualpinError:
            return False  # its refusal is reported of the fixed and the floating base


def campaign(
    cases: Sequence[Case],
    samples: int,
    seed: int,
    terms: Iterable[str] | None = None,
    engine: str = "auto",
    arbitrate: bool = False,
    jobs: int = 1,
    folder: Path | None = None,
    progress: Callable[[Result, int, int], None] | None = None,
) -> Report:
    """Validate all cases; on Ctrl-C return what is done, marked partial.

    With a folder, every result is kept there as it comes, and a run with the same settings takes up
    what an interrupted one left.
    """
    checks = chosen(terms)
    settings: dict[str, Any] = {
        "samples": samples,
        "seed": seed,
        "terms": [c.term for c in checks],
        "engine": engine,
        "arbitrate": arbitrate,
    }
    settings["versions"] = provenance(engine)
    done = _kept(folder, settings) if folder else {}
    waiting = [c for c in cases if _key(c) not in done]
    log = _open(folder, settings, done) if folder else None
    report = Report(versions=settings["versions"])
    try:
        for case, result in _results(waiting, (samples, seed, checks, engine, arbitrate), jobs):
            done[_key(case)] = result
            if log:
                log.write(json.dumps({"key": _key(case), **_packed(result)}) + "\n")
                log.flush()
            if progress:
                progress(result, len(done), len(cases))
    except KeyboardInterrupt:
        report.partial = True
    finally:
        if log:
            log.close()
    ordered = [done[_key(c)] for c in cases if _key(c) in done]
    report.robots = [r for r in ordered if isinstance(r, RobotResult)]
    # one line a file: the fixed and the floating base are refused for the same reason
    report.refused = list({r.name: r for r in ordered if isinstance(r, Refusal)}.values())
    if folder and not report.partial:
        (folder / PARTIAL).unlink(missing_ok=True)
    return report


def _key(case: Case) -> str:
    return f"{case.name}|{case.floating}|{case.mimic}|{case.engine}|{case.against or ''}"


Settings = tuple[int, int, list[Check], str, bool]


def _results(cases: Sequence[Case], settings: Settings, jobs: int) -> Iterable[tuple[Case, Result]]:
    if jobs <= 1 or len(cases) <= 1:
        for case in cases:
            yield case, attempt(case, *settings)
        return
    context, jobs = multiprocessing.get_context("spawn"), min(jobs, len(cases))
    with ProcessPoolExecutor(jobs, context, initializer=_one_of, initargs=(jobs,)) as pool:
        # large files are large robots: they begin first, so that none is left to one process at the end
        futures = {pool.submit(attempt, c, *settings): c for c in sorted(cases, key=_size, reverse=True)}
        lost = []
        try:
            for future in as_completed(futures):
                try:
                    result = future.result()
                except BrokenProcessPool:  # one crashed, and took the pool with it
                    lost.append(futures[future])
                else:
                    yield futures[future], result
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    for case in lost:
        yield case, _alone(case, settings)


def _alone(case: Case, settings: Settings) -> Result:
    """In a process of its own, whose crash is the result."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), initializer=_one_of, initargs=(1,)) as pool:
        try:
            return pool.submit(attempt, case, *settings).result()
        except BrokenProcessPool:
            samples, seed, _, engine, _ = settings
            return RobotResult(
                case.name, case.floating, case.mimic, 0, samples, seed, True, status=NOT_COMPARED,
                reason="crashed: Pinocchio or dualpin ended the process", engine=case.engine or engine,
            )  # fmt: skip


def _one_of(jobs: int) -> None:
    """What a process among so many begins with."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    set_num_threads(max(1, available() // jobs))


def _size(case: Case) -> int:
    """Of the file, in bytes."""
    try:
        return find(str(case.robot)).stat().st_size
    except (DualpinError, OSError):
        return 0


def _packed(result: Result) -> dict[str, Any]:
    return {"kind": type(result).__name__, "data": asdict(result)}


def _unpacked(entry: dict[str, Any]) -> Result:
    data = entry["data"]
    if entry["kind"] == "Refusal":
        return Refusal(**data)
    return RobotResult.from_dict(data)


def _kept(folder: Path, settings: dict[str, Any]) -> dict[str, Result]:
    """What an interrupted run with the same settings left behind."""
    done: dict[str, Result] = {}
    try:
        lines = (folder / PARTIAL).read_text(encoding="utf-8").splitlines()
        if json.loads(lines[0]) != json.loads(json.dumps(settings)):
            return {}
        for line in lines[1:]:
            entry = json.loads(line)
            done[entry["key"]] = _unpacked(entry)
    except (OSError, ValueError, LookupError, TypeError):
        pass  # nothing there, or the last line was cut off: what was read before it counts
    return done


def _open(folder: Path, settings: dict[str, Any], done: dict[str, Result]) -> Any:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        entries = [settings, *({"key": key, **_packed(result)} for key, result in done.items())]
        write_text(folder / PARTIAL, "".join(json.dumps(e) + "\n" for e in entries))
        return (folder / PARTIAL).open("a", encoding="utf-8")
    except OSError as e:
        raise ArgumentError(f"cannot write into {folder} ({e.strerror or e})") from None
