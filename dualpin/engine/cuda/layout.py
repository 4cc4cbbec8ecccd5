"""Which arrays of a kernel are staged in shared memory, and which stay in global memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

WARP = 32


@dataclass(frozen=True)
class Layout:
    """The inputs in their order, then the output.

    Rows in shared memory have an odd length, so that 32 threads that read the same column access 32
    different banks.

    Attributes
    ----------
    offsets : tuple of int or None
        Offset of a warp's rows of each array in shared memory; None: the array stays in global memory.
    room : int
        Numbers of a warp in shared memory.
    strided : bool
        Whether columns may have any stride.  Otherwise each row is contiguous.
    """

    sizes: tuple[int, ...]
    offsets: tuple[int | None, ...]
    room: int
    strided: bool


def strided(sizes: Sequence[int]) -> Layout:
    """All arrays stay in global memory, with any strides."""
    return Layout(tuple(sizes), (None,) * len(sizes), 0, True)


def staged(sizes: Sequence[int], most: int) -> Layout:
    """As many arrays in shared memory as fit into this many numbers for each thread.

    Results come first, since uncoalesced stores write parts of lines.
    """
    offsets: list[int | None] = [None] * len(sizes)
    room = 0
    for k in (len(sizes) - 1, *range(len(sizes) - 1)):
        if sizes[k] > 0 and room + row(sizes[k]) <= most:
            offsets[k], room = room * WARP, room + row(sizes[k])
    return Layout(tuple(sizes), tuple(offsets), room * WARP, False)


def row(size: int) -> int:
    """Length of a row in shared memory."""
    return size | 1
