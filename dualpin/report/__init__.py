"""Results for people: one self-contained HTML page from result files, and what changed between two of them."""

from .changes import Change, Comparison
from .compare import compare
from .document import document
from .page import page
from .read import Study, read, study
from .sections import Section
from .sheet import robot_page

__all__ = [
    "Change", "Comparison", "Section", "Study", "compare", "document", "page", "read", "robot_page", "study",
]  # fmt: skip
