"""Speed beside other libraries, each in its fastest form that is at hand and in a process and environment of its own.

    rows = peers.run(["panda"], ["pinocchio", "mujoco"])

`apart.py` runs beside a peer, `adapters/` says how each is called, `process.py` talks to it, `measuring.py`
measures both in turns.
"""

from .adapters import NAMES
from .measuring import run

__all__ = ["NAMES", "run"]
