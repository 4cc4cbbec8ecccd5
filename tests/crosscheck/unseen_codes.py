"""Codes of other people's kinds, each with mistakes: a change of one place (or two) of the source text, or a switch.

The codes are in `unseen/`, with `mistakes.jsonl`: the name, the code, what is replaced by what, and what was decided
before any of them was run: the keys that name it rightly, words that do where the key is another one, and the mistake
itself in words.  None of the hypotheses was known to their author, nor were they to the authors of hypotheses.

Those of the world-frame code, of another author, are switched on by their names; what would name them was fixed in
sentences (`counts`), and the verdicts were read.  Half of them were asked before anything was told of them, the other
half after the kinds that the first half missed had been told; `+` joins two that are made together.

So were those of three more codes, of two more authors: `newton`, and `controller` with `sixvectors`.

Those of `composites`, `exponentials` and `jacobians`, of two more authors, stand in `sentences.jsonl`, each with the
sentence that was fixed for it; which of them were asked at one time is their group.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent / "unseen"
BESIDES = {"follows", "same_cv", "same_product"}
"""What may be said besides: neither is a cause."""


@dataclass(frozen=True)
class Mistake:
    """One; `keys` or `words` name it; some show on a floating base only."""

    code: str
    changes: tuple[tuple[str, str], ...]
    keys: frozenset[str]
    words: str
    says: str
    floating: bool
    added: str = ""
    """Words of keys that came later, or of sentences, found to say the mistake when they were read."""
    counts: tuple[str, ...] = ()
    """Other sentences that would name it, fixed before it was asked."""
    group: str = ""
    """Of those asked at one time, where a code's were not all asked at once."""

    def named_by(self, key: str, says: str) -> bool:
        words = (w for w in (self.words, self.added) if w)
        return key in self.keys or any(re.search(w, says, re.IGNORECASE) for w in words)


def _read(file: str) -> dict[str, Mistake]:
    found = {}
    for line in (HERE / file).read_text().splitlines():
        m = json.loads(line)
        changes = tuple((old, new) for old, new in m["changes"])
        found[m["name"]] = Mistake(
            m["code"], changes, frozenset(m["keys"].split()), m["words"], m["says"], m["floating"], m.get("added", ""),
            tuple(m.get("counts", ())), m.get("group", ""),
        )  # fmt: skip
    return found


MISTAKES = _read("mistakes.jsonl")
SENTENCES = _read("sentences.jsonl")
"""Mistakes of which one sentence each says what names them: the answers are read."""
CODES = (
    "matlab", "spatial", "lagrange", "simulator", "quat", "legged", "worldframe", "newton", "controller", "sixvectors",
    "composites", "exponentials", "jacobians",
)  # fmt: skip
SWITCHED = {"worldframe"}
"""Codes whose mistakes are switches."""
READ = {"newton", "controller", "sixvectors"}
"""Codes whose verdicts were all read, by the authors of the mistakes."""
FLOATING, CAN_FLOAT = {"legged"}, {"legged", "spatial", "worldframe", "newton", "sixvectors", "jacobians"}
"""Codes whose base floats always, and those whose base can."""


@cache
def source(code: str) -> str:
    """The text of a code with that of the modules that it shares."""
    text = (HERE / f"{code}.py").read_text()
    return re.sub(r"from tests.*\.(\w+) import.*\n", lambda m: (HERE / f"{m[1]}.py").read_text(), text)


def written(code: str, *names: str) -> Any:
    """The class of a code with these mistakes."""
    if code in SWITCHED:
        right = import_module(f"tests.crosscheck.unseen.{code}").Code
        return type("Code", (right,), {"mistakes": frozenset(names)})
    known = MISTAKES | SENTENCES
    return rewritten(code, *(c for n in names for c in known[n].changes))


def changed(code: str, *changes: tuple[str, str]) -> str:
    """The text of a code with these changes, each of one place."""
    text = source(code)
    for old, new in changes:
        if text.count(old) != 1:
            raise ValueError(f"{code} holds {text.count(old)} times {old!r}")
        text = text.replace(old, new)
    return text


def rewritten(code: str, *changes: tuple[str, str]) -> Any:
    """The class of a code whose text has these changes."""
    text = changed(code, *changes)
    space: dict[str, Any] = {"__name__": __name__}  # dataclasses look for their module
    exec(compile(text, code, "exec"), space)
    return space["Code"]
