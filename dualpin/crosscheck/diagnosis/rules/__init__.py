"""The rules, by what they are about.  Importing this package registers them all in `RULES`."""

from . import answers, forces, formulas, joints, links, matrices, merging, numerics, pushes, units, writing  # noqa: F401
from .register import RULES

__all__ = ["RULES"]
