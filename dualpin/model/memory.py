"""What was computed for a robot, kept beside it for as long as it lives.

A robot is data and holds none of this: it is found by the robot's serial number, which no other
robot of the process has, and goes when the robot goes.  Copies and unpickled robots start anew.
"""

from __future__ import annotations

import weakref
from collections.abc import Hashable
from typing import Any

from .robot import Robot

MEMORY: dict[int, dict[Hashable, Any]] = {}
"""Serial number of a robot -> what is kept for it.  Read it through `memory`, which makes what is missing."""


def memory(robot: Robot) -> dict[Hashable, Any]:
    """What is kept for this robot; written with single, atomic dict operations, so no lock is needed."""
    found = MEMORY.get(robot.serial)
    if found is None:
        found = MEMORY.setdefault(robot.serial, {})
        weakref.finalize(robot, MEMORY.pop, robot.serial, None).atexit = False
    return found
