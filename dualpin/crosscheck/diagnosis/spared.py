"""Terms that speak against a hypothesis: it would have changed them, and they are right without it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from .case import Case
from .hypothesis import Hypothesis, Story, identity, ordered
from .scores import scaled
from .stories import numbers_in
from .textbook.slipped import Slipped

POSES = {"fk", "frame_velocity"}
READ = ("word", "edit", "state")
"""Places of mistakes that change what every algorithm starts from."""


def spared(case: Case, h: Hypothesis) -> list[str]:
    """Terms that a hypothesis would have changed, and that are right without it, or with what explains them."""
    if h.of_a_call:
        return []
    if h.identity not in case.spared:
        right = [t for t in h.terms if t in case.observed and case.score(t).right]
        case.spared[h.identity] = [t for t in right if _changes(case, t, h, ())]
    return [*case.spared[h.identity], *_explained(case, h)]


def shows(case: Case, h: Hypothesis) -> bool:
    """Whether poses, and most of what it would change, are wrong without a cause, if it is a mistake in reading."""
    asked, unknown = {t for t in h.terms if t in case.observed}, case.wrong - case.told.keys()
    posed = h.place != "edit" or "fk" in unknown or "fk" not in asked
    return h.place not in READ or (posed and 2 * len(unknown & asked) >= len(asked))


def _explained(case: Case, h: Hypothesis) -> list[str]:
    """What was read wrongly would show in every term, beside the mistakes that explain it; so would a wrong pose.

    Where it explains a term as well as what is told, it may be that mistake itself.
    """
    if h.place not in READ and not in_poses(h):
        return []
    found = []
    for term, stories in case.told.items():
        here = [g for s in stories for g in s]
        if term in h.terms and not any(g.made_of or g.cause == h.cause or g.place == "relation" for g in here):
            key = h.identity, term, identity(stories[0])
            if key not in case.spared:
                beside = _changes(case, term, h, stories[0]) and not case.score(term, (h,)).right
                case.spared[key] = [term] if beside else []
            found += case.spared[key]
    return found


def in_poses(h: Hypothesis) -> bool:
    """Whether it is a slip in poses or velocities of links, which a code makes once for many answers."""
    return isinstance(h.act, Slipped) and "poses" in getattr(h.act.run, "parts", ())


def _changes(case: Case, term: str, h: Hypothesis, story: Story) -> bool:
    x, p = case.predict(term, ordered((*story, h))), case.predict(term, story)
    return x is not None and p is not None and x.shape == p.shape and scaled(x, p) > case.tolerance


def contradicted(case: Case, story: Story) -> bool:
    """By right terms: numbers, slips in right poses, and two causes against which poses or twists speak."""
    if len(story) == 1 and not numbers_in(story[0], story) and not in_poses(story[0]):  # most are not looked at further
        return False
    against = [(h, set(spared(case, h))) for h in story]
    apart = {"frame_velocity"} if "jacobian" in case.wrong else set()  # twists are not made by wrong Jacobians
    posed = [
        (h, terms) for h, terms in against
        if terms & (POSES - (apart if h.place == "formula" and not in_poses(h) else set()))
    ]  # fmt: skip
    one_pass = any(in_poses(h) and "fk" in terms for h, terms in posed)
    return any(terms and numbers_in(h, story) for h, terms in against) or one_pass or len(posed) > 1


def instead(
    case: Case, stories: Iterable[Story], told: Sequence[Sequence[Hypothesis]],
    shown: Callable[[Hypothesis], Iterable[Story]],
) -> list[Story]:  # fmt: skip
    """The stories with another cause in the place of one that terms speak against.

    `told` are the single causes that explain each term: of those of one term, each may stand for another; `shown` is
    how a cause shows in the term of the stories.
    """
    out = []
    for story in stories:
        for h in (h for h in story if spared(case, h)):
            rest = [g for g in story if g is not h]
            alike = [g for some in told if any(g.cause == h.cause for g in some) for g in some if g.cause != h.cause]
            out += [ordered((*rest, *s)) for g in alike for s in shown(g)]
    return out
