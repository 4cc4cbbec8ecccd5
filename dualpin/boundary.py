"""Names that moved to `dualpin.arguments` and `dualpin.call`."""

from .arguments import choice, numbers
from .call import evaluate as call
from .call.arguments import check_robot

__all__ = ["call", "check_robot", "choice", "numbers"]
