"""Old names that keep working for one version."""

from __future__ import annotations

import warnings
from typing import Any


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
