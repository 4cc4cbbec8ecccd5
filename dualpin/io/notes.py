"""Remarks on a description, gathered by kind: one sentence a kind, with all it concerns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

LISTED = 40  # names in one note; a chain of 20,000 joints has one note, not one of 400 kB


@dataclass
class Notes:
    """Assumptions and oddities of a description: kind -> the elements concerned, in the order of the file."""

    _found: dict[tuple[str, str], list[tuple[str | int, str]]] = field(default_factory=dict)

    def add(self, kind: str, tag: str = "", name: str | int = "", detail: str = "") -> None:
        """Add a note of this kind on an element ("link", "base"), on a line ("line", 3), or on the file."""
        said = self._found.setdefault((kind, tag), [])
        if tag:
            said.append((name, detail))

    def texts(self) -> list[str]:
        """The notes as sentences."""
        return [_sentence(kind, tag, [_said(*x) for x in said]) for (kind, tag), said in self._found.items()]

    def each(self) -> Iterator[tuple[str, str, str | int, str]]:
        """(kind, tag, name, detail) of every element, and of what is said of the whole file."""
        for (kind, tag), said in self._found.items():
            yield from ((kind, tag, name, detail) for name, detail in said or [("", "")])


def _said(name: str | int, detail: str) -> str:
    return f"{name!r} ({detail})" if detail else repr(name)


def _sentence(kind: str, tag: str, said: list[str]) -> str:
    if not tag:
        return kind
    plural = f"{tag}es" if tag.endswith("x") else f"{tag}s"
    more = f", ... ({len(said)} in all)" if len(said) > LISTED else ""
    return f"{kind}: {tag if len(said) == 1 else plural} {', '.join(said[:LISTED])}{more}"
