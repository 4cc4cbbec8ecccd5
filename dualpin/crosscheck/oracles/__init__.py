"""Other libraries, asked the same questions.  Each adapter alone knows its library's conventions."""

from .oracle import Oracle, OracleError
from .pinocchio import Pinocchio

ORACLES: dict[str, type[Oracle]] = {"pinocchio": Pinocchio}
"""By the name that `dualpin.validate(oracle=)` takes."""

__all__ = ["ORACLES", "Oracle", "OracleError"]
