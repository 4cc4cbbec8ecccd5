"""Validate many robots: interruptible, and resumed where it stopped."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path

from ...errors import DualpinWarning
from ..checks import Case, chosen
from ..merge import merged
from ..results import Refusal, Report, RobotResult
from ..run import attempt, provenance
from ..units import Result, Settings, Unit, largest_first, slices
from .executors import Connect, LostError, run
from .store import Store

PARTIAL = "partial.sqlite"


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
    executor: Executor | Connect | None = None,
    store: str | Path | None = None,
) -> Report:
    """Validate all cases; on Ctrl-C return what is done, marked partial.

    Parameters
    ----------
    cases : sequence of Case
        The robots.
    samples, seed : int
        States of each robot; more than 10,000 are cut into slices with seeds of their own.
    terms, engine, arbitrate
        As in `dualpin.validate`.
    jobs : int
        Processes of this machine.
    folder : path, optional
        Results are kept there until the campaign is complete: a run with the same settings takes up
        what an interrupted one left.
    progress : callable, optional
        Called with a result, the number of units done, and of all.
    executor : concurrent.futures.Executor, or function that returns one, optional
        Where units are computed instead: of Dask, MPI, or a pool of yours, which is left open.  What a function
        returns is entered with ``with``, and the function called again where that executor was lost.
    store : path, optional
        A file in which results stay.  What it holds of the same robots, settings and versions is not computed again.

    Returns
    -------
    Report
        The same, times and date apart, however it was computed.

    Raises
    ------
    ArgumentError
        If the store cannot be written, or an executor cannot compute.

    Examples
    --------
    >>> from dualpin.crosscheck.campaign import campaign
    >>> from dualpin.crosscheck.checks import Case
    >>> campaign([Case("ur5"), Case("panda", mimic=True)], samples=2, seed=0, terms=["rnea"]).summary
    '2 agree'
    """
    settings = Settings(samples, seed, tuple(c.term for c in chosen(terms)), engine, arbitrate)
    parts = {case: slices(case, samples, seed) for case in cases}
    units = [unit for some in parts.values() for unit in some]
    kept = Store(store if store is not None else folder / PARTIAL if folder else None)
    report = Report(versions=provenance(engine))
    try:
        name = kept.campaign(settings.identity, len(units), (u.key for u in units))
        done = kept.done(name)
        waiting, finished = [u for u in units if u.key not in done], len(done)
        if jobs > 1 or executor is not None:
            waiting = largest_first(waiting)
        try:
            for unit, result in run(waiting, partial(_validated, settings=settings), jobs, executor):
                kept.add(name, unit, result)
                finished += 1
                if progress:
                    progress(result, finished, len(units))
        except KeyboardInterrupt:
            report.partial = True
        except LostError as e:
            report.partial = True
            warnings.warn(f"{e}; what was found is kept, and the same call goes on", DualpinWarning, stacklevel=2)
        _assemble(report, parts, seed, kept, name)
    finally:
        kept.close()
    if folder and store is None and not report.partial:
        (folder / PARTIAL).unlink(missing_ok=True)
    return report


def _validated(unit: Unit, settings: Settings) -> Result:
    return attempt(unit.case, unit.samples, unit.seed, settings.checks, settings.engine, settings.arbitrate)


def _assemble(report: Report, parts: Mapping[Case, list[Unit]], seed: int, kept: Store, name: str) -> None:
    """Fill a report with what the store has, in the order of the cases."""
    refused: dict[str, Refusal] = {}
    for units in parts.values():
        found = {u: result for u in units if (result := kept.result(name, u)) is not None}
        if not found:
            continue
        whole = merged(list(found), list(found.values()), seed)
        if isinstance(whole, RobotResult):
            report.robots.append(whole)
        else:  # one line a file: the fixed and the floating base are refused for the same reason
            refused[whole.name] = whole
    report.refused = list(refused.values())
