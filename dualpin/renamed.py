"""Old names that keep working for one version."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from .locking import imported


class Renamed:
    """An attribute under its former name: the same value, and a DeprecationWarning.

    Examples
    --------
    >>> class Row:
    ...     letter = "R"
    ...     kind = Renamed("letter")
    """

    def __init__(self, new: str) -> None:
        self.new = new

    def __set_name__(self, owner: type, name: str) -> None:
        self.old = name

    def __get__(self, owned: Any, owner: type) -> Any:
        if owned is None:
            return self
        warnings.warn(f"{owner.__name__}.{self.old} is called .{self.new} now", DeprecationWarning, stacklevel=2)
        return getattr(owned, self.new)


def renamed_names(module: str, **names: str) -> Callable[[str], Any]:
    """The ``__getattr__`` of a module for renamed names, old=new, with a DeprecationWarning."""

    def getattr_(name: str) -> Any:
        if name not in names:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        new = names[name]
        warnings.warn(f"{module}.{name} is now {module}.{new}", DeprecationWarning, stacklevel=2)
        return getattr(imported(module), new)

    return getattr_
