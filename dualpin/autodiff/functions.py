"""The functions that `dualpin.torch` and `dualpin.jax` offer: those of `dualpin`, on arrays of the library.

Each takes the robot first, then arrays whose leading axes broadcast, and gives an array that the
library can differentiate.
"""

from __future__ import annotations

from ..errors import ShapeError, nearest
from ..terms import TERMS
from .dynamics import Dynamics
from .kinematics import Kinematics
from .operation import Operation


class Functions(Dynamics, Kinematics):
    """The differentiable terms."""


def absent(module: str, name: str) -> AttributeError:
    """What to say of a name that the module does not have."""
    hint = {
        "centroidal_momentum_matrix": "; the momentum is robot.mass times the velocity of com",
    }.get(name, "")
    why = "has no derivative here" if name in TERMS else "is not known"
    return AttributeError(f"{module}.{name} {why}{hint}; {nearest(name, NAMES, 'functions', most=99)}", name=name)


NAMES = tuple(name for part in Functions.__bases__ for name in vars(part) if not name.startswith("_"))


def leading(operation: Operation, shapes: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """The leading axes of each array, after a check that there are as many axes as a sample has."""
    found = []
    for x, rank, shape in zip(operation.term.arguments, operation.ranks, shapes, strict=True):
        wanted = x.shape(operation.robot)
        if shape[len(shape) - rank :] != wanted or len(shape) < rank:
            axes = ", ".join(map(str, wanted))
            raise ShapeError(
                f"{operation.term.name}: {x.name} of shape (..., {axes}) expected for {operation.robot.name} "
                f"({x.meaning(operation.robot)}), got {tuple(shape)}"
            )
        found.append(tuple(shape[: len(shape) - rank]))
    return found
