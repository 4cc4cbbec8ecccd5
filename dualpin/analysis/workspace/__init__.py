"""Reachability, manipulability, static loads and singularities of a frame."""

from .ellipsoids import Manipulability, characteristic_length, manipulability
from .loads import payload_capacity, static_load
from .reach import ReachMap, reach_map
from .singular import Singularity, nearest_singularity, singularity

__all__ = [
    "Manipulability", "ReachMap", "Singularity", "characteristic_length", "manipulability", "nearest_singularity",
    "payload_capacity",
    "reach_map", "singularity", "static_load",
]  # fmt: skip
