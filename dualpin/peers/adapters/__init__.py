"""The calls of each peer.  An adapter runs with its library, in the environment that `REQUIRES` describes.

    REQUIRES  what pip installs
    MODULE    what is imported: where it is importable here, no environment is needed
    made(folder) -> mapping with
        version   of the library
        joints    names in the order of its q
        single    term -> f(q, v, a) of one state
        batch     term -> f(Q, V, A) of many, and `how`, what loops over them; else Python does
        gravity   where it has one of its own
        checked   term -> f(q, v, a), where `single` gives something that is not the whole result
        each      term -> (stored, loops): f(Q, V, A) with results, and f(Q, V, A, times) that times a loop of its own

`folder` has robot.urdf and model.npz: gravity, and of each joint kind, parent and numbers, as
pinocchio_loops.cpp takes them.
"""

from pathlib import Path

FOLDER = Path(__file__).parent
NAMES = tuple(sorted(p.stem for p in FOLDER.glob("*.py") if not p.stem.startswith("_")))
