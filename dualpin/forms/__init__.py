"""Other forms of a robot: Denavit-Hartenberg tables and products of exponentials, to and fro."""

from .build import from_dh
from .build_screws import from_screws
from .dh import to_dh
from .khalil import KhalilRow, KhalilTable
from .screw_tree import ScrewTree
from .screws import Screws, to_screws
from .table import DHEnd, DHRow, DHStep, DHTable

__all__ = [
    "DHEnd", "DHRow", "DHStep", "DHTable", "KhalilRow", "KhalilTable", "ScrewTree", "Screws", "from_dh",
    "from_screws", "to_dh", "to_screws",
]  # fmt: skip
