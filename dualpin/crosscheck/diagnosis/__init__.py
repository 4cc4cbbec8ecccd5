"""Find why a subject's answers differ: hypotheses that predict them, and a search for the cheapest set (a story)."""

from ..findings import Finding
from .case import Case
from .diagnose import Diagnosis, diagnose
from .hypothesis import Hypothesis
from .rules import RULES

__all__ = ["RULES", "Case", "Diagnosis", "Finding", "Hypothesis", "diagnose"]
