"""How a subject writes what it computes: which column is what, and in which frame it is expressed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Protocol

import numpy as np

from ...algorithms.regressor import rotors
from ...errors import ArgumentError, nearest
from ...model.joints import Floating, Planar, Spherical
from ...model.robot import Frame, Joint, Robot

BASE_Q = ("x", "y", "z", "qw", "qx", "qy", "qz")
BASE_V = ("wx", "wy", "wz", "vx", "vy", "vz")
WORDS = {
    "angular": ("body", "world"),
    "linear": ("body", "world", "origin"),
    "reference": ("local_world_aligned", "world", "local"),
}
PARAMETERS = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Of a link: mass, first moments, and second moments about its origin."""
ROTOR = "rotor"
WRENCH = ("nx", "ny", "nz", "fx", "fy", "fz")
_ENDINGS = {  # of the columns in q of joints with several coordinates, by what these are
    Floating.coordinates: BASE_Q,
    Planar.coordinates: ("x", "y", "angle"),
    Spherical.coordinates: ("qw", "qx", "qy", "qz"),
    ("angle", "length"): ("angle", "slide"),
}


@dataclass(frozen=True)
class Convention:
    """How a subject writes: its columns by name, its six-vectors' rows, and the frames it means.

    Names decide, never places: a subject lists its own columns in its own order.

    Parameters
    ----------
    q : tuple of str
        Its coordinates: a joint's name, or x y z qw qx qy qz of a floating base.  A joint with several
        coordinates has ``joint.qw``, ``joint.angle``, ...
    v : tuple of str
        Its velocities: a joint's name, or wx wy wz vx vy vz of a floating base.
    rows : tuple of str
        Of six-vectors: wx wy wz vx vy vz in its order (for momenta: of l and p).
    angular : str
        The base's angular velocity is in the axes of the "body" or of the "world".
    linear : str
        The base's linear velocity is that of its origin in the axes of the "body" or of the "world", or
        that of the body's point at the world's "origin" (the spatial velocity).
    reference : str
        Of its Jacobians, and of wrenches that act on frames: "local_world_aligned" (at the frame, in world axes),
        "world" or "local".
    parameters : tuple of str
        The columns of its regressor, ``link.m``, ``link.mcx`` ... ``link.Izz`` (see `PARAMETERS`), about the link's
        origin in its axes, and ``joint.rotor``; those of `dualpin.inertial_parameters` if none are given.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.Convention(q=("elbow", "wrist"), v=("elbow", "wrist")).reference
    'local_world_aligned'
    """

    q: tuple[str, ...]
    v: tuple[str, ...]
    rows: tuple[str, ...] = BASE_V
    angular: str = "body"
    linear: str = "body"
    reference: str = "local_world_aligned"
    parameters: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("q", "v", "rows", "parameters"):
            object.__setattr__(self, name, _names(name, getattr(self, name)))
        if sorted(self.rows) != sorted(BASE_V):
            raise ArgumentError(f"Convention: rows must hold {' '.join(BASE_V)} once each; got {' '.join(self.rows)}")
        for word, choices in WORDS.items():
            given = getattr(self, word)
            if given not in choices:
                raise ArgumentError(f"Convention: {word} {given!r} is not known; {nearest(str(given), choices)}")

    @classmethod
    def of(cls, robot: Robot) -> Convention:
        """How dualpin itself writes."""
        q, v = columns(robot)
        return cls(q, v)

    @classmethod
    def read(cls, said: Mapping[str, Any], robot: Robot) -> Convention:
        """From what ``subject.json`` or a mapping says; what is not said is as dualpin writes."""
        known = {"q", "v", "rows", "parameters", *WORDS}
        unknown = sorted(set(said) - known)
        if unknown:
            raise ArgumentError(f"Convention: {unknown[0]!r} is not known; {nearest(unknown[0], known)}")
        q, v = columns(robot)
        return cls(**{"q": q, "v": v, **said})

    def to_dict(self) -> dict[str, Any]:
        return {k: list(x) if isinstance(x, tuple) else x for k, x in asdict(self).items()}


