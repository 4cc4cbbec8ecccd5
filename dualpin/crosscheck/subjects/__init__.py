"""Subjects: the dynamics code that is judged, how it writes, and how it is asked."""

from .answers import Answers
from .asking import Asking, asking
from .commands import Command
from .convention import Convention, Subject
from .layout import Layout
from .questions import QUESTIONS, Question
from .resolve import resolve, shipped
from .starter import LANGUAGES, write_starter

__all__ = [
    "LANGUAGES",
    "QUESTIONS",
    "Answers",
    "Asking",
    "Command",
    "Convention",
    "Layout",
    "Question",
    "Subject",
    "asking",
    "resolve",
    "shipped",
    "write_starter",
]
