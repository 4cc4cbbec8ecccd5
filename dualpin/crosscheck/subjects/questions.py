"""The terms that a subject may offer, and how each is converted between conventions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import ArgumentError, nearest


@dataclass(frozen=True)
class Question:
    """One term a subject may have.

    Attributes
    ----------
    term : str
        What the subject's method is called.
    source : str
        The term of `dualpin.terms.TERMS` that answers it.
    inputs : tuple of str
        Among "q", "v", "a", "tau", "f_ext"; a term of a frame takes the frame's name after them.
    form : str
        What kind of quantity it is: how `Layout` rewrites it.
    framed : bool
        Whether it belongs to a frame.
    solves : bool
        Whether a linear system with the mass matrix is solved in it.

    A term with "f_ext" is that of its source under a wrench on the frame, see `pushed`.
    """

    term: str
    source: str
    inputs: tuple[str, ...]
    form: str
    framed: bool = False
    solves: bool = False

    @property
    def pushes(self) -> bool:
        """Whether a wrench acts on the frame."""
        return "f_ext" in self.inputs

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
    q.term: q
    for q in (
        Question("fk", "frame_pose", ("q",), "plain", framed=True),
        Question("jacobian", "jacobian", ("q",), "six", framed=True),
        Question("frame_velocity", "frame_velocity", ("q", "v"), "twist", framed=True),
        Question("jacobian_dot", "jacobian_dot", ("q", "v"), "six_rate", framed=True),
        Question("frame_acceleration", "frame_acceleration", ("q", "v", "a"), "twist", framed=True),
        Question("gravity", "gravity", ("q",), "force"),
        Question("crba", "crba", ("q",), "matrix"),
        Question("com", "com", ("q",), "plain"),
        Question("com_jacobian", "com_jacobian", ("q",), "columns"),
        Question("centroidal_momentum_matrix", "centroidal_momentum_matrix", ("q",), "six"),
        Question("kinetic_energy", "kinetic_energy", ("q", "v"), "plain"),
        Question("potential_energy", "potential_energy", ("q",), "plain"),
        Question("bias", "bias", ("q", "v"), "bias"),
        Question("rnea", "rnea", ("q", "v", "a"), "force"),
        Question("aba", "aba", ("q", "v", "tau"), "acceleration", solves=True),
        Question("minv", "minv", ("q",), "inverse", solves=True),
        Question("coriolis", "coriolis", ("q", "v"), "coriolis"),
        Question("rnea_f_ext", "rnea", ("q", "v", "a", "f_ext"), "pushed_force", framed=True),
        Question("aba_f_ext", "aba", ("q", "v", "tau", "f_ext"), "pushed_acceleration", framed=True, solves=True),
        Question("joint_torque_regressor", "joint_torque_regressor", ("q", "v", "a"), "regressor"),
        Question("rnea_derivatives", "rnea_derivatives", ("q", "v", "a"), "derivatives"),
        Question("aba_derivatives", "aba_derivatives", ("q", "v", "tau"), "derivatives", solves=True),
    )
}
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
    given = ({**states, "tau": states["tau"] + torques[..., k, :]} for k in range(J.shape[-3]))
    return np.stack([source(plain, s) for s in given], axis=-2)


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
