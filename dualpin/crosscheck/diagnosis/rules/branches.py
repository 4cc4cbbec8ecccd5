"""A branch of the tree that hangs on another link: another robot, in all terms at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from ..case import Case
from ..description import Description, Part
from ..hypothesis import Hypothesis
from ..textbook.lists import by_levels
from ..textbook.lumps import listed
from .register import ALL, MOST_ITEMS, proposer

Edges = dict[str, str]
"""Of joints, the links on which they hang."""


def _lists(d: Description) -> dict[str, list[Part]]:
    """The joints in the orders in which codes list them."""
    place = {joint: k for k, joint in enumerate(d.listed)}
    by_link = {link: k for k, link in enumerate(d.links)}
    return {
        "depth first": listed(d), "breadth first": list(by_levels(d).parts),
        "of joints in the file": sorted(d.parts, key=lambda p: place.get(p.joint, 0)),
        "of links in the file": sorted(d.parts, key=lambda p: by_link.get(p.link, 0)),
        "depth first, siblings by name": list(d.parts),
    }  # fmt: skip


def _hung(d: Description, bodies: bool) -> list[tuple[str, str, Edges]]:
    """Where joints hang in words, and as links; of `bodies`, fixed links stay on those that carry them."""
    on = d.carriers() if bodies else {link: link for link in d.carriers()}
    found: list[tuple[str, str, Edges]] = []

    def add(words: str, which: str, order: Sequence[Part], other: Callable[[int], str], begins: bool = True) -> None:
        """`begins` says that a joint hangs elsewhere only where it is not the first one on its link."""
        edges, seen = Edges(), set[str]()
        for k, p in enumerate(order):
            up = on[p.parent]
            if (not begins or up in seen) and other(k) not in (up, p.link):
                edges[p.joint] = other(k)
            seen.add(up)
        if edges and all(edges != known for *_, known in found):
            found.append((words, which, edges))

    for which, parts in _lists(d).items():
        order = [p for p in parts if p.moves or not bodies]
        links, ups = [p.link for p in order], [on[p.parent] for p in order]
        above = dict(zip(links, ups, strict=True))
        before = [d.root, *links]
        beside = [max((i for i in range(k) if ups[i] == ups[k]), default=k) for k in range(len(order))]
        add(f"the one before in the list, {which}", "", order, before.__getitem__, begins=False)
        add(f"the one before in the list, {which}", "where a branch begins", order, before.__getitem__)
        add("the root", which, order, lambda k: d.root)
        add("the first one that is carried", which, order, partial(_first, links))
        add("what the joint before on the same link carries", which, order, partial(_of, links, beside))
        add("its parent's parent", which, order, partial(_above, ups, above))
    return found


def _first(links: Sequence[str], k: int) -> str:
    return links[0]


def _of(links: Sequence[str], which: Sequence[int], k: int) -> str:
    return links[which[k]]


def _above(ups: Sequence[str], above: Edges, k: int) -> str:
    return above.get(ups[k], ups[k])


def _edit(edges: Edges, bodies: bool) -> Callable[[Description, Sequence[str]], Description]:
    """Each joint keeps its placement, on its own link or on the body that carries that."""

    def edit(d: Description, items: Sequence[str]) -> Description:
        there = d.carried()

        def elsewhere(p: Part) -> Part:
            if p.joint not in edges:
                return p
            return replace(p.placed(there[p.parent][1] @ p.pose) if bodies else p, parent=edges[p.joint])

        return d.with_tree([elsewhere(p) for p in d.parts])

    return edit


@proposer("branch", "a branch hangs on another link", "every joint has the parent that the file names")
def branch(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """Other links, of bodies of fixed links and of links as they are."""
    d, found = case.description, list[Hypothesis]()
    if len(d.parts) > MOST_ITEMS:
        return []
    moving, seen = {p.joint for p in d.parts if p.moves}, list[tuple[bool, Edges]]()
    kinds = [(False, True), (False, False), (True, False)] if len(moving) < len(d.parts) else [(False, False)]
    for bodies, fixed in kinds:
        for words, which, every in _hung(d, bodies):
            edges = every if fixed else {joint: link for joint, link in every.items() if joint in moving}
            edit = _edit(edges, bodies)
            if not edges or (bodies, edges) in seen or not _is_tree(edit, d):
                continue
            seen.append((bodies, edges))
            marks = ("of bodies merged from fixed links" * bodies, "of fixed joints too" * fixed, which)
            variant = ", ".join(x for x in marks if x)
            cost = 1.1 + 0.02 * fixed + 0.01 * bodies
            found.append(replace(h, place="edit", act=edit, terms=ALL, values=words, variant=variant, cost=cost))
    return found


def _is_tree(edit: Callable[[Description, Sequence[str]], Description], d: Description) -> bool:
    try:
        edit(d, ())
    except ValueError:
        return False
    return True
