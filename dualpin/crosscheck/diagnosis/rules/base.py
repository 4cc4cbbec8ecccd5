"""The pose of a floating base, taken for another; its velocity is what was sent, in the axes in which it was sent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...subjects.layout import product, rotations, transposed
from ..case import Case, States, View
from ..hypothesis import Hypothesis
from .register import ALL, proposer

Changed = Callable[[np.ndarray], np.ndarray]
"""Of x y z qw qx qy qz (n, 7)."""


def _times(*factors: float) -> Changed:
    return lambda x: x * factors


def _with(at: slice, values: tuple[float, ...]) -> Changed:
    def changed(x: np.ndarray) -> np.ndarray:
        x = x.copy()
        x[:, at] = values
        return x

    return changed


def _exchanged(a: int, b: int) -> Changed:
    def changed(x: np.ndarray) -> np.ndarray:
        to = list(range(7))
        to[a], to[b] = b, a
        return x[:, to]

    return changed


def _unit(x: np.ndarray) -> np.ndarray:
    """With a quaternion that is no unit quaternion made one."""
    return np.concatenate([x[:, :3], x[:, 3:] / np.linalg.norm(x[:, 3:], axis=1, keepdims=True)], 1)


def _in_body_axes(inverse: bool) -> Changed:
    def changed(x: np.ndarray) -> np.ndarray:
        R = rotations(x[:, 3:])
        return np.concatenate([product(transposed(R) if inverse else R, x[:, :3]), x[:, 3:]], 1)

    return changed


NAMES = ("x", "y", "z", "qw", "qx", "qy", "qz")
POSES: dict[str, tuple[str, Changed, float]] = {
    "the base's pose is ignored": ("base_pose", _with(slice(0, 7), (0, 0, 0, 1, 0, 0, 0)), 1.0),
    "the base's position is ignored": ("base_pose", _with(slice(0, 3), (0, 0, 0)), 1.05),
    "the base's orientation is ignored": ("base_pose", _with(slice(3, 7), (1, 0, 0, 0)), 1.05),
    "the base's orientation is inverted": ("base_turn", _times(1, 1, 1, 1, -1, -1, -1), 1.0),
    "the base's position is in its own axes, and is turned by its orientation": (
        "base_place", _in_body_axes(inverse=False), 1.05
    ),
    "the base's position is turned by the inverse of its orientation": (
        "base_place", _in_body_axes(inverse=True), 1.05
    ),
    "the base's position has the other sign": ("base_entry", _times(-1, -1, -1, 1, 1, 1, 1), 1.1),
    **{
        f"{NAMES[k]} of the base's pose has the other sign": (
            "base_entry", _times(*(-1.0 if i == k else 1.0 for i in range(7))), 1.1
        )
        for k in (0, 1, 2, 4, 5, 6)
    },
    **{
        f"{NAMES[a]} and {NAMES[b]} of the base's pose are exchanged": ("base_entry", _exchanged(a, b), 1.1)
        for a, b in ((0, 1), (0, 2), (1, 2), (4, 5), (4, 6), (5, 6))
    },
}  # fmt: skip


@proposer(
    "base_pose", "the base's pose is taken for another",
    "pass the base's position, and the quaternion that turns the base's axes into the world's",
    {
        "base_pose": "the base's pose is ignored, or its position or orientation alone",
        "base_turn": "the base's orientation is inverted",
        "base_place": "the base's position is turned by its orientation, or by the inverse",
        "base_entry": "an entry of the base's pose has the other sign, or two are exchanged",
    },
)  # fmt: skip
def base_pose(h: Hypothesis, case: Case) -> list[Hypothesis]:
    def one(key: str, says: str, f: Changed, cost: float) -> Hypothesis:
        def act(view: View) -> States:
            q = view.states["q"].copy()
            q[:, :7] = _unit(f(q[:, :7]))
            theirs = {**view.layout.states(view.states), "q": view.layout.positions(q)}
            return {**view.states, **view.layout.back(theirs)}

        return replace(h, key=key, says=says, terms=ALL, place="state", act=act, cost=cost)

    return [one(key, says, f, cost) for says, (key, f, cost) in POSES.items()] if case.floating else []


SHIFTS: dict[str, tuple[tuple[str, ...], int]] = {
    "positions of joints are read one column too early, as if the base had six": (("q",), -1),
    "velocities of joints are read one column too late, as if the base had seven": (("v",), 1),
    "velocities and accelerations of joints are read one column too late, as if the base had seven": (("v", "a"), 1),
    "accelerations of joints are read one column too late, as if the base had seven": (("a",), 1),
    "torques of joints are read one column too late, as if the base had seven": (("tau",), 1),
}


@proposer(
    "joint_columns", "columns of joints are counted from a wrong one, after those of the base",
    "of a floating base q has seven columns, v has six",
)  # fmt: skip
def joint_columns(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """As the subject has its columns; what is beyond the last one is zero."""

    def one(words: str) -> Hypothesis:
        what, step = SHIFTS[words]

        def act(view: View) -> States:
            theirs = view.layout.states(view.states)
            for k in what:
                x = theirs[k].copy()
                first = 7 if k == "q" else 6
                x[:, first:] = np.concatenate([theirs[k], 0 * theirs[k][:, :1]], 1)[:, first + step :][
                    :, : x.shape[1] - first
                ]
                theirs[k] = x
            return {**view.states, **view.layout.back(theirs)}

        return replace(h, says=words, terms=ALL, place="state", act=act, cost=1.05)

    return [one(words) for words in SHIFTS] if case.floating else []
