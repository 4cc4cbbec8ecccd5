"""A document while it is read: the checked <robot> element, and helpers for reading its elements."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple, NoReturn

from lxml import etree

from ..errors import UrdfError
from .notes import Notes

VERSIONS = ("1.0", "1.1", "1.2")
_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_INFINITE = re.compile(r"[+-]?inf(inity)?", re.ASCII | re.IGNORECASE)
_BLANKS = re.compile(r"[ \t\r\n]+")  # of XML; others are part of a word


class Owner(NamedTuple):
    """The link or joint that is being read, as messages name it."""

    tag: str
    name: str
    part: str = ""

    def __str__(self) -> str:
        return f"{self.tag} {self.name!r}{self.part}"


@dataclass
class Document:
    """A checked <robot> element, its links and joints by name, and notes on it."""

    root: etree._Element
    source: str
    notes: Notes = field(default_factory=Notes)
    links: dict[str, etree._Element] = field(default_factory=dict)
    joints: dict[str, etree._Element] = field(default_factory=dict)
    base: str = ""
    """The root link."""
    reductions: dict[str, float] = field(default_factory=dict)
    """Joint -> ratio of its transmission."""
    whole: etree._Element | None = None
    """The root element with everything that is not mechanics too, meshes for instance."""
    mended: bool = False
    """Whether the text had faults of markup, so that its elements are not those of the file."""

    @property
    def stem(self) -> str:
        """The name of the file, for elements without a name."""
        return "robot" if self.source.startswith("<") else Path(self.source).stem or "robot"

    def fail(self, element: etree._Element | None, message: str) -> NoReturn:
        line = f":{element.sourceline}" if element is not None and element.sourceline else ""
        raise UrdfError(f"{self.source}{line}: {message}")

    # reading one element

    def note(self, kind: str, owner: Owner, detail: str = "") -> None:
        """Add a note of this kind about a link or a joint."""
        self.notes.add(kind, owner.tag, owner.name, detail)

    def one(self, parent: etree._Element, tag: str, owner: Owner) -> etree._Element | None:
        """The only child of that tag, or None; of several the first, and the others are removed."""
        found = parent.findall(tag)
        if len(found) > 1:
            self.note("several elements of one kind, the first is used", owner, f"{len(found)} <{tag}>")
            for other in found[1:]:
                parent.remove(other)
        return found[0] if found else None

    def numbers(
        self, e: etree._Element, attribute: str, count: int, owner: Owner, default: str | None = None,
        *, unbounded: bool = False,
    ) -> list[float]:  # fmt: skip
        """`count` finite decimal numbers of an attribute; where `unbounded`, also infinite ones."""
        text = e.get(attribute, default)
        shown = f"{owner}: <{e.tag} {attribute}>"
        if text is None:
            self.fail(e, f"{owner}: <{e.tag}> without the attribute {attribute!r}; {_counted(count)} expected")
        words = [word for word in _BLANKS.split(text) if word]
        if len(words) != count:
            self.fail(e, f"{shown} is {short(text)}; {_counted(count)} expected, got {len(words)}")
        values = []
        for word in words:
            number = _NUMBER.fullmatch(word) or (unbounded and _INFINITE.fullmatch(word))
            if not number or not (unbounded or math.isfinite(float(word))):
                self.fail(e, f"{shown} is {short(text)}; {short(word)} is not a finite decimal number")
            values.append(float(word))
        if attribute in e.attrib:  # later readers find the numbers that were checked
            e.set(attribute, " ".join(map(repr, values)))
        return values

    def number(
        self, e: etree._Element, attribute: str, owner: Owner, default: str | None = None, *, unbounded: bool = False
    ) -> float:
        return self.numbers(e, attribute, 1, owner, default, unbounded=unbounded)[0]


def depth_first(children: Mapping[str, Iterable[tuple[str, str]]], base: str) -> Iterator[str]:
    """The joints of a tree, link -> (joint, child link): siblings by name as bytes, as in urdfdom's map."""
    stack = [("", base)]
    while stack:
        joint, link = stack.pop()
        if joint:
            yield joint
        stack += sorted(children.get(link, ()), key=lambda x: x[0].encode(), reverse=True)


def unused(name: str, taken: set[str]) -> str:
    """The name, lengthened until it is not taken; it is from now on."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _counted(n: int) -> str:
    return "a number" if n == 1 else f"{n} numbers"


def short(text: str) -> str:
    """The text between quotes, cut where it is long."""
    return repr(text if len(text) <= 60 else text[:57] + "...")
