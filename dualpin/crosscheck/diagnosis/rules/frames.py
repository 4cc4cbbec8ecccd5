"""Frames on fixed links: rows in the axes of another link, and points that are not the frame's origin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.layout import product, transposed
from ..case import Case, View
from ..description import homogeneous
from ..displaced import displaced
from ..hypothesis import Hypothesis
from .register import proposer

ROWS = ("jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration")
Turn = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Of R of the frame, and Q, its rotation on the link that carries it: what rows in world axes are turned by."""
TURNS: dict[str, Turn] = {
    "are in the axes of the link that carries the frame": lambda R, Q: Q @ transposed(R),
    "are turned by the frame's rotation": lambda R, Q: R,
    "are turned by the rotation of the link that carries the frame": lambda R, Q: R @ transposed(Q),
    "are turned by the fixed joint's rotation twice": lambda R, Q: R @ Q @ transposed(R),
    "lack the fixed joint's rotation": lambda R, Q: R @ transposed(Q) @ transposed(R),
    "are turned by the fixed joint's rotation": lambda R, Q: Q + 0 * R,
    "are turned by the fixed joint's rotation, transposed": lambda R, Q: transposed(Q) + 0 * R,
}


def _standing(view: View) -> np.ndarray:
    """(frames, 4, 4): how each stands on the link that carries it."""
    carried = view.description.carried()
    return np.array([carried[f][1] for f in view.frames])


@proposer(
    "frame_axes", "rows of frames are in other axes", "turn the rows into the world's axes by R of the frame, once"
)
def frame_axes(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(words: str) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            R, Q = view.compute("fk")[..., :3, :3], _standing(view)[:, :3, :3]
            A, out = TURNS[words](R, Q), x.copy()
            for rows in (slice(0, 3), slice(3, 6)):
                out[:, :, rows] = product(A, x[:, :, rows]) if x.ndim == 3 else A @ x[:, :, rows]
            return out

        says = f"rows of frames on fixed joints {words}"
        return replace(h, says=says, terms=ROWS, place="change", act=act, cost=1.1)

    return [one(words) for words in TURNS] if case.how.reference == "local_world_aligned" else []


POINTS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "is turned by the fixed joint's rpy too": lambda Q, p: Q @ p,
    "is turned by the fixed joint's rpy, transposed": lambda Q, p: Q.T @ p,
    "has the other sign": lambda Q, p: -p,
    "is counted twice": lambda Q, p: 2 * p,
}
"""What becomes of a frame's place p on the link that carries it."""


@proposer(
    "frame_point", "Jacobians and motions are of another point than the frame's origin",
    "take them at the frame's origin, p + R xyz",
)  # fmt: skip
def frame_point(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """While the poses are right."""

    def one(words: str) -> Hypothesis:
        def act(view: View, term: str, x: np.ndarray) -> np.ndarray:
            at = {}
            for k, H in enumerate(_standing(view)):
                Q, p = H[:3, :3], H[:3, 3]
                at[k] = homogeneous(np.eye(3), Q.T @ (POINTS[words](Q, p) - p))
            return displaced(view, term, x, at)

        says = f"the place of a frame on the link that carries it {words}, in Jacobians and motions"
        return replace(h, says=says, terms=ROWS, place="change", act=act, cost=1.1)

    return [one(words) for words in POINTS] if case.how.reference == "local_world_aligned" else []


@proposer("six_sign", "six-vectors of frames have the other sign", "turn the sign of the Jacobian, or of the velocity")
def six_sign(h: Hypothesis, case: Case) -> list[Hypothesis]:
    return [replace(h, terms=ROWS, place="answer", act=lambda view, term, x: -x, cost=1.05)]
