"""From torques to parameters: which can be known at all, which motion shows them, and what they are."""

from .base import BaseParameters, base_parameters
from .parameters import Parameters

__all__ = ["BaseParameters", "Parameters", "base_parameters"]
