"""Dual linear algebra, lines and motors, with the names and conventions of ``numpy.linalg``.

Arguments are `dualpin.Dual` arrays or plain ones; leading axes are batch axes.
"""

from ..renamed import renamed_names
from .arguments import AssumptionError, SingularError
from .displacements import (
    compose_screws,
    dual_matrix,
    euler_parameters,
    homogeneous,
    rodrigues,
    screw_matrix,
    screw_of,
    twist_between,
)
from .factor import eig, eigh, eigvals, qr, svd
from .linear import det, inv, lstsq, norm, pinv, pinv_simple, solve
from .lines import Cylindroid, ScrewSum, common_perpendicular, cylindroid, dual_angle, motor_sum, screw_sum
from .markers import MarkerMotion, screw_from_markers
from .motors import LineVector, Motor, classify, line, pitch, reciprocal
from .newton import NewtonResult, newton
from .polynomials import polyroots, polyval

__all__ = [
    "AssumptionError", "Cylindroid", "LineVector", "MarkerMotion", "Motor", "NewtonResult", "ScrewSum",
    "SingularError", "classify", "common_perpendicular", "compose_screws", "cylindroid", "det", "dual_angle",
    "dual_matrix", "eig", "eigh", "eigvals", "euler_parameters", "homogeneous", "inv", "line", "lstsq", "motor_sum",
    "newton", "norm", "pinv", "pinv_simple", "pitch", "polyroots", "polyval", "qr", "reciprocal", "rodrigues",
    "screw_matrix", "screw_of", "screw_from_markers", "screw_sum", "solve", "svd", "twist_between",
]  # fmt: skip

__getattr__ = renamed_names(__name__, Line="LineVector")
