"""Integrators: methods as data, one stepping engine over them, on vectors and on groups.

`METHODS` names them all; `solve` integrates any rate, `dualpin.track` and `dualpin.simulate` a
robot's.
"""

from .column import Column
from .methods import CrouchGrossman, Mechanical, Method, PredictorCorrector, Reference, RungeKutta
from .solve import Cost, Solution, solve
from .space import ConfigurationSpace, Space, StateSpace
from .stability import amplification, stability_limit
from .step import step
from .tableaus import METHODS, method_named

__all__ = [
    "METHODS", "Column", "ConfigurationSpace", "Cost", "CrouchGrossman", "Mechanical", "Method", "PredictorCorrector",
    "Reference", "RungeKutta", "Solution", "Space", "StateSpace", "amplification", "method_named", "solve",
    "stability_limit", "step",
]  # fmt: skip
