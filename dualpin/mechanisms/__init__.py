"""Linkages and chains by dual matrices: closed loops (RCCC), serial chains, the 2C arm, screws of a robot."""

from .chain import DualChain, body
from .link_jacobian import link_jacobian
from .locked import Locked
from .loop import Loop
from .loop_data import LoopMotion, LoopPosition
from .rccc import RCCC, Iteration, Position
from .screws import PrincipalScrews, instantaneous_screw, principal_screws
from .two_c import TOPOLOGIES, TwoC

__all__ = [
    "RCCC", "TOPOLOGIES", "DualChain", "Iteration", "Locked", "Loop", "LoopMotion", "LoopPosition", "Position",
    "PrincipalScrews", "TwoC", "body", "instantaneous_screw", "link_jacobian",
    "principal_screws",
]  # fmt: skip
