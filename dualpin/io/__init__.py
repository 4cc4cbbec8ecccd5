"""Reading robots: names and paths to files, files to checked XML, XML to a `Robot`."""

from .catalogue import ALIASES, catalogue, find
from .urdf import load, loads

__all__ = ["ALIASES", "catalogue", "find", "load", "loads"]
