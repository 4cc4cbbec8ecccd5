"""Trajectories, differential and closed-loop inverse kinematics, simulation of forward dynamics."""

from .ik import Solved, ik
from .nullspace import away_from_limits, manipulability_gradient
from .reach import Reach, reach
from .simulate import Motion, simulate
from .track import Tracking, track
from .trajectories import Callback, Circle, Line, Screw, Trajectory, Waypoints

__all__ = [
    "Callback", "Circle", "Line", "Motion", "Reach", "Screw", "Solved", "Tracking", "Trajectory", "Waypoints",
    "away_from_limits", "ik", "manipulability_gradient", "reach", "simulate", "track",
]  # fmt: skip
