"""The robot: joint models, bodies, frames, the tree, and ways to build one."""

from .builder import Builder
from .joints import Axial, Floating, JointModel, Planar, cylindrical, helical, prismatic, revolute
from .robot import Frame, Joint, Limits, Link, Mimic, Robot

__all__ = [
    "Axial", "Builder", "Floating", "Frame", "Joint", "JointModel", "Limits", "Link", "Mimic", "Planar", "Robot",
    "cylindrical", "helical", "prismatic", "revolute",
]  # fmt: skip
