"""Every error that dualpin raises on purpose.

Each message says what was expected, what was given, where, and the nearest valid choice.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class DualpinError(Exception):
    """Base of all errors raised by dualpin."""


class UrdfError(DualpinError):
    """A robot description that cannot be read, or is not safe to read."""


class FrameNotFoundError(DualpinError, KeyError):
    """A frame, link or joint that the robot does not have."""

    def __str__(self) -> str:  # KeyError would print the repr
        return str(self.args[0]) if self.args else ""


class ShapeError(DualpinError, ValueError):
    """An array of the wrong shape."""


class ArgumentError(DualpinError, ValueError):
    """An argument whose value or type is not accepted."""


class ArgumentTypeError(ArgumentError, TypeError):
    """An argument of a type that has no meaning there."""


class DualDivisionError(DualpinError, ZeroDivisionError):
    """A dual number without the requested inverse, root or derivative."""


class DeviceError(DualpinError):
    """There is no usable GPU, or an operation on it failed."""


class DualpinWarning(UserWarning):
    """Something was assumed, ignored or looks wrong; the computation continues."""


def nearest(wanted: str, choices: Iterable[str], what: str = "choices", most: int = 12) -> str:
    """The end of an error message: the closest names, then the list of all (cut when long)."""
    names = list(dict.fromkeys(map(str, choices)))
    close = get_close_matches(str(wanted), names, n=1, cutoff=0.5)
    close = close or [n for n in names if str(wanted).lower() in n.lower()][:1]
    hint = f"did you mean {close[0]!r}? " if close else ""
    more = f", ... ({len(names)} in all)" if len(names) > most else ""
    return f"{hint}{what}: {', '.join(names[:most])}{more}"
