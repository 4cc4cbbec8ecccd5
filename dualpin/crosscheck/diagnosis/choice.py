"""The fewest hypotheses that explain all terms together."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from .case import Case
from .hypothesis import Hypothesis, Story, cost, identity, style
from .spared import READ, spared
from .stories import Explanation

VISITS = 50_000  # of the search for the cheapest common story
AGAIN = 0.1
"""What a cause costs that another formulation shows, where it was told already."""
ALIKE = 0.03
"""What a slip costs less in a formulation in which another cause is told: one code has one way of writing."""
MOST = 16  # stories of a term that it looks at
DOUBT = 0.35
"""What a cause costs besides, times the share of the terms it would have changed that are right without it."""
DOUBTED = 0.5
"""The same of a mistake in reading, which is made once for all terms."""
OWN = ("gravity",)
"""Keys of numbers that each function may have for itself: right terms contradict them half as much."""
APART = ("kinetic_energy", "coriolis")
"""Terms that codes often make in a way of their own: a slip of other terms is not contradicted where they are right."""
LONELY = 2  # terms that a cause explains, so that one of others is looked for
FOLLOWING = 0.9
"""How much less it claims that a term differs as others do, where these are explained: it names no other mistake."""


def prices(case: Case, explained: Collection[str]) -> Callable[[Hypothesis], float]:
    """What right terms contradict costs more; what follows from terms that are explained, less."""
    off = {t for t in case.observed if not case.score(t).right}

    def price(h: Hypothesis) -> float:
        if h.key == "follows" and set(h.made_of) <= set(explained):
            return h.cost - FOLLOWING
        against = {t for t in spared(case, h) if h.place != "formula" or t not in APART}
        doubt = (DOUBTED if h.place in READ else DOUBT) / (1 + (h.key in OWN))
        return h.cost + (doubt * len(against) / len(against | (off & set(h.terms))) if against else 0.0)

    return price


def cheapest(
    options: Mapping[str, Sequence[Story]], price: Callable[[Hypothesis], float] = lambda h: h.cost
) -> dict[str, Story]:
    """One story for each term, so that all hypotheses together cost least: by branch and bound.

    A cause that other formulations show as well is paid once, but for `AGAIN`; its variants are paid once.  Causes in
    one formulation cost less than in several.
    """
    terms = sorted(options, key=lambda t: len(options[t]))
    told_by = Counter(key for stories in options.values() for key in {as_causes(s) for s in stories})
    worth = {t: {identity(s): sum(map(price, s)) for s in stories} for t, stories in options.items()}
    likely = {
        t: sorted(x, key=lambda s: (-told_by[as_causes(s)], worth[t][identity(s)]))[:MOST] for t, x in options.items()
    }
    least: dict[Any, float] = {}  # of each cause's variants
    styles: dict[Any, str] = {}
    for h in (h for stories in options.values() for s in stories for h in s):
        least[cause_of(h), h.cause] = min(least.get((cause_of(h), h.cause), math.inf), price(h))
        styles[cause_of(h), h.cause] = style(h)
    best: tuple[float, float] = (math.inf, math.inf)
    picked: dict[str, Story] = {}
    visits = 0

    def new(s: Story, claimed: Mapping[Any, float]) -> dict[Any, float]:
        """What a story claims besides."""
        causes, told = {key[0] for key in claimed}, {styles[key] for key in claimed} - {""}
        fresh = [key for h in s if (key := (cause_of(h), h.cause)) not in claimed]
        return {key: AGAIN if key[0] in causes else least[key] - ALIKE * (styles[key] in told) for key in fresh}

    def branch(k: int, claimed: Mapping[Any, float], told: float, chosen: tuple[Story, ...]) -> None:
        nonlocal best, picked, visits
        visits += 1
        spent = round(sum(claimed.values()), 6)
        if (spent, told) >= best or visits > VISITS:
            return
        if k == len(terms):
            best, picked = (spent, told), dict(zip(terms, chosen, strict=True))
            return
        more = [(sum(claims.values()), cost(s), claims, s) for s in likely[terms[k]] for claims in [new(s, claimed)]]
        more.sort(key=lambda x: x[:2])
        free = [x for x in more[:1] if not x[2]]  # what claims nothing new is no worse than others
        for _, _, claims, s in free or more:
            branch(k + 1, {**claimed, **claims}, told + cost(s), (*chosen, s))

    branch(0, {}, 0.0, ())
    return picked


def cause_of(h: Hypothesis) -> tuple[Any, ...]:
    """What makes it the same mistake as another."""
    return h.mistake or h.cause


def as_causes(s: Story) -> frozenset[Any]:
    return frozenset(map(cause_of, s))


def lonely(picked: Mapping[str, Story]) -> list[str]:
    """Terms whose cause explains hardly any others."""
    told = Counter(as_causes(s) for s in picked.values())
    return [t for t, s in picked.items() if told[as_causes(s)] <= LONELY and all(h.key != "follows" for h in s)]


def rivals(causes: Sequence[Story], good: Sequence[Collection[Story]]) -> list[Story]:
    """Readings that explain as many terms as one of these, which is told: with a second mistake either may hold."""
    single = [{s[0].cause: s for s in stories if len(s) == 1 and s[0].place in READ} for stories in good]
    found: dict[Any, Story] = {}
    for cause in (s[0].cause for s in causes if len(s) == 1 and s[0].place in READ):
        mine = [stories for stories in single if cause in stories]
        for other in mine[0] if mine else ():
            if all(other in stories for stories in mine):
                found[other] = mine[0][other]
    told = {s[0].cause for s in causes if len(s) == 1}
    return [s for cause, s in found.items() if cause not in told]


def sharing(
    picked: Mapping[str, Story], options: Mapping[str, Sequence[Story]]
) -> list[tuple[str, list[Story]]]:  # fmt: skip
    """Terms, and causes of others that may be theirs too: they explain a term which is told the same as they."""
    known = {t: set(map(as_causes, stories)) for t, stories in options.items()}
    whose: dict[frozenset[Any], list[str]] = {}
    for t, s in picked.items():
        whose.setdefault(as_causes(s), []).append(t)
    found: dict[str, list[Story]] = {}
    for cause, terms in whose.items():
        for other, theirs in whose.items():
            if other != cause and any(other in known[t] for t in terms):
                for t in terms:
                    found.setdefault(t, []).append(picked[theirs[0]])
    return list(found.items())


def grounded(told: dict[str, Explanation]) -> dict[str, Explanation]:
    """Of two terms that would each follow from the other, the first has no cause."""

    def rests_on(term: str, other: str) -> bool:
        return any(other in h.made_of for s in (told[term].stories[:1] if term in told else []) for h in s)

    for term, e in told.items():
        loops = {part for s in e.stories for h in s for part in h.made_of if rests_on(part, term)}
        e.stories = [s for s in e.stories if not any(loops & set(h.made_of) for h in s)]
    return told
