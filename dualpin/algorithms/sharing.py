"""Intermediate results that several terms have in common, computed once.

Poses and twists of a chain of joints are the same for every frame and every reference.  Within `sharing`, a function
marked `shared` returns what it returned for the same objects before; nobody changes what it returns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

_KNOWN: ContextVar[dict[tuple[Any, ...], tuple[Any, Any]] | None] = ContextVar("shared", default=None)


@contextmanager
def sharing() -> Iterator[None]:
    """Within this, in this thread, shared results are kept."""
    token = _KNOWN.set({})
    try:
        yield
    finally:
        _KNOWN.reset(token)


def shared(f: Callable[P, T]) -> Callable[P, T]:
    """Computed once for the same objects: for the same lists, or lists of the same objects."""

    @wraps(f)
    def once(*args: P.args, **options: P.kwargs) -> T:
        known = _KNOWN.get()
        if known is None or options:
            return f(*args, **options)
        key = (f, *(tuple(map(id, x)) if type(x) is list else id(x) for x in args))
        if key not in known:
            # with copies of the lists: as long as their objects exist, no other has the same id
            known[key] = f(*args, **options), [list(x) if type(x) is list else x for x in args]
        result: T = known[key][0]
        return result

    return once
