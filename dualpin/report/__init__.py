"""Results for people: one self-contained HTML page from result files, and what changed between two of them."""

from .compare import Change, Comparison, compare
from .page import page
from .read import Study, read, study

__all__ = ["Change", "Comparison", "Study", "compare", "page", "read", "study"]
