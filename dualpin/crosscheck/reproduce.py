"""A few lines that reproduce a difference at its worst state."""

from __future__ import annotations

import numpy as np

from .subjects.answers import Answers
from .subjects.questions import QUESTIONS


def program(term: str, answers: Answers, sample: int, frame: int, got: np.ndarray, expected: np.ndarray) -> str:
    """Python that asks the subject for its worst state, in its own columns, with what came and what was expected.

    Where the subject says how it is asked in its own words (`Answers.calls`), these are the calls; robot.urdf is the
    file that it was given, which ``dualpin ask ROBOT FOLDER`` writes.
    """
    question = QUESTIONS[term]
    lines = [
        "import numpy as np",
        "# columns of q: " + " ".join(answers.how.q),
        "# columns of v: " + " ".join(answers.how.v),
    ]
    if answers.how.q == answers.how.v:
        lines = ["import numpy as np", f"names = {list(answers.how.q)}  # of the columns"]
    lines += [f"{k} = np.array({_numbers(answers.sent[k][sample])})" for k in question.inputs]
    if question.framed:
        lines.append(f"frame = {answers.asking.frames[frame]!r}")
        got, expected = got[frame], expected[frame]
    if term in answers.calls and not answers.asking.floating:
        lines += [*answers.calls.get("", "").splitlines(), *answers.calls[term].splitlines()]
    else:
        lines.append(f"subject.{term}({', '.join([*question.inputs, *['frame'] * question.framed])})")
    lines += [f"# got      {_numbers(got, 9)}", f"# expected {_numbers(expected, 9)}"]
    return "\n".join(lines)


def _numbers(x: np.ndarray, digits: int = 17) -> str:
    """Nested lists on one line; long ones are cut where they are only shown."""
    if np.ndim(x) == 0:
        return f"{float(x):.{digits}g}"
    most = 64 if digits == 17 else 8
    rows = [_numbers(y, digits) for y in x[:most]]
    return "[" + ", ".join(rows) + (", ..." if len(x) > most else "") + "]"
