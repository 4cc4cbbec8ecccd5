"""Errors of a subject, of Pinocchio and of dualpin at one state, against the term's definition in 50 digits."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import DualpinError
from ..terms import TERMS
from .arbiter import defined
from .definitions import UndecidedError
from .results import DUALPIN, NEITHER, ORACLE
from .subjects.answers import Answers
from .subjects.asking import expected
from .subjects.layout import Layout
from .subjects.questions import QUESTIONS, Question, pushed

if TYPE_CHECKING:
    from .oracles.pinocchio import Pinocchio

States = Mapping[str, np.ndarray]
Source = Callable[[Question, States, tuple[str, ...]], np.ndarray]
"""A term's value at states, on frames: by definition or by Pinocchio."""

SECONDS = 5.0
"""Of the processor, for one state: an arm's terms take 0.1 to 1 s, C of a humanoid much longer."""
_LONG: dict[tuple[str, bool, str], str] = {}
"""Terms of robots that could not be evaluated in time: other subjects are not made to wait for them again."""
FORMS_WITH_MASS = ("bias", "coriolis")


class Court:
    """One subject's answers before the 50 digits; Pinocchio's too where it is installed and reads the robot."""

    def __init__(self, answers: Answers, layout: Layout) -> None:
        self.answers, self.layout, self.robot = answers, layout, answers.asking.robot
        self.pinocchio = self._witness()

    def _witness(self) -> Pinocchio | None:
        from .oracles.pinocchio import Pinocchio

        asking = self.answers.asking
        try:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "robot.urdf"
                path.write_text(asking.text, encoding="utf-8")
                oracle = Pinocchio.of_file(self.robot, str(path), asking.floating)
        except DualpinError:
            return None
        for layout in (oracle.free, oracle.coupled):
            if layout is not None:
                layout.model.gravity.linear = np.array(asking.gravity)
        return oracle

    def errors(self, term: str, sample: int, frame: int) -> dict[str, float]:
        """Scaled errors of the subject ("oracle"), of dualpin and of Pinocchio against 50 digits, at one state.

        What decides is the term's definition, not an algorithm of dualpin's in more digits, which would share its
        mistakes.

        Raises
        ------
        UndecidedError
            If the definition takes too long, or has no value.
        """
        question, one = QUESTIONS[term], slice(sample, sample + 1)
        asked = (self.answers.asking.text, self.answers.asking.floating, term)
        if asked in _LONG:
            raise UndecidedError(_LONG[asked])
        states = {k: x[one] for k, x in self.answers.asking.states.items()}
        frames = (self.answers.asking.frames[frame],) if question.framed else ()
        try:
            exact = self._written(question, states, frames, self._truth)
        except UndecidedError as e:
            _LONG[asked] = str(e)
            raise
        said = {
            "dualpin": expected(self.robot, self.layout, term, states, frames),
            "oracle": self._answer(term, sample, frame),
        }
        if self.pinocchio is not None:
            with contextlib.suppress(DualpinError, KeyError):
                said["pinocchio"] = self._written(question, states, frames, self._heard)
        scale = max(1.0, float(np.abs(exact).max(initial=0.0)))
        with np.errstate(all="ignore"):
            apart = {who: np.abs(np.where(np.isnan(x), exact, x) - exact).max(initial=0.0) for who, x in said.items()}
        return {who: float(x) / scale if np.isfinite(x) else float("inf") for who, x in apart.items()}

    def _answer(self, term: str, sample: int, frame: int) -> np.ndarray:
        x = self.answers.terms[term][sample : sample + 1]
        return x[:, frame : frame + 1] if QUESTIONS[term].framed else x

    def _written(self, question: Question, states: States, frames: tuple[str, ...], source: Source) -> np.ndarray:
        """A source's value in the subject's form."""

        def answer(of: Question, at: Mapping[str, np.ndarray]) -> np.ndarray:
            return source(of, at, frames)

        x, other = pushed(question, states, answer) if question.pushes else answer(question, states), None
        if self.layout.turns and question.form in FORMS_WITH_MASS:
            other = source(QUESTIONS["crba"], states, ())
        elif self.layout.turns and question.form == "six_rate":
            other = source(QUESTIONS["jacobian"], states, frames)
        return self.layout.answer(question.form, x, states, other)

    def _options(self, question: Question, frames: tuple[str, ...]) -> list[dict]:
        if not question.framed:
            return [{}]
        options = question.options(self.layout.how.reference)
        return [{"frame": self.robot.frame(f), **options} for f in frames]

    def _truth(self, question: Question, states: States, frames: tuple[str, ...]) -> np.ndarray:
        state = {k: states[k][0] for k in question.inputs}
        found = [
            defined(self.robot, question.source, state, TERMS[question.source].shape(self.robot, **o), SECONDS, **o)
            for o in self._options(question, frames)
        ]
        return np.stack(found)[None] if question.framed else found[0][None]

    def _heard(self, question: Question, states: States, frames: tuple[str, ...]) -> np.ndarray:
        state = {k: states[k] for k in question.inputs}
        assert self.pinocchio is not None  # asked only where there is one
        found = self.pinocchio.compute(question.source, state, self._options(question, frames))
        return np.stack(found, axis=1) if question.framed else np.asarray(found[0])


def nearer(errors: dict[str, float], tolerance: float) -> str:
    """Which is within tolerance of 50 digits: the subject ("oracle"), dualpin, or neither."""
    if min(errors["dualpin"], errors["oracle"]) > tolerance:
        return NEITHER
    return DUALPIN if errors["dualpin"] <= errors["oracle"] else ORACLE
