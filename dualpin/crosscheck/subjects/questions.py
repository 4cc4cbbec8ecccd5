"""What a subject may be asked, and how each answer changes when it is written otherwise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

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
        Among "q", "v", "a", "tau"; a term of a frame takes the frame's name after them.
    form : str
        What kind of quantity it is: how `Layout` rewrites it.
    framed : bool
        Whether it belongs to a frame.
    solves : bool
        Whether a linear system with the mass matrix is solved in it.
    """

    term: str
    source: str
    inputs: tuple[str, ...]
    form: str
    framed: bool = False
    solves: bool = False

    def options(self, reference: str) -> dict[str, Any]:
        """What `dualpin.terms.TERMS` is asked besides the frame.

        The acceleration is the rate of the velocity: at the frame in world axes, that of its origin (classical).
        """
        if not self.framed or self.term == "fk":
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
    )
}
FRAMED = tuple(t for t, q in QUESTIONS.items() if q.framed)


def wanted(terms: object) -> tuple[str, ...]:
    """Terms by name, or all; an unknown one is an error with the nearest."""
    if terms is None:
        return tuple(QUESTIONS)
    names = [terms] if isinstance(terms, str) else list(terms)  # type: ignore[call-overload]
    for name in names:
        if name not in QUESTIONS:
            raise ArgumentError(f"judge: term {name!r} is not known; {nearest(str(name), QUESTIONS, 'terms', most=99)}")
    return tuple(t for t in QUESTIONS if t in names)
