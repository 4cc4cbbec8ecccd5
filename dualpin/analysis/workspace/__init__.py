"""Where a robot's frame can be, how well it moves there, what it can carry there, and where it cannot move."""

from .loads import payload_capacity, static_load
from .manipulability import Manipulability, characteristic_length, manipulability
from .reach import ReachMap, reach_map
from .singularity import Singularity, singularity

__all__ = [
    "Manipulability", "ReachMap", "Singularity", "characteristic_length", "manipulability", "payload_capacity",
    "reach_map", "singularity", "static_load",
]  # fmt: skip
