"""Many robots at once: cut into units of work, given to any executor, kept in a store, put together again.

    cases -> units -> executor -> store -> merge -> Report

A unit is a robot, a slice of its samples and an engine, with a seed of its own.  Its result depends on
nothing else, so one process and a thousand write the same report.
"""

from .cases import all_cases
from .executors import LostError
from .run import campaign
from .store import Progress, Store

__all__ = ["LostError", "Progress", "Store", "all_cases", "campaign"]
