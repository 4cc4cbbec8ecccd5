"""Speed of other libraries (peers), each in its fastest available form, in a process and environment of its own.

    rows = peers.run(["panda"], ["pinocchio", "mujoco"])

`apart.py` runs in the peer's process, `adapters/` contains the calls of each peer, `process.py` communicates with it,
`measuring.py` measures both alternately.
"""

from .adapters import NAMES
from .measuring import run

__all__ = ["NAMES", "run"]
