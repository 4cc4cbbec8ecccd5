"""Words and numbers out of what was typed."""

from __future__ import annotations

from ..errors import ArgumentError


def words(text: str) -> list[str]:
    """Words between commas or blanks."""
    return text.replace(",", " ").split()


def whole(text: str, what: str) -> list[int]:
    """Positive whole numbers out of text."""
    values = real(text, what)
    if any(v < 1 or v != int(v) for v in values):
        raise ArgumentError(f"{what}: whole numbers from 1 expected, got {text!r}")
    return [int(v) for v in values]


def real(text: str, what: str) -> list[float]:
    """Numbers out of text."""
    try:
        values = [float(word) for word in words(text)]
    except ValueError:
        values = []
    if not values:
        raise ArgumentError(f"{what}: numbers between commas expected, got {text!r}")
    return values
