"""Every term against an independent library, on random states."""

from .judging import judge
from .results import Report, RobotResult, TermResult
from .run import CHECKS, Case, validate

__all__ = ["CHECKS", "Case", "Report", "RobotResult", "TermResult", "judge", "validate"]
