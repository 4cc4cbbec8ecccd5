"""Trajectories, differential and closed-loop inverse kinematics, simulation of forward dynamics."""

from ..renamed import renamed_names
from .ik import IKResult, ik
from .nullspace import away_from_limits, manipulability_gradient
from .reach import Reach, reach
from .simulate import SimulationResult, simulate
from .track import TrackingResult, track
from .trajectories import Callback, Circle, Line, Screw, Trajectory, Waypoints

__all__ = [
    "Callback", "Circle", "IKResult", "Line", "Reach", "Screw", "SimulationResult", "TrackingResult", "Trajectory",
    "Waypoints", "away_from_limits", "ik", "manipulability_gradient", "reach", "simulate", "track",
]  # fmt: skip

__getattr__ = renamed_names(__name__, Solved="IKResult", Tracking="TrackingResult", Motion="SimulationResult")
