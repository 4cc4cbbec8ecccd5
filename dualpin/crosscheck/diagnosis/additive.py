"""Two mistakes that change an answer by the sum of what each changes, found without trying pairs.

Where an answer is a sum, a mistake in one of its terms and one in another change it by d_A + d_B, and each of the two
is known from the mistake alone.  Along any direction d_B must be what d_A leaves of the whole difference, so that the
pairs among n changes are found by sorting, in n log n.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from .case import Case
from .hypothesis import Hypothesis, Story, cost, ordered
from .stories import joins
from .textbook.slipped import share

MOST = 24
"""Pairs of different changes that are looked at: more of them say that too little was asked."""
LIKELY = 16
"""Of hypotheses that change the same."""
ALIKE = 12
"""Pairs of hypotheses that are looked at for each of those, since many change the same."""
TOLERANCE = 1e-9


def adding_up(changes: np.ndarray, whole: np.ndarray, tolerance: float) -> Iterator[tuple[int, int]]:
    """Pairs of rows of `changes` (n, size) whose sum is `whole` (size,), to within the tolerance in every entry.

    Examples
    --------
    >>> list(adding_up(np.array([[1.0, 0.0], [2.0, 1.0], [0.0, 3.0]]), np.array([1.0, 3.0]), 1e-9))
    [(0, 2)]
    """
    direction = _direction(len(whole))
    along, rest = changes @ direction, whole @ direction
    order = np.argsort(along)
    low, high = (np.searchsorted(along[order], rest - along + k * tolerance) for k in (-1, 1))
    for i in np.flatnonzero(high > low):
        for j in order[low[i] : high[i]]:
            if i < j and np.abs(changes[i] + changes[j] - whole).max() <= tolerance:
                yield int(i), int(j)


def _direction(size: int) -> np.ndarray:
    """Of entries that add up to no more than 1, so that what lies within a tolerance does so along it too."""
    d = np.random.default_rng(size).standard_normal(size)
    return np.asarray(d / np.abs(d).sum())


def pairs(
    few: Case, term: str, predicted: Iterable[tuple[Sequence[Hypothesis], np.ndarray | None]]
) -> list[Story]:  # fmt: skip
    """Stories of two hypotheses, of those that predict the same for few states, that add up to what is observed."""
    x, right = few.observed[term], few.predict(term)
    if right is None or x.shape != right.shape or not np.isfinite(x).all() or term == "fk":
        return []
    kept = [(same, p) for same, p in predicted if p is not None and p.shape == right.shape]
    if not kept:
        return []
    tolerance = TOLERANCE * max(1.0, float(np.abs(right).max()))
    with np.errstate(all="ignore"):  # some predictions are no numbers
        changes = np.array([p.ravel() for _, p in kept]) - right.ravel()
        along = changes @ _direction(right.size)
    groups: dict[str, tuple[int, list[Hypothesis]]] = {}
    for k in np.flatnonzero(np.isfinite(along) & (np.abs(changes).max(axis=1) > tolerance)):
        groups.setdefault(f"{along[k]:.9g}", (int(k), []))[1].extend(kept[k][0])  # what changes all alike is one
    if not groups:
        return []
    first, alike = zip(*groups.values(), strict=True)
    found = itertools.islice(adding_up(changes[list(first)], (x - right).ravel(), tolerance), MOST)
    return [story for i, j in found for story in _joined(alike[i], alike[j])]


def likeliest(case: Case, term: str, story: Story, others: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Causes beside a story, in the order of what they would leave if the changes of both added up."""
    x, right, beside = case.observed[term], case.predict(term), case.predict(term, story)
    if right is None or beside is None or not right.shape == beside.shape == x.shape:
        return list(others)
    whole = x - beside + right

    def left(p: np.ndarray | None) -> float:
        away = np.inf if p is None or p.shape != x.shape else float(np.linalg.norm(whole - p))
        return away if np.isfinite(away) else np.inf

    predicted = case.predictions(term, [(h,) for h in others])
    order = np.argsort([left(p) for p in predicted], kind="stable")
    return [others[k] for k in order]


def likeliest_pairs(case: Case, term: str, hypotheses: Sequence[Hypothesis], most: int) -> list[Story]:
    """Pairs, in the order of what they would leave if their changes added up; accelerations count by their forces."""
    x, right = case.observed[term], case.predict(term)
    if right is None or x.shape != right.shape or not np.isfinite(x).all():
        return []
    M = case.predict("crba") if term == "aba" else None

    def change(p: np.ndarray) -> np.ndarray:
        d = p - right
        return (d if M is None else np.einsum("nij,nj->ni", M, d)).ravel()

    predicted = case.predictions(term, [(h,) for h in hypotheses])
    made = [(h, change(p)) for h, p in zip(hypotheses, predicted, strict=True) if p is not None and p.shape == x.shape]
    made = [(h, d) for h, d in made if np.isfinite(d).all() and np.abs(d).max() > 0]
    if len(made) < 2:
        return []
    changes, whole = np.array([d for _, d in made]), change(x)
    alone = (changes**2).sum(1) - 2 * changes @ whole
    left = alone[:, None] + alone + 2 * changes @ changes.T  # |d_i + d_j - whole|^2, less |whole|^2
    i, j = np.triu_indices(len(made), 1)
    order = np.argsort(left[i, j], kind="stable")
    pairs = ((made[i[k]][0], made[j[k]][0]) for k in order[: 4 * most])
    return list(itertools.islice((ordered(two) for two in pairs if joins(two[1], two[:1])), most))


def _joined(some: Sequence[Hypothesis], others: Sequence[Hypothesis]) -> list[Story]:
    """Those of one algorithm first, then the cheapest."""
    likely = [sorted(same, key=lambda h: h.cost)[:LIKELY] for same in (some, others)]
    together = [(g, h) for g, h in itertools.product(*likely) if joins(h, (g,))]
    together.sort(key=lambda two: (not _alike(*two), cost(two)))
    return [ordered(two) for two in together[:ALIKE]]


def _alike(g: Hypothesis, h: Hypothesis) -> bool:
    return not g.place == h.place == "formula" or share(g.act, h.act)
