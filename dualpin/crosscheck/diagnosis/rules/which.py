"""Which slips of a formulation are hypotheses, where a variant of it has the others too."""

from __future__ import annotations

from ..textbook.columns import HERE
from ..textbook.columns import MOVING as MOVING_AXES
from ..textbook.gradient import TURNING
from ..textbook.in_place import GROWING, KEPT
from ..textbook.lumps import CARRIED as IN_CARRIER
from ..textbook.lumps import READ, TURNED
from ..textbook.products import SKEW
from ..textbook.steps import Slip
from ..textbook.velocities import SPINS
from ..textbook.walks import ALL


def every(slip: Slip) -> bool:
    return True


def both_ways(slip: Slip) -> bool:
    """Whether it is not in Jacobians alone, whose rates are right: one way to make these is enough."""
    return slip.site != HERE


def in_a_list(slip: Slip) -> bool:
    listed = "in the list" in slip.what or slip.what in (GROWING, KEPT)
    return listed or slip.how in ("step_last", "step_last_alone")


def for_all_joints(slip: Slip) -> bool:
    return slip.what == ALL


def in_place(slip: Slip) -> bool:
    return slip.how == "step_other" and slip.what == GROWING


def kept_early(slip: Slip) -> bool:
    """Whether it matters that axes are turned before their own joint turns."""
    return slip.site.startswith("the axis of a joint, kept in world axes")


def of_spins(slip: Slip) -> bool:
    """Whether it is one of angular velocities, not of poses."""
    return slip.site.startswith(SPINS)


def of_velocities(slip: Slip) -> bool:
    """Whether it is one of the velocities of links."""
    return slip.site.startswith(
        ("the velocity of a link", "the arm to a link's origin", "the angular velocity that carries")
    )


def of_origins(slip: Slip) -> bool:
    """Whether it is one of the velocities of joints' origins."""
    return slip.site.endswith("the velocity of a joint's origin")


def but_axes(slip: Slip) -> bool:
    return not of_axes(slip)


def of_axes(slip: Slip) -> bool:
    """Whether it is one of the angular part of columns."""
    axes = (
        TURNING,
        "the axis of a column",
        "the joint whose axis",
        "the direction in a column",
        "the column of a",
        MOVING_AXES,
    )
    return slip.site.startswith(axes)


def of_centres(slip: Slip) -> bool:
    """Whether it is one of the places of bodies' centres."""
    return slip.site.startswith(("the centre of mass of a body", "the place of a body's", "the frame in which a body"))


def of_products(slip: Slip) -> bool:
    return slip.site == MOVING_AXES or slip.site.endswith("by q_k")


def but_symbols(slip: Slip) -> bool:
    """Whether it is none in Christoffel's sum, which is the same whatever makes the derivatives of M."""
    return "Christoffel" not in slip.site


def of_walks(slip: Slip) -> bool:
    return slip.site == MOVING_AXES


def of_cross_products(slip: Slip) -> bool:
    """Whether it is in what makes all cross products, in velocities as in Jacobians."""
    return slip.site.startswith(SKEW)


def of_weights(slip: Slip) -> bool:
    """Whether something else stands for the mass of a body, of those without one too."""
    return slip.site.startswith(("the mass in", "the weight of"))


def askew(slip: Slip) -> bool:
    """Whether M may lose its symmetry by a slip."""
    halves = ("dM/dq_k, of one half", "dJ_i . M J_j in dM/dq_k", "J_i . M dJ_j in dM/dq_k")
    return slip.site.startswith(("the inertia of a body", READ, TURNED, IN_CARRIER, *halves))
