"""The public functions: arrays in, arrays out.

Shapes: q (..., nq), v, a, tau (..., nv); leading axes are batch axes and broadcast.
Units: SI, radians.  World z up.  Six-vectors are angular first: twists [w; v], wrenches [n; f].
Every function takes ``engine=``: "auto", "compiled", "tiered" (NumPy until a thread has compiled the term), "numpy"
(the source uncompiled) or "cuda"; and ``dtype=``, float64 or float32.  Functions that return one array take ``out=``,
an array of that type and of the result's shape.
"""

from .configurations import difference, integrate
from .derivatives import aba_derivatives, rnea_derivatives, rnea_jvp, rnea_vjp
from .dynamics import aba, bias, gravity, joint_wrenches, rnea
from .kinematics import fk, frame_acceleration, frame_velocity, jacobian, jacobian_dot
from .matrices import coriolis, crba, minv
from .momentum import (
    centroidal_momentum_matrix,
    com,
    com_jacobian,
    kinetic_energy,
    potential_energy,
)
from .parameters import LinkTerm, LinkTerms, inertial_parameters, joint_torque_regressor, link_terms
from .second import rnea_hessian, rnea_hvp, rnea_second_derivatives

__all__ = [
    "LinkTerm", "LinkTerms", "aba", "aba_derivatives", "bias", "centroidal_momentum_matrix", "com", "com_jacobian",
    "coriolis", "crba", "difference", "fk", "frame_acceleration", "frame_velocity", "gravity",
    "inertial_parameters", "integrate", "jacobian", "jacobian_dot", "joint_torque_regressor", "joint_wrenches",
    "kinetic_energy", "link_terms", "minv", "potential_energy", "rnea", "rnea_derivatives", "rnea_hessian",
    "rnea_hvp", "rnea_jvp", "rnea_second_derivatives", "rnea_vjp",
]  # fmt: skip
