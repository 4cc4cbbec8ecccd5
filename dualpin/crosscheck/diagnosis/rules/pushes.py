"""Wrenches from outside and derivatives: what is done otherwise with them alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from ...subjects.layout import product, transposed
from ...subjects.questions import QUESTIONS
from ..case import Case, View
from ..description import Body, merged
from ..evaluation import evaluate
from ..hypothesis import Hypothesis
from .register import DERIVED, PUSHED, proposer, rule


def _with_wrench(view: View, term: str, k: float | np.ndarray) -> np.ndarray:
    """The term under k times the wrench."""
    return view.compute(term, view.layout.how.reference, f_ext=k * view.states["f_ext"])


@rule(
    "f_ext_sign", "external wrenches push the other way: they are taken for those that the robot exerts",
    "f_ext acts on the robot: tau = M a + h - J^T f_ext", PUSHED, "formula",
)  # fmt: skip
def f_ext_sign(view: View, term: str) -> np.ndarray:
    return _with_wrench(view, term, -1.0)


@rule("f_ext_ignored", "external wrenches are ignored", "subtract J^T f_ext", PUSHED, "formula")
def f_ext_ignored(view: View, term: str) -> np.ndarray:
    return _with_wrench(view, term, 0.0)


@rule(
    "f_ext_moment_ignored", "moments of external wrenches are ignored", "subtract J_angular^T n too", PUSHED, "formula",
    cost=1.1,
)  # fmt: skip
def f_ext_moment_ignored(view: View, term: str) -> np.ndarray:
    return _with_wrench(view, term, np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]))


# --- in other axes, about another point ---

Poses = tuple[np.ndarray, np.ndarray]
"""Of the frames, in the world: (samples, frames, 3, 3) and (samples, frames, 3)."""


def _home(view: View, R: np.ndarray) -> np.ndarray:
    return np.stack([view.description.home[f][:3, :3] for f in view.frames])


def _on_body(view: View) -> np.ndarray:
    """How frames stand on the links that joints move."""
    carried = view.description.carried()
    return np.stack([carried[f][1][:3, :3] for f in view.frames])


AXES: Mapping[str, Callable[[View, np.ndarray], np.ndarray]] = {
    "the world's axes": lambda view, R: np.eye(3),
    "the frame's axes": lambda view, R: R,
    "the frame's axes, turned the wrong way": lambda view, R: transposed(R),
    "the axes of the body that carries the frame": lambda view, R: R @ transposed(_on_body(view)),
    "the axes that the frame has where all coordinates are zero": _home,
    "axes that turn with the body, and are the base's where all coordinates are zero": lambda view, R: (
        R @ transposed(_home(view, R))
    ),
}


def _centres(view: View, poses: Poses, fused: bool) -> np.ndarray:
    """Of mass, of the links or of the bodies that they are fixed on."""
    d, (R, p) = view.description, poses
    bodies = {q.link: q.body for q in (merged(d) if fused else d).parts}
    at = []
    for frame in view.frames:
        carrier, H = d.carried()[frame] if fused else (frame, np.eye(4))
        at.append((np.linalg.inv(H) @ np.append(_centre(bodies.get(carrier)), 1.0))[:3])
    return np.asarray(p + product(R, np.stack(at) + 0 * p))


def _centre(body: Body | None) -> np.ndarray:
    return np.zeros(3) if body is None else body.com


def _carriers(view: View, poses: Poses) -> np.ndarray:
    """The origins of the links that joints move, on which the frames are fixed."""
    R, p = poses
    at = np.stack([np.linalg.inv(view.description.carried()[f][1])[:3, 3] for f in view.frames])
    return np.asarray(p + product(R, at + 0 * p))


ABOUT: Mapping[str, Callable[[View, Poses], np.ndarray]] = {
    "the frame's origin": lambda view, poses: poses[1],
    "the world's origin": lambda view, poses: 0 * poses[1],
    "the origin of the link that carries the frame": _carriers,
    "the centre of mass of the frame's link": partial(_centres, fused=False),
    "the centre of mass of the body that carries the frame": partial(_centres, fused=True),
}


@proposer(
    "f_ext_written", "external wrenches are taken in other axes or about another point than they are given",
    "turn them, and carry their moment to the point that is meant: n + (p - p') x f",
)  # fmt: skip
def f_ext_written(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(axes: str, point: str) -> Hypothesis:
        def act(view: View, term: str) -> np.ndarray:
            H = view.compute("fk")
            poses = R, p = H[..., :3, :3], H[..., :3, 3]
            n, f = (product(AXES[axes](view, R), x[:, None] + 0 * p) for x in np.split(view.states["f_ext"], 2, -1))
            wrench = np.concatenate([n + np.cross(ABOUT[point](view, poses) - p, f), f], -1)
            return _felt(view, term, wrench)

        return replace(h, terms=PUSHED, place="formula", act=act, values=f"taken in {axes}, about {point}", cost=1.15)

    words = "taken as acting on the parent of the frame's link, at the parent's origin"
    on = replace(h, terms=PUSHED, place="formula", act=_on_parent, values=words, cost=1.15)
    return [on, *(one(axes, point) for axes in AXES for point in ABOUT)]


def _on_parent(view: View, term: str) -> np.ndarray:
    """The parent is moved by all joints before the link's own."""
    J, s = view.compute("jacobian").copy(), {"q": view.states["q"][None]}
    parts, columns = {p.link: p for p in view.description.parts}, {p.joint: v for p, v in view.case.parts()}
    wrench = np.repeat(view.states["f_ext"][:, None], len(view.frames), axis=1)
    for i, frame in enumerate(view.frames):
        J[:, i, :, columns.get(parts[frame].joint, slice(0))] = 0.0
    parents = [parts[frame].parent for frame in view.frames]
    up = evaluate(view.robot, QUESTIONS["fk"], s, parents, "local_world_aligned")[0]
    wrench[..., :3] += np.cross((up - view.compute("fk"))[..., :3, 3], wrench[..., 3:])
    return _felt(view, term, wrench, J)


def _felt(view: View, term: str, wrench: np.ndarray, J: np.ndarray | None = None) -> np.ndarray:
    """The term under a wrench on each frame, in world axes and about the frame's origin; J as of `View.compute`."""
    torques = product(transposed(view.compute("jacobian") if J is None else J), wrench)
    if term == "rnea_f_ext":
        return np.asarray(view.compute("rnea")[:, None] - torques)
    pushed = np.linalg.solve(view.compute("crba")[:, None], torques[..., None])[..., 0]
    return np.asarray(view.compute("aba")[:, None] + pushed)


@rule(
    "derivatives_transposed", "derivatives are transposed", "row i, column j: of force i by coordinate j", DERIVED,
    "answer",
)  # fmt: skip
def derivatives_transposed(view: View, term: str, x: np.ndarray) -> np.ndarray:
    return transposed(x)
