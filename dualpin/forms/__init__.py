"""Other forms of a robot: Denavit-Hartenberg tables and products of exponentials, to and fro."""

from .build import from_dh
from .dh import to_dh
from .table import DHEnd, DHRow, DHStep, DHTable

__all__ = ["DHEnd", "DHRow", "DHStep", "DHTable", "from_dh", "to_dh"]
