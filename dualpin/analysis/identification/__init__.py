"""Identification of dynamic parameters: base parameters, exciting motions, estimation."""

from .base import BaseParameters, Margin, base_parameters
from .excitation import Excitation, excite
from .figaroh import from_figaroh, read_figaroh, to_figaroh
from .fit import Identification, identify
from .parameters import Parameters
from .payload import Payload, identify_payload

__all__ = [
    "BaseParameters", "Excitation", "Identification", "Margin", "Parameters", "Payload", "base_parameters", "excite",
    "from_figaroh", "identify", "identify_payload", "read_figaroh", "to_figaroh",
]  # fmt: skip
