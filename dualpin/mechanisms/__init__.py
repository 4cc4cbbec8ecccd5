"""Linkages and chains by dual matrices: closed loops (RCCC), serial chains, the 2C arm, screws of a robot."""

from .chain import DualChain, body
from .locked import Locked
from .rccc import RCCC, Iteration, Position
from .screws import PrincipalScrews, instantaneous_screw, principal_screws
from .two_c import TOPOLOGIES, TwoC

__all__ = [
    "RCCC", "TOPOLOGIES", "DualChain", "Iteration", "Locked", "Position", "PrincipalScrews", "TwoC", "body",
    "instantaneous_screw", "principal_screws",
]  # fmt: skip
