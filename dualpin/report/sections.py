"""Sections of a page that are not results of runs: a template, and its data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Section:
    """A part of a page under its own heading.

    Attributes
    ----------
    title : str
    template : str
        A file of `templates`.
    view : Any
        What the template shows.
    header : mapping
        Facts before it.
    """

    title: str
    template: str
    view: Any
    header: Mapping[str, Any] = field(default_factory=dict)

    @property
    def entries(self) -> dict[str, Any]:
        """What the page's template is given."""
        return {"template": self.template, "title": self.title, "view": self.view, "header": self.header, "source": ""}
