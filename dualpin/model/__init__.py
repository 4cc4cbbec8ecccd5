"""The robot: joint models, bodies, frames, the tree, and ways to build one."""

from .builder import Builder
from .joints import Axial, Floating, JointModel, Planar, Spherical, cylindrical, helical, prismatic, revolute, spherical
from .robot import Frame, Joint, Limits, Link, Mimic, Robot, Rotor

__all__ = [
    "Axial", "Builder", "Floating", "Frame", "Joint", "JointModel", "Limits", "Link", "Mimic", "Planar", "Robot",
    "Rotor", "Spherical", "cylindrical", "helical", "prismatic", "revolute", "spherical",
]  # fmt: skip
