"""Slices of one robot put together: the result of `compare` for all samples, whatever the order of the slices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import overload

import numpy as np

from .arbiter import worst_of
from .results import AGREES, DIFFERS, Refusal, RobotResult, TermResult, overall
from .tally import singular
from .units import Result, Unit


@overload
def merged(units: Sequence[Unit], results: Sequence[RobotResult], seed: int) -> RobotResult: ...


@overload
def merged(units: Sequence[Unit], results: Sequence[Result], seed: int) -> Result: ...


def merged(units: Sequence[Unit], results: Sequence[Result], seed: int) -> Result:
    """The result of a case with this seed from those of its slices, in their order."""
    if len(results) == 1:
        return results[0]
    for result in results:
        if isinstance(result, Refusal):
            return result
    parts = [r for r in results if isinstance(r, RobotResult)]
    first, firsts = parts[0], [u.first for u in units]
    return replace(
        first,
        samples=sum(u.samples for u in units),
        seed=seed,
        passed=all(r.passed for r in parts),
        terms={name: _term([r.terms[name] for r in parts if name in r.terms], firsts) for name in first.terms},
        notes=list(dict.fromkeys(note for r in parts for note in r.notes)),
        error=next((r.error for r in parts if r.error), ""),
        seconds=round(sum(r.seconds for r in parts), 3),
        status=overall(r.status for r in parts),
        reason=next((r.reason for r in parts if r.status == DIFFERS), first.reason),
    )


def _term(parts: Sequence[TermResult], firsts: Sequence[int]) -> TermResult:
    compared = [(t, first) for t, first in zip(parts, firsts, strict=True) if t.compared]
    if not compared:
        return parts[0]
    differing = [t for t, _ in compared if t.status == DIFFERS]
    worst, first = max(compared, key=lambda pair: (pair[0].status == DIFFERS, pair[0].worst.get("ratio", 0.0)))
    left_out, count = sum(t.left_out for t in parts), sum(t.compared for t in parts)
    found = replace(
        worst,
        max_scaled_error=max(t.max_scaled_error for t, _ in compared),
        compared=count,
        left_out=left_out,
        note=singular(left_out, left_out + count),
        worst=worst.worst | ({"sample": first + worst.worst["sample"]} if "sample" in worst.worst else {}),
        quantiles=_quantiles([t.quantiles for t, _ in compared]),
    )
    if differing:
        found.settle(DIFFERS, worst_of([t.nearer for t in differing]), worst.reason)
    else:
        found.settle(AGREES, reason=worst.reason)
    return found


def _quantiles(slices: Sequence[list[float]]) -> list[float]:
    """Of the largest errors the largest; of the others the median over the slices, which are draws of the same kind."""
    table = np.array([q for q in slices if q])
    if not table.size:
        return []
    return [*np.median(table[:, :-1], axis=0).tolist(), float(table[:, -1].max())]
