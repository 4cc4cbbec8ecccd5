"""Why a subject does not read a file: the file is repaired, a construct at a time, until it does.

All constructs together first.  If that is enough, those that are needed are found by halving; then each alone is
tried, since several may be enough.  If all together do not help (an edit may harm), single constructs and pairs
are tried.  Each attempt is a process of its own in which the subject is made, and asked nothing.
"""

from __future__ import annotations

import itertools
import re
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from lxml import etree

from ...errors import DualpinError
from ..findings import Finding
from ..subjects.answers import Answers
from ..subjects.asking import Asking
from .constructs import CONSTRUCTS, Construct

ATTEMPTS = 25
SECONDS = 60.0
UNRELATED = re.compile(
    r"\b(NotImplementedError|ModuleNotFoundError|ImportError|SyntaxError|IndentationError)\b|no answer within"
)
"""Messages whose cause is not the file."""
Refusal = Callable[[Asking, float], str]
"""Why a subject does not read this robot, known within so many seconds; empty if it does."""
SAYS = "the subject does not read the file: what it holds that keeps it from reading"
FIX = "write the file otherwise, as is said there; or teach the subject to read it"


@dataclass
class Repair:
    """What was found: the finding if there is one, and a remark on the search."""

    finding: Finding | None = None
    remark: str = ""


@dataclass
class _Search:
    asking: Asking
    refusal: Refusal
    tick: Callable[[str], None]
    start: float = field(default_factory=time.perf_counter)
    tried: int = 0
    open: bool = False
    """Whether more is needed than what was found before time was over."""

    @property
    def left(self) -> float:
        return SECONDS - (time.perf_counter() - self.start)

    @property
    def over(self) -> bool:
        return self.tried >= ATTEMPTS or self.left <= 0

    def applied(self, constructs: Sequence[Construct]) -> tuple[str, dict[str, list[str]]]:
        """The text with these constructs written otherwise, and what each changed."""
        root = etree.fromstring(self.asking.text.encode())
        changed = {c.says: c.edit(root) for c in constructs}
        return str(etree.tostring(root, encoding="unicode")), changed

    def reads(self, constructs: Sequence[Construct]) -> bool:
        """Whether the subject reads the file without these constructs; no, where no time is left to try."""
        if self.over:
            return False
        what = " and ".join(c.says for c in constructs) if len(constructs) < 3 else f"{len(constructs)} constructs"
        self.tick(f"it does not read the file: tried without {what or 'any change'} ({self.tried + 1} of {ATTEMPTS})")
        try:
            asking = self.asking.of_text(self.applied(constructs)[0])
        except DualpinError:
            return False  # dualpin itself does not read that: the edit does not suit this robot
        self.tried += 1
        return not self.refusal(asking, max(1.0, self.left))

    def causes(self) -> Iterator[tuple[Construct, ...]]:
        """What, written otherwise, makes the file readable: single constructs, else one set that is needed."""
        there = [c for c in CONSTRUCTS if self.applied([c])[1][c.says]]
        together = self.needed(there) if self.reads(there) else []
        single = [c for c in there if together == [c] or (len(there) > 1 and self.reads([c]))]
        if single:
            self.open = False
            yield from ((c,) for c in single)
        elif together:
            yield tuple(together)
        else:
            yield from itertools.islice((p for p in itertools.combinations(there, 2) if self.reads(p)), 1)

    def needed(self, enough: list[Construct]) -> list[Construct]:
        """Of constructs that are enough together, those that are needed, each found by halving.

        The last of the fewest that are enough is needed: it is kept, and the search goes on before it.
        """
        found: list[Construct] = []
        while not (found and self.reads(found)):
            least, most = 0, len(enough)
            while most - least > 1 and not self.over:
                middle = (least + most) // 2
                if self.reads([*enough[:middle], *found]):
                    most = middle
                else:
                    least = middle
            if most - least > 1 or self.over:
                self.open = True
                break
            found.insert(0, enough[most - 1])
            enough = enough[: most - 1]
            if not enough:
                break
        return found


def repaired(answers: Answers, asking: Asking, refusal: Refusal, tick: Callable[[str], None]) -> Repair:
    """What keeps a subject that refuses a robot from reading its file, if the file is the reason."""
    if not answers.refused or UNRELATED.search(answers.refused):
        return Repair()
    search = _Search(asking, refusal, tick)
    if search.reads([]):
        return Repair(remark="asked again, and nothing but its name, it reads the file")
    causes = list(search.causes())
    seconds = f"{search.tried} files tried in {time.perf_counter() - search.start:.1f} s"
    if not causes:
        return Repair(remark=f"refusal: no construct of the file explains it; {seconds}")
    first, *rest = (_Cause.of(search, c) for c in causes)
    more = ", nor something else that was not found" if search.open else ""
    finding = Finding(
        "refusal",
        f"it does not read {first.says}{more}: it says {answers.refused!r}",
        items=first.items,
        alternatives=[f"it does not read {c.says}" for c in rest],
        fix=first.fix,
        subject=answers.name,
    )
    return Repair(finding, f"refusal: {seconds}")


@dataclass(frozen=True)
class _Cause:
    """Constructs that together keep a file from being read, where they are and how to write them otherwise."""

    says: str
    items: list[str]
    fix: str

    @classmethod
    def of(cls, search: _Search, constructs: Sequence[Construct]) -> _Cause:
        where = {c.says: search.applied([c])[1][c.says] for c in constructs}
        says = ", nor ".join(f"{what} ({_listed(names)})" for what, names in where.items())
        items = list(dict.fromkeys(itertools.chain(*where.values())))
        return cls(says, items, "; and ".join(c.fix for c in constructs))


def _listed(names: Sequence[str], most: int = 6) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
