"""All hypotheses of a case, and the slips of textbook algorithms that explain a term or come near."""

from __future__ import annotations

import itertools
import time
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ..subjects.questions import QUESTIONS
from . import additive
from .case import Case
from .hypothesis import Hypothesis, Story, ordered, style
from .rules import RULES
from .rules.register import MERGING, SLIPS, Rule
from .scores import Score
from .stories import in_time, kept, minimal, nearness, throughout
from .textbook.slipped import algorithm, made_of, made_with, share

AT_ONCE, SHORT = 800, 100  # slips that are scored before the time is looked at; by which algorithms count as short
SQUARE = ("matrix", "inverse", "coriolis", "derivatives")  # one state tells enough to look at slips first
MANY = 24  # stories of which those that come nearest at few states are looked at in all
PAIRS = 120  # of slips of one algorithm that are tried
FEW = 1e-7
"""The error of a slip at these states up to which it is looked at in all."""


class Catalogue:
    """All hypotheses of a case, proposed once; those of late rules when they are first needed."""

    def __init__(self, case: Case) -> None:
        self.case, self._cases = case, dict[int, Case]()
        self.settled: set[str] = set()
        """Terms of which a cause is found, of their own or of the terms that they are made of."""
        few = case.asking.samples < 2  # at one state what need only have something in common with an answer has it
        proposed = (h for rule in RULES if not rule.late for h in rule.propose(case))
        self.all: list[Hypothesis] = [h for h in proposed if not (few and h.place == "relation")]
        self._proposed: dict[int, list[Hypothesis]] = {}
        self._late: dict[tuple[int, str], dict[Any, list[Hypothesis]]] = {}
        self._kin: dict[tuple[int, str, Any], list[Hypothesis]] = {}
        self._algorithms: dict[tuple[str, int], dict[Any, list[Hypothesis]]] = {}
        self._looked_at: dict[str, list[list[Hypothesis]]] = {}

    def _of_rules(self, late: int, term: str) -> dict[Any, list[Hypothesis]]:
        """Those of late rules that show in a term, by mistakes."""
        if (late, term) not in self._late:
            found: dict[Any, list[Hypothesis]] = {}
            for k, rule in enumerate(RULES):
                for h in self._of_rule(k, rule, term) if rule.late == late else ():
                    found.setdefault(h.mistake or h.cause, []).append(h)
            self._late[late, term] = found
        return self._late[late, term]

    def _of_rule(self, k: int, rule: Rule, term: str) -> Iterable[Hypothesis]:
        if rule.of_term:
            return rule.of_term(self.case, term)
        if k not in self._proposed:
            self._proposed[k] = list(rule.propose(self.case))
        return (h for h in self._proposed[k] if term in h.terms)

    def _by_algorithm(self, term: str, late: int) -> Iterable[list[Hypothesis]]:
        """Those of late rules for a term, together if one algorithm makes them."""
        if (term, late) not in self._algorithms:
            found: dict[Any, list[Hypothesis]] = {}
            for h in (h for same in self._of_rules(late, term).values() for h in same if not h.afterwards):
                found.setdefault((h.place, algorithm(h.act) or h.act), []).append(h)
            self._algorithms[term, late] = found
        return self._algorithms[term, late].values()

    def of(self, term: str, single: bool, error: float) -> list[Hypothesis]:
        return [h for h in self.all if term in h.terms and h.single == single and error < h.most]

    @property
    def used(self) -> frozenset[int]:
        """The late rules that were needed so far."""
        return frozenset(late for late, _ in self._late)

    def kin(self, h: Hypothesis, term: str) -> list[Hypothesis]:
        """The same mistake as other formulations, or what is made of them, show it."""
        mistake, found = h.mistake or h.cause, list[Hypothesis]()
        for late in self.used:
            if (late, term) in self._late:
                found += self._late[late, term].get(mistake, ())
                continue
            if (late, term, mistake) not in self._kin:  # the others are not needed yet
                # algorithms show mistakes of steps alone: to find their steps takes long
                rules = [
                    (k, rule) for k, rule in enumerate(RULES) if rule.late == late and (h.mistake or not rule.of_term)
                ]
                self._kin[late, term, mistake] = [
                    x for k, rule in rules for x in self._of_mistake(k, rule, term, mistake)
                ]
            found += self._kin[late, term, mistake]
        return found

    def _beside(self, term: str, run: Any) -> Mapping[Any, Sequence[Hypothesis]]:
        """Slips of an algorithm that are only looked for beside others of it, by mistakes."""
        return next((rule.beside(self.case, term) for rule in RULES if rule.algorithm == run), {})

    def together(self, h: Hypothesis, kin: Iterable[Story], others: Iterable[Story], term: str) -> list[Story]:
        """How a cause shows beside others: as its kin, and in the algorithms that are made with theirs."""
        runs = {r for s in others for g in s if (r := algorithm(g.act)) is not None}
        rules = [rule for rule in RULES if rule.algorithm and any(made_with(rule.algorithm, r) for r in runs)]
        mistake = h.mistake or h.cause
        return [*kin, *((g,) for rule in rules for g in rule.beside(self.case, term).get(mistake, ()))]

    def _of_mistake(self, k: int, rule: Rule, term: str, mistake: Any) -> Iterable[Hypothesis]:
        if rule.of_term:
            return rule.of_mistake(self.case, term, mistake)
        return (h for h in self._of_rule(k, rule, term) if (h.mistake or h.cause) == mistake)

    def slips(self, term: str, until: float, base: Story = (), late: int = SLIPS) -> list[Story]:
        """Single slips of textbook algorithms: those that explain the first states, and those that come nearest.

        `base` is a story that holds besides; `late` says of which rules they are.
        """
        few = self._few(term)
        groups: dict[Any, list[Hypothesis]] = {}
        formulas = [h.act for h in base if h.place == "formula"]
        for some in self._by_algorithm(term, late):
            if algorithm(some[0].act) in map(algorithm, formulas):
                some = [*some, *itertools.chain(*self._beside(term, algorithm(some[0].act)).values())]
            if base and (some[0].place != "formula" or not all(share(some[0].act, act) for act in formulas)):
                continue  # one term is not made by two algorithms, and each edit of the file is a robot of its own
            for h in some:
                groups.setdefault(made_of(h.act, term), []).append(h)
        # the subject's own answers put together are soon seen; then come algorithms with slips told, and short ones
        sizes = Counter(algorithm(same[0].act) for same in groups.values())
        styles = {style(h) for stories in self.case.told.values() for s in stories[:1] for h in s}

        def later(same: list[Hypothesis]) -> tuple[int, ...]:
            h = same[0]
            return not h.made_of, style(h) not in styles, sizes[algorithm(h.act)] // SHORT

        alike = sorted(groups.values(), key=later)
        known = {h.identity: same for same in alike for h, _ in few.known(term, same[:1])} if base else {}
        if known:  # those that were looked at alone come first, the likeliest first
            likely = additive.likeliest(few, term, base, [same[0] for same in known.values()])
            unknown = [same for same in alike if same[0].identity not in known]
            alike = [*(known[h.identity] for h in likely), *unknown]
        scores = list[Score]()
        for block in in_time(alike, until, AT_ONCE):
            scores += few.scores(term, [ordered((*base, same[0])) for same in block])
            found = [same[0] for same, x in zip(alike, scores, strict=False) if x.error <= FEW]
            if base and (any(h.named for h in found) or (found and len(scores) <= len(known))):
                break  # others would be told as alternatives only, or are less likely
        told = list(zip(alike, scores, strict=False))
        if not base:
            self._looked_at.setdefault(term, []).extend(same for same, _ in told)
        right = [ordered((*base, h)) for same, score in told if score.error <= FEW for h in same]
        near = [nearness(ordered((*base, same[0])), x) for same, x in told if np.isfinite(x.error)]
        return right or kept(near)

    def helpers(self, term: str) -> list[Story]:
        """Slips in a function that both merging fixed links and another algorithm call."""
        merging, others = (self._of_rules(late, term) for late in (MERGING, SLIPS))
        both = [(*merging[mistake], *others[mistake]) for mistake in merging if mistake in others]
        return [s for same in both for s in throughout(same)]

    def two_slips(self, term: str, until: float) -> list[Story]:
        """Two slips of one algorithm that explain the first states, of those whose changes nearly add up."""
        few = self._few(term)
        made = [some for some in self._by_algorithm(term, SLIPS) if some[0].place == "formula"]
        told = {style(h) for stories in self.case.told.values() for s in stories[:1] for h in s}
        for some in sorted(made, key=lambda some: (style(some[0]) not in told, some[0].cost)):
            if time.thread_time() > until:
                break
            every = [*some, *itertools.chain(*self._beside(term, algorithm(some[0].act)).values())]
            different = {made_of(h.act, term): h for h in reversed(every)}
            pairs = additive.likeliest_pairs(few, term, [*different.values()], PAIRS)
            found = [s for s, x in zip(pairs, few.scores(term, pairs), strict=True) if x.error <= FEW]
            if found:
                return found
        return []

    def nearest(
        self, term: str, stories: Sequence[Story], until: float, first: bool = False
    ) -> Sequence[Story]:  # fmt: skip
        """Of many, those that explain the first states, or the `first` that do; and those that come nearest."""
        if len(stories) < MANY:
            return stories
        scores, few = list[Score](), self._few(term)
        for block in in_time(stories, until, AT_ONCE):
            scores += few.scores(term, block)
            if first and any(x.error <= FEW for x in scores):
                break
        stories = stories[: len(scores)]
        right = minimal([s for s, x in zip(stories, scores, strict=True) if x.error <= FEW])
        return right + kept([nearness(s, x) for s, x in zip(stories, scores, strict=True) if np.isfinite(x.error)])

    def sums(self, term: str, others: Sequence[Hypothesis]) -> list[Story]:
        """Two causes whose changes add up: slips that were looked at, and others that were."""
        few = self._few(term)
        slips = ((same, few.predict(term, (same[0],))) for same in self._looked_at.get(term, ()))
        plain = (((h,), p if p is None else p[: few.asking.samples]) for h, p in self.case.known(term, others))
        return additive.pairs(few, term, [*slips, *plain])

    def _few(self, term: str) -> Case:
        samples = 1 if QUESTIONS[term].form in SQUARE else 2
        if samples not in self._cases:
            self._cases[samples] = self.case.few(samples)
        return self._cases[samples]
