"""Where an unexplained answer is off, what explains part of it, and whether it is only less precise."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ..findings import Finding
from ..subjects.layout import product, transposed
from ..subjects.questions import QUESTIONS
from .case import Case, evaluate
from .hypothesis import ESTIMATED
from .spared import spared
from .stories import Explanation

NEARLY = 1e-2
"""A story that leaves less than this share of the error explains it nearly."""
MOST = 0.5
"""A story that puts this share of the wrong entries right, and leaves at most this of the rest, explains part."""
NEARLY_ALL = 0.99
"""The share of entries that a slip, or another cause than those of other terms, must put right.

A few come right by chance; what was read wrongly of some links shows in their entries alone."""
SINGLE = (1e-9, 1e-5)
"""Where errors of single precision lie."""


DERIVED = {
    "jacobian_dot": ("jacobian", "fk"), "coriolis": ("crba",), "gravity": ("potential_energy",), "jacobian": ("fk",),
    "com_jacobian": ("com",), "rnea_derivatives": ("rnea",), "aba_derivatives": ("aba",),
}  # fmt: skip
"""What a term is the derivative of."""
EXACT = 1e-12


def _exact(case: Case, term: str) -> bool:
    return term in case.observed and case.score(term).error < EXACT


def partly(
    case: Case, term: str, e: Explanation, where: str, known: Collection[object] = ()
) -> Finding | None:  # fmt: skip
    """The nearest story, where it explains a good part; beside causes that are `known`, nearly all if it is another."""
    if not e.nearest or e.left is None:
        return None
    nearly = e.left.error < NEARLY * min(1.0, e.before.error)  # 1 is the scale of the right answer
    others = [h for h in e.nearest if h.key != "follows" and h.cause not in known]
    claims = others if known else [h for h in others if h.place == "formula"]
    if claims and not nearly and e.left.share < NEARLY_ALL:
        return None
    righted = (e.left.share - e.before.share) / max(1e-300, 1 - e.before.share)
    mostly = righted >= MOST and e.left.rms <= MOST * e.before.rms and e.left.error <= e.before.error
    if not (nearly or mostly) or any(h.key in ESTIMATED for h in e.nearest):
        return None
    story = " and ".join(map(str, e.nearest))
    if e.left.right:
        against = ", ".join(dict.fromkeys(t for h in e.nearest for t in spared(case, h)))
        says = f"perhaps: {story}; this gives the answers, but would change {against} too, where nothing differs"
    elif nearly:
        says = f"nearly: {story} leaves {e.left.error:.0e}" + (f"; {where}" if where else "")
    else:
        share = f"{e.left.share:.0%} of the entries right ({e.before.share:.0%} before)"
        says = f"partly: {story} puts {share}" + (f"; {where}" if where else "")
    items = list(dict.fromkeys(i for h in e.nearest for i in h.items))
    fix = "; ".join(dict.fromkeys(h.fix for h in e.nearest if h.fix))
    return Finding(
        "partly",
        says,
        [term],
        e.before.error,
        e.left.error,
        items,
        fix=fix,
        evidence={term: [e.before.error, e.left.error]},
    )


def no_factor(case: Case, term: str) -> Finding | None:
    """No finite inverse of a mass matrix, which the subject answers too, and which is not positive definite."""
    M = case.observed.get("crba")
    if term != "minv" or M is None or np.isfinite(case.observed[term]).all(axis=(1, 2)).any():
        return None
    if not np.isfinite(M).all() or (np.linalg.eigvalsh((M + transposed(M)) / 2).min(axis=1) > 0).any():
        return None
    says = "no finite number: the subject's mass matrix is not positive definite, so it has no Cholesky factor"
    error = float("inf")
    return Finding("follows", says, [term], error, error, fix="repair crba first", evidence={term: [error, error]})


def in_single(case: Case, term: str) -> bool:
    """Whether answers are float32 numbers, and no more wrong than that makes them."""
    low, high = SINGLE
    x = case.observed[term]
    y = x[np.isfinite(x) & (np.abs(x) > 1e-6) & (np.abs(x) != 1)]
    return low < case.score(term).error < high and len(y) > 0 and bool((y == y.astype(np.float32)).mean() > 0.2)


def precision(case: Case, term: str, e: Explanation) -> Finding | None:
    """Single precision: answers that are all float32 numbers, or an error as large as float32 arithmetic makes."""
    low, high = SINGLE
    if not low < e.before.error < high:
        return None
    rounded, made = in_single(case, term), _single(case, term)
    if not rounded and not (0.02 * made < e.before.error < 20 * made):
        return None
    if not rounded and term in DERIVED and any(_exact(case, t) for t in DERIVED[term]):
        says = "less precise than what it is derived from: finite differences leave so much"
        fix = "derive it exactly, or say how precise it is"
        return Finding(
            "finite_differences", says, [term], e.before.error, e.before.error, fix=fix,
            evidence={term: [e.before.error, e.before.error]},
        )  # fmt: skip
    how = "answers are float32 numbers" if rounded else "the error is as large as float32 arithmetic makes it"
    says = f"computed in single precision: {how}"
    return Finding(
        "single_precision", says, [term], e.before.error, e.before.error, fix="compute in double precision",
        evidence={term: [e.before.error, e.before.error]},
    )  # fmt: skip


def _single(case: Case, term: str) -> float:
    """The error of this term where states and arithmetic are float32."""
    view = case.view(())
    if view is None:
        return 0.0
    inputs = {k: x[None].astype(np.float32) for k, x in view.states.items()}
    reference = view.layout.how.reference
    exact = evaluate(view.robot, QUESTIONS[term], {k: x[None] for k, x in view.states.items()}, case.frames, reference)
    single = evaluate(view.robot, QUESTIONS[term], inputs, case.frames, reference)
    return float(np.abs(single - exact).max() / max(1.0, np.abs(exact).max()))


def located(case: Case, term: str, e: Explanation) -> str:
    """The rows, entries or frames that are off, and stay so under the nearest story where it has been scored."""
    x, p, nearer = case.observed[term], case.predict(term), case.predict(term, e.nearest if e.left is not None else ())
    if p is None or x.shape != p.shape:
        return ""
    d = np.abs(_apart(case, term, x, p))
    if nearer is not None and nearer.shape == x.shape:  # what a story makes wrong is right without it
        d = np.fmin(d, np.abs(_apart(case, term, x, nearer)))
    names, form = list(case.how.v), QUESTIONS[term].form
    if QUESTIONS[term].framed:  # each in its own scale, as its score is
        d, size = (y.reshape(len(y), len(case.frames), -1) for y in (d, np.abs(p)))
        bound = case.tolerance * np.fmax(1.0, size.max(axis=2, keepdims=True))
        off = [f for f, wrong in zip(case.frames, (d > bound).any(axis=(0, 2)), strict=True) if wrong]
        return f"off for {len(off)} of {len(case.frames)} frames" + _some(off)
    with np.errstate(all="ignore"):
        d = d / max(1.0, float(np.nanmax(np.abs(p))))
    limit = 10 * case.tolerance
    if form in ("matrix", "inverse", "coriolis"):
        bad = np.nanmax(d, axis=0) > limit
        where = ", on the diagonal only" if bad.any() and not (bad & ~np.eye(len(bad), dtype=bool)).any() else ""
        rows = [n for n, row in zip(names, bad, strict=True) if row.any()]
        return f"off in {int(bad.sum())} of {bad.size} entries{where}" + _some(rows)
    if form in ("columns", "six"):
        columns = [n for n, y in zip(names, np.nanmax(d, axis=(0, 1)), strict=True) if y > limit]
        return f"off in {len(columns)} of {len(names)} columns" + _some(columns)
    if d.ndim == 2 and d.shape[1] == len(names):
        rows = [n for n, y in zip(names, np.nanmax(d, axis=0), strict=True) if y > limit]
        return f"{'forces M da ' if term == 'aba' else ''}off in {len(rows)} of {len(names)} rows" + _some(rows)
    return ""


def _apart(case: Case, term: str, x: np.ndarray, p: np.ndarray) -> np.ndarray:
    """The difference of an answer and a prediction; of forward dynamics, in forces."""
    M = case.predict("crba") if term == "aba" else None
    return x - p if M is None else product(M, x - p)


def _some(names: list[str], most: int = 6) -> str:
    return f" ({', '.join(names)})" if 0 < len(names) <= most else ""
