"""The terms that a subject may offer, and how each is converted between conventions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import ArgumentError, nearest
from ...terms import TERMS
from ..checks import CHECKS


@dataclass(frozen=True)
class Question:
    """One term a subject may have.

    Attributes
    ----------
    term : str
        What the subject's method is called.
    source : str
        The term of `dualpin.terms.TERMS` that answers it; a term with "f_ext" is that under a wrench on the frame,
        see `pushed`.
    """

    term: str
    source: str

    @property
    def inputs(self) -> tuple[str, ...]:
        """Among "q", "v", "a", "tau", "f_ext"; a term of a frame takes the frame's name after them."""
        return (*TERMS[self.source].inputs, *["f_ext"] * self.pushes)

    @property
    def form(self) -> str:
        """What kind of quantity it is: how `Layout` rewrites it."""
        return "pushed_" * self.pushes + CHECKS[self.source].form

    @property
    def framed(self) -> bool:
        """Whether it belongs to a frame."""
        return self.pushes or any(option.name == "frame" for option in TERMS[self.source].options)

    @property
    def solves(self) -> bool:
        """Whether a linear system with the mass matrix is solved in it."""
        return CHECKS[self.source].solves

    @property
    def pushes(self) -> bool:
        """Whether a wrench acts on the frame."""
        return self.term.endswith("_f_ext")

    def options(self, reference: str) -> dict[str, Any]:
        """What `dualpin.terms.TERMS` is asked besides the frame.

        The acceleration is the rate of the velocity: at the frame in world axes, that of its origin (classical).
        """
        if not self.framed or self.term == "fk" or self.pushes:
            return {}
        aligned = reference == "local_world_aligned"
        return {"reference": reference} | ({"classical": aligned} if self.term == "frame_acceleration" else {})


# in the order in which a diagnosis looks at them: from positions to forces
QUESTIONS = {
    term: Question(term, "frame_pose" if term == "fk" else term.removesuffix("_f_ext"))
    for term in (
        "fk", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration", "gravity", "crba", "com",
        "com_jacobian", "centroidal_momentum_matrix", "kinetic_energy", "potential_energy", "bias", "rnea", "aba",
        "minv", "coriolis", "rnea_f_ext", "aba_f_ext", "joint_torque_regressor", "rnea_derivatives", "aba_derivatives",
    )
}  # fmt: skip
Source = Callable[[Question, Mapping[str, np.ndarray]], np.ndarray]
"""Answers a question at states (..., size): (..., *shape), or (..., frames, *shape)."""


def pushed(question: Question, states: Mapping[str, np.ndarray], source: Source) -> np.ndarray:
    """A term under a wrench [n; f] on each frame in turn, (..., frames, nv).

    Its power is that of the torques  J^T f  at every velocity, J the frame's Jacobian in the axes and about the
    point in which the wrench is written: they are what a source needs to know of it.
    """
    J = source(QUESTIONS["jacobian"], states)
    torques = np.einsum("...kij,...i->...kj", J, states["f_ext"])
    plain = QUESTIONS[question.source]
    if plain.term == "rnea":
        return source(plain, states)[..., None, :] - torques
    tau = states["tau"][..., None, :] + torques
    *lead, samples, frames, nv = tau.shape
    many = {k: np.repeat(x, frames, axis=-2) for k, x in states.items()}  # the frames of a sample one after another
    return source(plain, {**many, "tau": tau.reshape(*lead, -1, nv)}).reshape(*lead, samples, frames, nv)


FRAMED = tuple(t for t, q in QUESTIONS.items() if q.framed)


def wanted(terms: object) -> tuple[str, ...]:
    """Terms by name, or all; an unknown one is an error with the nearest."""
    if terms is None:
        return tuple(QUESTIONS)
    if not isinstance(terms, Iterable):
        raise ArgumentError(f"judge: terms = {terms!r}, names of terms expected")
    names = [terms] if isinstance(terms, str) else list(terms)
    for name in names:
        if name not in QUESTIONS:
            raise ArgumentError(f"judge: term {name!r} is not known; {nearest(str(name), QUESTIONS, 'terms', most=99)}")
    if not names:
        raise ArgumentError("judge: terms is empty, so there is nothing to compare; None asks all")
    return tuple(t for t in QUESTIONS if t in names)
