"""Answers of a subject as arrays, and the reasons for missing ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .asking import Asking
from .convention import Convention, parameter_names
from .layout import rotations


@dataclass
class Answers:
    """The answers of one subject to one `Asking`.

    Attributes
    ----------
    sent : dict of arrays
        The states, in the subject's columns.
    terms : dict of arrays
        Of each term, (n, ...) or (n, frames, ...); not-a-number where it was not answered.
    silent : dict of str
        Why a term has no answer: "not offered", or what went wrong.
    history : dict of float
        Terms whose answer to the same state changed with what was asked between, and by how much.
    """

    name: str
    version: str
    how: Convention
    asking: Asking
    sent: dict[str, np.ndarray]
    terms: dict[str, np.ndarray] = field(default_factory=dict)
    silent: dict[str, str] = field(default_factory=dict)
    remarks: dict[str, str] = field(default_factory=dict)
    history: dict[str, float] = field(default_factory=dict)
    refused: str = ""
    """Why it has no answers at all: it does not read the robot."""
    seconds: float = 0.0
    calls: dict[str, str] = field(default_factory=dict)
    """How the subject is asked in its own words: of "" what comes first, of each term the call."""

    def take(self, term: str, x: np.ndarray | None, note: Mapping[str, Any]) -> None:
        """Keep an answer and what was noted about it."""
        errors = note.get("errors", {})
        if x is not None:
            wrong, x = shaped(self, term, x)
            if not wrong:
                self.terms[term] = x
            else:
                self.silent[term] = wrong
        elif note.get("absent"):
            self.silent[term] = next(iter(errors.values()), "not offered")
        else:
            self.silent[term] = next(iter(errors.values()), "no answer")
        if term in self.terms and errors:
            frames = [f for f in errors if f]
            which = f"not answered for {', '.join(frames)}" if frames else "not answered for some states"
            self.remarks[term] = f"{which}: {next(iter(errors.values()))}"
        if note.get("states"):
            slow = f"slow: only {note['states']} of {self.asking.samples} states asked"
            self.remarks[term] = "; ".join(x for x in (self.remarks.get(term, ""), slow) if x)
        if note.get("history") is not None:
            self.history[term] = float(note["history"])

    def later(self, apart: Mapping[str, float]) -> None:
        """Terms whose answer changed once all other terms had been evaluated."""
        self.history |= {t: float(x) for t, x in apart.items() if t in self.terms and t not in self.history}


def shaped(answers: Answers, term: str, x: np.ndarray) -> tuple[str, np.ndarray]:
    """The answer in the shape that is compared, or what is wrong with its shape."""
    want = shape_of(answers, term)
    lead, tail = want[: len(want) - len(_tail(term, answers))], _tail(term, answers)
    if term == "fk" and x.shape == (*lead, 7):
        x = poses(x)
    if term == "fk" and x.shape == (*lead, 3, 4):
        x = np.concatenate([x, np.broadcast_to([0.0, 0.0, 0.0, 1.0], (*lead, 1, 4))], axis=-2)
    own = x.shape[len(lead) :]
    if x.shape[: len(lead)] == lead and [k for k in own if k != 1] == [k for k in tail if k != 1]:
        x = x.reshape(want)  # columns (n, 1) for vectors, (1,) for numbers
    if x.shape != want:
        got = x.shape[len(lead) :] if x.shape[: len(lead)] == lead else x.shape
        turned = "; is it transposed?" if len(tail) == 2 and got == tail[::-1] else ""
        return f"shape {got} for one state; {tail} expected{turned}", x
    return "", x


def _tail(term: str, answers: Answers) -> tuple[int, ...]:
    nv = len(answers.how.v)
    return {
        "fk": (4, 4), "jacobian": (6, nv), "jacobian_dot": (6, nv), "frame_velocity": (6,), "frame_acceleration": (6,),
        "com": (3,),
        "com_jacobian": (3, nv), "centroidal_momentum_matrix": (6, nv), "kinetic_energy": (), "potential_energy": (),
        "crba": (nv, nv), "minv": (nv, nv), "coriolis": (nv, nv), "rnea_derivatives": (3, nv, nv),
        "aba_derivatives": (3, nv, nv),
        "joint_torque_regressor": (nv, len(answers.how.parameters or parameter_names(answers.asking.robot))),
    }.get(term, (nv,))  # fmt: skip


def shape_of(answers: Answers, term: str) -> tuple[int, ...]:
    from .questions import QUESTIONS

    lead = (answers.asking.samples, *((len(answers.asking.frames),) if QUESTIONS[term].framed else ()))
    return (*lead, *_tail(term, answers))


def poses(x: np.ndarray) -> np.ndarray:
    """Matrices (..., 4, 4) of x y z qw qx qy qz."""
    H = np.zeros((*x.shape[:-1], 4, 4))
    H[..., :3, :3], H[..., :3, 3], H[..., 3, 3] = rotations(x[..., 3:]), x[..., :3], 1.0
    return np.where(np.isnan(x).any(axis=-1)[..., None, None], np.nan, H)
