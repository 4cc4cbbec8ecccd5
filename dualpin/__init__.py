"""dualpin: robot kinematics and dynamics written once, in dual numbers, and checked against Pinocchio.

Conventions: SI units and radians; world z up, gravity (0, 0, -9.81); quaternions Hamilton, scalar
first; six-vectors angular first, twists [w; v] and wrenches [n; f]; joint order Pinocchio's.
"""

from __future__ import annotations

from typing import Any

from . import locking as locking  # registers the fork handlers

__version__ = "0.2.0"

# name -> module; imported when first used, so that `import dualpin` stays quick
_HOMES = {
    "dualpin.analysis.check": ("check",),
    "dualpin.analysis.convert": ("convert",),
    "dualpin.analysis.diff": ("diff",),
    "dualpin.analysis.identification": ("base_parameters", "excite", "identify", "identify_payload"),
    "dualpin.analysis.workspace": ("manipulability", "payload_capacity", "reach_map", "singularity"),
    "dualpin.dual": ("Dual",),
    "dualpin.engine.jit.threads": ("get_num_threads", "set_num_threads"),
    "dualpin.errors": (
        "ArgumentError", "DeviceError", "DualDivisionError", "DualpinError", "DualpinWarning", "FrameNotFoundError",
        "ShapeError", "UrdfError",
    ),
    "dualpin.export": ("export_c", "symbolic"),
    "dualpin.forms": ("from_dh", "from_screws", "to_dh", "to_screws"),
    "dualpin.functions": (
        "aba", "aba_derivatives", "bias", "centroidal_momentum_matrix", "com", "com_jacobian", "coriolis", "crba",
        "difference", "fk",
        "frame_acceleration", "frame_velocity", "gravity", "inertial_parameters", "integrate", "jacobian",
        "jacobian_dot", "joint_torque_regressor", "joint_wrenches", "kinetic_energy", "link_terms", "minv",
        "potential_energy", "rnea", "rnea_derivatives", "rnea_hessian", "rnea_hvp", "rnea_jvp",
        "rnea_second_derivatives", "rnea_vjp",
    ),
    "dualpin.io": ("load", "loads"),
    "dualpin.model": ("Builder", "Robot"),
    "dualpin.crosscheck": ("judge", "validate"),
    "dualpin.crosscheck.subjects": ("Convention",),
    "dualpin.tracking": (
        "Circle", "IKResult", "Line", "Screw", "SimulationResult", "TrackingResult", "Waypoints", "ik", "simulate",
        "track",
    ),
}  # fmt: skip
_PACKAGES = ("algebra", "algorithms", "analysis", "crosscheck", "engine", "forms", "integrators", "io", "jax",
             "mechanisms", "memory", "model", "report", "spatial", "torch", "tracking", "view")  # fmt: skip
_WHERE = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [*sorted(_WHERE), "__version__"]


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        value = getattr(locking.imported(_WHERE[name]), name)
        globals()[name] = value
        return value
    if name in _PACKAGES:
        return locking.imported(f"dualpin.{name}")
    raise AttributeError(f"module 'dualpin' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, *_PACKAGES]
