"""The rules, by what they are about.  Importing this package registers them all in `RULES`."""

from . import (  # noqa: F401
    answers,
    base,
    branches,
    composed,
    dynamics,
    exchanged,
    forces,
    formulas,
    frames,
    inputs,
    joints,
    kinematics,
    links,
    listed,
    lumping,
    matrices,
    merging,
    momentum,
    moving,
    numerics,
    origins,
    posed,
    pushes,
    rates,
    screws,
    six_vectors,
    tensors,
    twists,
    units,
    writing,
    zeros,
)
from .register import RULES

SHIPPED = len(RULES)
"""How many there are in the package; others may be added."""
__all__ = ["RULES", "SHIPPED"]
