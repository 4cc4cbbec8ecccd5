"""Examine many random robots, resumable; differences are counted by kind, and one of each kind is minimised."""

from __future__ import annotations

import json
import re
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from ..crosscheck.campaign.executors import Connect, LostError, run
from ..crosscheck.campaign.store import Store
from ..crosscheck.checks import Case
from ..crosscheck.results import AGREES, DIFFERS, DUALPIN, NEITHER, NOT_COMPARED, ORACLE, RobotResult, TermResult
from ..crosscheck.run import provenance
from ..crosscheck.units import Result, Unit
from ..errors import ArgumentError, DualpinWarning
from ..machine import sources, versions
from .examine import SAMPLES, examine
from .generate import is_large, random_spec
from .small import ERROR, SmallCase, small_case

_NAMES = re.compile(r"joint '[^']*'")
EARLY = 40
"""After how many others a large robot comes."""
Kind = tuple[str, str]
"""A term (or identity), and who is nearer where it differs."""


@dataclass
class Outcome:
    """The outcome of a run on random robots.

    Attributes
    ----------
    robots : int
        How many were examined.
    verdicts : Counter
        Of robots.
    kinds : dict
        Of each kind of difference, the numbers of the robots that show it.
    silent : Counter
        Why a term was not compared, or an identity said nothing.
    compared : Counter
        How often each term and identity was.
    worst : dict
        Of each term and identity that agrees, the largest error over its tolerance.
    cases : list of SmallCase
        One or more robots of each kind, made small.
    """

    seed: int
    robots: int = 0
    verdicts: Counter[str] = field(default_factory=Counter)
    kinds: dict[Kind, list[int]] = field(default_factory=dict)
    silent: Counter[tuple[str, str]] = field(default_factory=Counter)
    compared: Counter[str] = field(default_factory=Counter)
    worst: dict[str, float] = field(default_factory=dict)
    cases: list[SmallCase] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=dict)
    partial: bool = False

    @property
    def passed(self) -> bool:
        """Whether dualpin is not the less accurate one in any difference that was decided."""
        return bool(self.robots) and not any(nearer in (ORACLE, NEITHER) for _, nearer in self.kinds)

    def add(self, number: int, result: RobotResult) -> None:
        self.robots += 1
        self.verdicts["error" if result.error else result.verdict] += 1
        if result.error:
            self.kinds.setdefault((ERROR + result.error.partition(":")[0], ORACLE), []).append(number)
        for name, t in result.terms.items():
            if t.status == NOT_COMPARED:
                self.silent[name, _NAMES.sub("a joint", t.reason or result.reason)] += 1
                continue
            self.compared[name] += 1
            if t.status == DIFFERS:
                self.kinds.setdefault((name, t.nearer), []).append(number)
            elif t.tolerance:
                self.worst[name] = max(self.worst.get(name, 0.0), t.max_scaled_error / t.tolerance)


def fuzz(
    robots: int = 1000,
    seed: int = 0,
    *,
    jobs: int = 1,
    executor: Executor | Connect | None = None,
    store: str | Path | None = None,
    small: int = 1,
    progress: Callable[[Result, int, int], None] | None = None,
) -> Outcome:
    """Examine random robots: every term against Pinocchio and the identities, by NumPy.

    Parameters
    ----------
    robots, seed : int
        Robots 0 to ``robots - 1`` of this seed; more of them later take up what a store holds.
    jobs, executor, store
        As in `dualpin.crosscheck.campaign.campaign`.
    small : int
        How many robots of each kind of difference are shrunk.
    progress : callable, optional
        Called with a result, the number of robots done, and of all.

    Returns
    -------
    Outcome
        On Ctrl-C of what was done, marked partial.

    Raises
    ------
    ArgumentError
        If a number is none, or the store cannot be written.

    Examples
    --------
    >>> from dualpin.fuzz import fuzz
    >>> fuzz(3, seed=7).passed
    True
    """
    for name, value, least in ("robots", robots, 1), ("seed", seed, 0), ("small", small, 0):
        if not isinstance(value, int) or value < least:
            raise ArgumentError(f"fuzz: {name} is {value!r}; a whole number from {least} expected")
    kept, outcome = Store(store), Outcome(seed, versions=provenance("numpy"))
    try:
        name = kept.campaign(_identity(seed), robots)
        done = kept.done(name)
        count = sum(1 for number in range(robots) if str(number) in done)
        try:
            for unit, result in run(_in_turn(robots, seed, done), _examined, jobs, executor):
                kept.add(name, unit, result)
                count += 1
                if progress:
                    progress(result, count, robots)
        except KeyboardInterrupt:
            outcome.partial = True
        except LostError as e:
            outcome.partial = True
            warnings.warn(f"{e}; what was found is kept, and the same call goes on", DualpinWarning, stacklevel=2)
        for unit in _units(robots, seed):
            found = kept.result(name, unit)
            if isinstance(found, RobotResult):
                outcome.add(unit.first, found)
    finally:
        kept.close()
    if not outcome.partial:
        _shrink(outcome, small)
    return outcome


def _identity(seed: int) -> str:
    made_with = {k: v for k, v in versions(sources=sources()).items() if k not in ("date", "machine")}
    return json.dumps({"robots": "random", "seed": seed, "samples": SAMPLES, "made_with": made_with}, sort_keys=True)


def _units(robots: int, seed: int) -> Iterator[Unit]:
    for number in range(robots):
        yield Unit(Case(f"random {seed}:{number}"), number, SAMPLES, seed, str(number))


def _in_turn(robots: int, seed: int, done: set[str]) -> list[Unit]:
    """What is left to do, a large robot after every EARLY others, so that a run that is stopped has seen some."""
    left = [u for u in _units(robots, seed) if u.key not in done]
    large = iter([u for u in left if is_large(u.first)])
    others = [u for u in left if not is_large(u.first)]
    turns = [u for i in range(0, len(others), EARLY) for u in [*others[i : i + EARLY], *islice(large, 1)]]
    return [*turns, *large]


def _examined(unit: Unit) -> Result:
    """A robot's result without the details of agreeing terms, so that 10^5 results stay small."""
    found = examine(random_spec(unit.seed, unit.first))
    found.terms = {name: t if t.status == DIFFERS else _short(t) for name, t in found.terms.items()}
    return found


def _short(t: TermResult) -> TermResult:
    short = TermResult(t.max_scaled_error, t.tolerance, status=t.status, reason=t.reason, compared=t.compared)
    if t.status == AGREES and t.worst:  # the bound of the sample that comes nearest to its own
        short.max_scaled_error = t.worst["ratio"] * t.tolerance
    return short


def _shrink(outcome: Outcome, small: int) -> None:
    """The robots with fewest joints of each kind of difference; errors of dualpin first."""
    order = [ORACLE, NEITHER, "undecided", DUALPIN]
    for (term, nearer), numbers in sorted(outcome.kinds.items(), key=lambda kind: order.index(kind[0][1])):
        sizes = {n: len(random_spec(outcome.seed, n).joints) for n in numbers}
        for number in sorted(numbers, key=sizes.__getitem__)[:small]:
            outcome.cases.append(small_case(random_spec(outcome.seed, number), term, nearer))