class Subject(Protocol):
    """The code that is judged: it gives its name and its conventions; its terms are methods.

    Any of the names of `dualpin.crosscheck.subjects.QUESTIONS` may be a method: ``fk(q, frame)``,
    ``jacobian(q, frame)``, ``rnea(q, v, a)``, ``crba(q)``, ...; ``rnea_f_ext(q, v, a, f_ext, frame)`` is under the
    wrench f_ext on that frame, and derivatives by q, v and a (or tau) are three matrices.  It is asked one state a
    call, unless it sets ``batched = True`` and takes arrays with a leading axis.  ``fk`` returns a 4x4 matrix, or
    x y z qw qx qy qz.  An exception means "not answered".

    ``calls``, if there is one, says how the subject is asked in its own words: Python, of "" what comes first, and of
    a term the line that prints it from q, v, a, tau and frame.  Reports show a difference with it.
    """

    name: str
    version: str
    writes: Convention


def columns(robot: Robot) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names of a robot's columns of q and of v, in dualpin's order."""
    q, v = [""] * robot.nq, [""] * robot.nv
    for j in robot:
        if j.mimic is None:
            of_q, of_v = names_of(robot, j)
            q[j.q], v[j.v] = of_q, of_v
    return tuple(q), tuple(v)


def parameter_names(robot: Robot) -> tuple[str, ...]:
    """The names of `dualpin.inertial_parameters`: a body is called as the link at its origin."""
    links: dict[int, str] = {}
    for f in robot.frames:
        if f.role == "link" and f.joint is not None and is_ground(f):
            links.setdefault(f.joint.index, f.name)
    bodies = [f"{links.get(j.index, j.name)}.{p}" for j in robot for p in PARAMETERS]
    return (*bodies, *(f"{names_of(robot, j)[1][n]}.{ROTOR}" for j, n in rotors(robot)))


def is_ground(f: Frame) -> bool:
    """Whether a frame is that of its joint."""
    return bool((f.placement.array == np.eye(4)).all())


def base_of(robot: Robot) -> Joint | None:
    """The joint that lets the base float, if it does."""
    first = robot.joints[0] if robot.joints else None
    return (
        first
        if first is not None and first.parent is None and first.model.coordinates == Floating.coordinates
        else None
    )


def floats_of(robot: Robot) -> list[Joint]:
    """The joints that let bodies float in the world: the base, and loose objects of a scene."""
    return [j for j in robot if j.parent is None and j.model.coordinates == Floating.coordinates]


def names_of(robot: Robot, joint: Joint) -> tuple[Sequence[str], Sequence[str]]:
    """The names of one joint's columns of q and of v.

    Those of a floating base stand alone, unless a joint has the name of one of them.
    """
    of_base = joint is base_of(robot)
    if of_base and not {j.name for j in robot} & {*BASE_Q, *BASE_V}:
        return BASE_Q, BASE_V
    if joint.model.nq == joint.model.nv == 1:
        return [joint.name], [joint.name]
    model = joint.model
    q = _ENDINGS.get(model.coordinates, [str(i) for i in range(model.nq)])
    v = model.velocity_names if len(model.velocity_names) == model.nv else [str(i) for i in range(model.nv)]
    return [f"{joint.name}.{x}" for x in q], [f"{joint.name}.{x}" for x in (BASE_V if of_base else v)]


def _names(what: str, given: Iterable[str]) -> tuple[str, ...]:
    if isinstance(given, str):
        raise ArgumentError(f"Convention: {what} must be a sequence of names, got the text {given!r}")
    names = tuple(given)
    wrong = [n for n in names if not isinstance(n, str)]
    if wrong:
        raise ArgumentError(f"Convention: {what} must hold names, got {wrong[0]!r}")
    double = sorted({n for n in names if names.count(n) > 1})
    if double:
        raise ArgumentError(f"Convention: {what} names {double[0]!r} twice")
    return names
