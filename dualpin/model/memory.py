"""Caches of a robot: data that was computed for it, kept as long as the robot exists.

A robot is immutable data and does not hold its caches.  They are found by its serial number, which is unique in the
process, and are deleted with the robot.  Copies and unpickled robots have serial numbers of their own.
"""

from __future__ import annotations

import weakref
from collections.abc import Hashable
from typing import Any

from .robot import Robot

MEMORY: dict[int, dict[Hashable, Any]] = {}
"""Serial number of a robot -> its caches.  Use `memory`, which creates missing ones."""


def memory(robot: Robot) -> dict[Hashable, Any]:
    """The caches of this robot.  They are changed by single, atomic dict operations only, so no lock is needed."""
    found = MEMORY.get(robot.serial)
    if found is None:
        found = MEMORY.setdefault(robot.serial, {})
        weakref.finalize(robot, MEMORY.pop, robot.serial, None).atexit = False
    return found
