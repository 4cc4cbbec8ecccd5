"""Compare every term of one robot with the oracle, sample by sample."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..call import evaluate, made_ahead
from ..interpret import remembered
from ..model.robot import Robot
from ..terms import TERMS
from .arbiter import SECONDS, nearer, worst_of
from .arbiter import arbitrate as by_definition
from .check import GRAVITY, INERTIA, Case, Check
from .definitions import UndecidedError
from .extent import Extent
from .fingerprint import fingerprint
from .oracles import Oracle
from .pairing import Pair, paired
from .reading import Difference
from .results import AGREES, DIFFERS, NOT_COMPARED, UNDECIDED, RobotResult, TermResult
from .sampling import batches, states
from .tally import Tally
from .tolerance import Reference
from .where import locate

LAST_DIGITS = 1e-13
"""A scaled error from which agreeing terms are arbitrated too, if asked for."""

WEIGHTLESS = "no moving body has mass"


def compare(
    case: Case, samples: int, seed: int, checks: Sequence[Check], engine: str, arbitrate: bool = False
) -> RobotResult:
    """All checks of one robot."""
    start = time.perf_counter()
    pair, engine = paired(case), case.engine or engine
    if pair.oracle is None:
        terms = {c.term: TermResult(status=NOT_COMPARED, reason="the joints are not the same") for c in checks}
    else:
        terms = _Comparison(pair, pair.oracle, samples, seed, engine).results(checks, arbitrate)
    robot = pair.robot
    found = RobotResult(
        case.name, pair.floating, case.mimic or robot.coupled, robot.nv, samples, seed, True, terms,
        [*robot.notes, *pair.notes, *(d.says for d in pair.apart)], engine=used_engine(engine),
        model=fingerprint(robot),
    )  # fmt: skip
    weighing = [terms[c.term] for c in checks if c.weighs]
    if pair.oracle is None:
        found.passed, found.status, found.reason = False, DIFFERS, _said(pair.apart)
    elif found.status == DIFFERS:
        found.reason = _said(pair.apart)
    elif found.status == AGREES and weighing and all(t.status == NOT_COMPARED for t in weighing):
        found.status, found.reason = NOT_COMPARED, f"{weighing[0].reason}: only its kinematics can be compared"
    found.seconds = round(time.perf_counter() - start, 3)
    return found


def used_engine(asked: str) -> str:
    """The engine that computes where this one is requested."""
    if asked != "auto":
        return asked
    from ..engine.jit.host import CompilerError, this_host

    try:
        this_host()
    except CompilerError:
        return "numpy"
    return "compiled"


@dataclass
class _Comparison:
    """A robot and its oracle on the same states."""

    pair: Pair
    oracle: Oracle
    samples: int
    seed: int
    engine: str

    @property
    def robot(self) -> Robot:
        return self.pair.robot

    def results(self, checks: Sequence[Check], arbitrate: bool) -> dict[str, TermResult]:
        """Those that cannot be compared with the reason, the others batch by batch, and the differences decided."""
        variants = {c.term: [o for o in c.variants(self.robot, self.seed) if self.oracle.offers(o)] for c in checks}
        hindered = {c.term: _hindrance(c, self.pair, variants[c.term]) for c in checks}
        here = "auto" if self.engine == "cuda" else self.engine  # states are made on the host
        given = states(self.robot, self.samples, self.seed, here) | {"sample": np.arange(self.samples)}
        (poses,) = self.oracle.compute("fk", {"q": given["q"]})
        extent = Extent(self.robot, poses[..., :3, 3], {key: given[key] for key in ("v", "a", "f_ext")})
        tallies = {c: Tally() for c in checks if not hindered[c.term]}
        wanted = [(c, o) for together in _groups(list(tallies)) for c in together for o in variants[c.term]]
        with made_ahead(self.robot, [(c.term, o) for c, o in wanted], self.engine):
            self._gather_all(tallies, variants, given, extent)
        found = {term: TermResult(status=NOT_COMPARED, reason=reason) for term, reason in hindered.items()}
        for check, tally in tallies.items():
            found[check.term] = self._judged(check, tally, variants[check.term], given, arbitrate)
        return found

    def _gather_all(
        self, tallies: dict[Check, Tally], variants: dict[str, list[dict[str, Any]]], given: dict[str, np.ndarray],
        extent: Extent,
    ) -> None:  # fmt: skip
        for together in _groups(list(tallies)):
            largest = max(int(np.prod(self._shape(c, variants[c.term][0]), dtype=int)) for c in together)
            for part in batches(self.samples, largest, self.engine):
                batch = {key: x[part] for key, x in given.items()}
                reference = Reference(self.robot, batch, extent.part(part), partial(self._asked, batch))
                for check in together:
                    with remembered():  # one term with many options
                        self._gather(tallies[check], check, variants[check.term], reference)

    def _shape(self, check: Check, options: dict[str, Any]) -> tuple[int, ...]:
        return TERMS[check.term].shape(self.robot, **options)

    def _asked(self, batch: dict[str, np.ndarray], term: str) -> np.ndarray:
        (found,) = self.oracle.compute(term, {key: batch[key] for key in TERMS[term].inputs})
        return found

    def _gather(self, tally: Tally, check: Check, variants: list[dict[str, Any]], reference: Reference) -> None:
        batch = reference.states
        inputs = {name: batch[name] for name in check.inputs.values()}
        named = {key: batch[name] for key, name in check.inputs.items()}
        answers = self.oracle.compute(check.term, inputs, variants)
        n = len(batch["q"])
        for variant, (options, theirs) in enumerate(zip(variants, answers, strict=True)):
            ours = evaluate(self.robot, check.term, named, engine=self.engine, **options)
            bound = check.bound(reference, theirs)
            left_out = bound.empty | (reference.mass.hopeless if check.solves else False)
            tally.add(
                ours.reshape(n, -1), theirs.reshape(n, -1), bound.value, batch["sample"], variant, left_out,
                bound.rounding,
            )  # fmt: skip
            tally.reason = bound.reason

    def _judged(
        self, check: Check, tally: Tally, variants: list[dict[str, Any]], given: dict[str, np.ndarray], arbitrate: bool
    ) -> TermResult:
        """The verdict on a term; 50 digits of one robot cannot decide between two robots."""
        result = tally.result(self.oracle.source(check.term), given)
        if not result.worst:
            return result
        result.worst["where"] = locate(self.robot, check.term, result.worst["entry"], variants[result.worst["variant"]])
        apart = [d for d in self.pair.apart if _matters(d, check)]
        if result.status == DIFFERS and apart:
            result.settle(DIFFERS, UNDECIDED, _said(apart))
        elif result.status == DIFFERS or (arbitrate and result.max_scaled_error > LAST_DIGITS):
            self._arbitrate(result, check, tally, variants, given)
        return result

    def _arbitrate(
        self, result: TermResult, check: Check, tally: Tally, variants: list[dict[str, Any]],
        given: dict[str, np.ndarray],
    ) -> None:  # fmt: skip
        """Ask the definition of the term at its worst sample, and at some others that are out of tolerance.

        Where the ceiling was exceeded and both are within the rounding of what cancels, nothing differs.
        """
        verdicts: list[str] = []
        rows, explained = tally.rows(result.status), 0
        reason, until = "", time.thread_time() + SECONDS
        for row in rows:
            options, state = variants[row["variant"]], {key: given[key][row["sample"]] for key in check.inputs.values()}
            shape = self._shape(check, options)
            index = tuple(int(i) for i in np.unravel_index(row["entry"], shape)) if shape else ()
            try:
                found = by_definition(
                    self.robot, check, state, index, row["dualpin"], row["oracle"], row["scale"],
                    until - time.thread_time(), **options,
                )  # fmt: skip
            except UndecidedError as e:
                if not verdicts:  # the worst sample itself; others are judged as far as time allows
                    verdicts, reason = [UNDECIDED], str(e)
                break
            result.worst.setdefault("against_50_digits", found)
            verdicts.append(nearer(found, row["rounding"]))
            explained += row["bound"] < row["rounding"] >= max(found.values())
        if result.status == DIFFERS and explained == len(rows):
            _explain(result, rows[0]["rounding"])
        elif result.status == DIFFERS:
            result.settle(DIFFERS, worst_of(verdicts), reason)


def _explain(result: TermResult, rounding: float) -> None:
    """Agree although the tolerance is exceeded: 50 digits find both answers within this."""
    result.settle(AGREES)
    result.worst["ratio"], result.tolerance = result.worst["ratio"] * result.tolerance / rounding, rounding
    result.tolerance_reason += "; beyond that, 50 digits find both within the rounding of what cancels"


def _hindrance(check: Check, pair: Pair, variants: list[dict[str, Any]]) -> str:
    """Why a term cannot be compared, if it cannot."""
    if pair.oracle and check.term not in pair.oracle.terms:
        return f"{pair.oracle.name} does not answer it"
    if check.weighs and pair.robot.mass == 0:
        return WEIGHTLESS
    if not variants:
        return "the oracle has none of the frames"
    links = [name for d in pair.apart for name in d.unread]
    if not (INERTIA in check.enters and links and pair.oracle):
        return ""
    complaints = [c for c in pair.oracle.description.complaints if "Could not parse" not in c]
    heard = f" ({'; '.join(complaints[:3])})" if complaints else ""
    return f"the oracle did not read {'link' if len(links) == 1 else 'links'} {', '.join(links)}{heard}"


def _matters(difference: Difference, check: Check) -> bool:
    """Whether a difference of two robots enters a term."""
    return difference.about == "joint" or (GRAVITY if difference.about == "gravity" else INERTIA) in check.enters


def _said(apart: Sequence[Difference], most: int = 3) -> str:
    more = f"; and {len(apart) - most} more" if len(apart) > most else ""
    return "; ".join(d.says for d in apart[:most]) + more


def _groups(checks: Sequence[Check]) -> list[list[Check]]:
    """Terms by themselves, but those that solve with M together: how well it can be solved with is found once."""
    solving = [c for c in checks if c.solves]
    return [[c] for c in checks if not c.solves] + ([solving] if solving else [])
