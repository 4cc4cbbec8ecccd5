"""Tensors as <inertial> gives them, and one body of several links that fixed joints hold together.

    I = R J R^T in the link's axes, Q I Q^T in those of the body
    C = sum m c / sum m,     I_C = sum I + m (d.d 1 - d d^T),  d = c - C      (all at once, or one after another)

References: Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.13; Siciliano et al., Robotics (2009),
appendix B.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..description import Body, Description, Part
from .steps import Steps

ONE = np.eye(3)
TURNED = "the tensor of <inertial>, turned by rpy,"
READ = "the tensor of <inertial>"


class Piece(NamedTuple):
    """A link of a body: Q and c, its axes and its centre of mass in those of the body; R and J of its <inertial>."""

    mass: float
    c: np.ndarray
    Q: np.ndarray
    R: np.ndarray
    J: np.ndarray


def listed(d: Description) -> list[Part]:
    """The parts, branch by branch, in the order of the file."""
    place = {joint: k for k, joint in enumerate(d.listed)}
    below: dict[str, list[Part]] = {}
    for p in sorted(d.parts, key=lambda p: place.get(p.joint, len(place))):
        below.setdefault(p.parent, []).append(p)
    found, todo = [], below.get(d.root, [])[::-1]
    while todo:
        found.append(todo.pop())
        todo += below.get(found[-1].link, [])[::-1]
    return found


def pieces(d: Description, fused: bool = True) -> dict[str, list[Piece]]:
    """Of every link that carries some: what is fixed to it, itself first; or of every link, itself alone."""
    where, found = d.carried(), dict[str, list[Piece]]()
    for link, b in [(d.root, d.base), *((p.link, p.body) for p in listed(d))]:
        if b is not None:
            carrier, H = where[link] if fused else (link, np.eye(4))
            piece = Piece(b.mass, (H @ np.append(b.com, 1.0))[:3], H[:3, :3], b.rotation, b.inertia)
            found.setdefault(carrier, []).append(piece)
    return found


def tensor(steps: Steps, piece: Piece) -> np.ndarray:
    """About the piece's centre, in the axes of the body."""
    triangles = {"its upper triangle alone": np.triu(piece.J), "its lower triangle alone": np.tril(piece.J)}
    J = steps.pick(READ, piece.J[None, None], **{k: x[None, None] for k, x in triangles.items()})
    I = steps.congruent(TURNED, piece.R[None, None], J)
    Q = piece.Q[None, None]
    return np.asarray(Q @ I @ np.swapaxes(Q, -1, -2))


def at_once(steps: Steps, group: list[Piece]) -> Body:
    """Centre first, then all tensors about it."""
    mass = sum(p.mass for p in group)
    weighted = sum((p.mass * p.c for p in group), np.zeros(3)) / (mass or 1.0)
    others = {
        "the mean of the links' centres": np.mean([p.c for p in group], axis=0), "that of the first link": group[0].c,
        "that of the last link": group[-1].c, "their sum, not divided by the mass": weighted * mass,
    }  # fmt: skip
    C = steps.pick("the centre of merged links", weighted, **others)
    I = np.zeros((3, 3))
    for k, p in enumerate(group):
        d = steps.add("the arm of Steiner's term", **{"the link's centre": p.c, "the common centre": -C})
        m = steps.pick("the mass in Steiner's term", np.array(p.mass), **{"that of all": np.array(mass)})
        terms = {"the link's tensor": tensor(steps, p)[0, 0], "Steiner's term": _steiner(steps, m, d)}
        I = I + steps.part(
            "the links that are merged", steps.add("the inertia of merged links", **terms), k, len(group)
        )
    return Body(mass, C, np.zeros(3), ONE, I)


def one_by_one(steps: Steps, group: list[Piece]) -> Body:
    """Link after link is added to what is there."""
    first, *more = group
    m, c, I = first.mass, first.c, tensor(steps, first)[0, 0]
    for p in more:
        whole = m + p.mass
        others = {"the mean of the two": (c + p.c) / 2, "that of what is there": c, "that of the new link": p.c}
        C = steps.pick(
            "the centre of what is there and a fixed link", (m * c + p.mass * p.c) / (whole or 1.0), **others
        )
        there = _steiner(steps, np.array(m), c - C, ": of what is there")
        terms = {
            "the tensor of what is there": I, "Steiner's term of what is there": there,
            "the fixed link's tensor": tensor(steps, p)[0, 0],
            "Steiner's term of the fixed link": _steiner(steps, np.array(p.mass), p.c - C, ": of the fixed link"),
        }  # fmt: skip
        I = steps.add("the inertia of what is there and a fixed link", **terms)
        both = np.concatenate([[whole], C, I.ravel()])
        new = np.concatenate([[p.mass], p.c, tensor(Steps(), p)[0, 0].ravel()])
        both = steps.pick("what is there with a fixed link", both, **{"the last link alone, which replaces it": new})
        m, c, I = float(both[0]), both[1:4], both[4:].reshape(3, 3)
    return Body(m, c, np.zeros(3), ONE, I)


def _steiner(steps: Steps, m: np.ndarray, d: np.ndarray, which: str = "") -> np.ndarray:
    terms = {"m d.d 1": m * (d @ d) * ONE, "-m d d^T": -m * np.outer(d, d)}
    return np.asarray(steps.add(f"Steiner's term of merging{which}", **terms))
