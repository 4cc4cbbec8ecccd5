"""What cases of one robot have in common, kept between them: the slips that are possible, and what these predict.

Several subjects are often judged on one robot at the same states, or one subject again after a repair.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

import numpy as np

from .kept import Kept

T = TypeVar("T")
ROBOTS = 2
"""How many are kept: those of which a case was made last."""
BYTES = 2**26
"""Of the predictions of one robot; where they become more, they are made anew."""


class Shared:
    """What is kept of one robot."""

    def __init__(self, robot: Hashable) -> None:
        self.slips = Kept(robot)
        self._made: dict[Hashable, Any] = {}
        self._predictions: dict[Hashable, np.ndarray | None] = {}
        self._bytes = 0

    def once(self, what: Hashable, make: Callable[[], T]) -> T:
        """What depends on the robot alone; threads that need it at once make it each."""
        if what not in self._made:
            self._made[what] = make()
        found: T = self._made[what]
        return found

    def prediction(self, what: Hashable) -> tuple[np.ndarray | None] | None:
        """A prediction, not to be written to; None where it is not known."""
        try:
            return (self._predictions[what],)
        except KeyError:
            return None

    def predicted(self, what: Hashable, x: np.ndarray | None) -> None:
        if x is not None:
            x.flags.writeable = False
            self._bytes += x.nbytes
            if self._bytes > BYTES:
                self._predictions.clear()
                self._bytes = x.nbytes
        self._predictions[what] = x


_ROBOTS: OrderedDict[Hashable, Shared] = OrderedDict()
_LOCK = threading.Lock()


def shared(robot: Hashable) -> Shared:
    """What is kept of a robot, by all that its description is made of."""
    with _LOCK:
        found = _ROBOTS.setdefault(robot, Shared(robot))
        _ROBOTS.move_to_end(robot)
        while len(_ROBOTS) > ROBOTS:
            _ROBOTS.popitem(last=False)
    return found
