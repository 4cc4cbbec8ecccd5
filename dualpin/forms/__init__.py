"""Other forms of a robot: Denavit-Hartenberg tables and products of exponentials, to and fro."""

from __future__ import annotations

from typing import Any

from ..locking import imported

# module -> names; imported when first used: a table needs neither the screws nor the exports
_HOMES = {
    "build": ("from_dh",),
    "build_screws": ("from_screws",),
    "dh": ("to_dh",),
    "khalil": ("KhalilRow", "KhalilTable"),
    "screw_tree": ("ScrewTree", "to_screws"),
    "screws": ("Screws",),
    "table": ("DHEnd", "DHRow", "DHStep", "DHTable"),
}
_WHERE = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [*sorted(_WHERE)]


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        value = getattr(imported(f"{__name__}.{_WHERE[name]}"), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
