"""Results for people: one self-contained HTML page from result files, and what changed between two of them."""

from .changes import Change, Comparison
from .compare import compare
from .document import document
from .page import page
from .read import Study, read, study

__all__ = ["Change", "Comparison", "Study", "compare", "document", "page", "read", "study"]
