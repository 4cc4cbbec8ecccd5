"""Other libraries, evaluated on the same states.  Only the adapter of a library knows its conventions."""

from .oracle import Oracle, OracleError
from .pinocchio import Pinocchio

ORACLES: dict[str, type[Oracle]] = {"pinocchio": Pinocchio}
"""By the name that `dualpin.validate(oracle=)` takes."""

__all__ = ["ORACLES", "Oracle", "OracleError"]
