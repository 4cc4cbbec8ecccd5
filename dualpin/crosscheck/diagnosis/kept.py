"""Slips that algorithms have on a robot, kept between runs: to find them takes up to a third of a diagnosis.

They depend on the robot, on what is asked of it, and on the sources.  There is one file for each term.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Callable, Hashable, Sequence

from ...engine.jit import cache
from ...machine import sources
from .textbook.steps import Slip

ROOM = "slips"
Found = dict[int, Sequence[Slip]]
"""By the numbers of their rules."""


class Kept:
    """The slips of one robot."""

    def __init__(self, robot: Hashable) -> None:
        self._robot = hashlib.sha256(repr(robot).encode()).hexdigest()
        self._terms: dict[str, Found] = {}
        self._new: set[str] = set()

    def of(self, rule: int, term: str, find: Callable[[], Sequence[Slip]]) -> Sequence[Slip]:
        """Those of a rule for a term; they are found where they are not known."""
        if term not in self._terms:
            found = cache.load(self._key(term), ROOM)
            self._terms[term] = {} if found is None else _unpacked(found[1])
        known = self._terms[term]
        if rule not in known:
            known[rule] = find()
            self._new.add(term)
        return known[rule]

    def save(self, shipped: int) -> None:
        """Write the files of the terms of which more is known now; the sources of rules behind `shipped` are not."""
        new, self._new = self._new, set()  # another thread may go on with the same robot
        for term in new:
            found = {rule: slips for rule, slips in list(self._terms[term].items()) if rule < shipped}
            cache.store(self._key(term), {}, _packed(found), ROOM)

    def _key(self, term: str) -> str:
        return f"{self._robot}|{term}|{sources()}"


def _packed(found: Found) -> bytes:
    """Each word once, and each slip once: most rules of a term have the same ones."""
    words: dict[str, int] = {}
    slips: dict[Slip, int] = {}
    rules = {rule: [slips.setdefault(s, len(slips)) for s in some] for rule, some in found.items()}
    three = [[words.setdefault(w, len(words)) for w in s] for s in slips]
    return zlib.compress(json.dumps([list(words), three, rules]).encode(), 1)


def _unpacked(content: bytes) -> Found:
    words, three, rules = json.loads(zlib.decompress(content))
    slips = [Slip(words[a], words[b], words[c]) for a, b, c in three]
    return {int(rule): [slips[k] for k in some] for rule, some in rules.items()}
