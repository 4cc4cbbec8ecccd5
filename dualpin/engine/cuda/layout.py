"""Where the arrays of a kernel are for a thread: in global memory, or for a while in shared memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

WARP = 32


@dataclass(frozen=True)
class Layout:
    """The inputs in their order, then the output.

    Rows in shared memory have an odd number of places, so that 32 threads that read the same column
    meet 32 different banks.

    Attributes
    ----------
    offsets : tuple of int or None
        Where a warp's rows of an array begin in its shared memory; None: the array stays where it is.
    room : int
        How many numbers a warp keeps in shared memory.
    strided : bool
        Whether columns may lie any distance apart.  Otherwise each row is without gaps.
    """

    sizes: tuple[int, ...]
    offsets: tuple[int | None, ...]
    room: int
    strided: bool


def strided(sizes: Sequence[int]) -> Layout:
    """Everything stays where it is, whatever its strides."""
    return Layout(tuple(sizes), (None,) * len(sizes), 0, True)


def staged(sizes: Sequence[int], most: int) -> Layout:
    """As many arrays in shared memory as fit in so many numbers a thread.

    Results first: written by each thread alone they would leave in parts of lines.
    """
    offsets: list[int | None] = [None] * len(sizes)
    room = 0
    for k in (len(sizes) - 1, *range(len(sizes) - 1)):
        if sizes[k] > 0 and room + row(sizes[k]) <= most:
            offsets[k], room = room * WARP, room + row(sizes[k])
    return Layout(tuple(sizes), tuple(offsets), room * WARP, False)


def row(size: int) -> int:
    """Places of a row in shared memory."""
    return size | 1
