"""The pose of a floating base, taken for another; its velocity is what was sent, in the axes in which it was sent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

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


NAMES = ("x", "y", "z", "qw", "qx", "qy", "qz")
POSES: dict[str, tuple[str, Changed, float]] = {
    "the base's pose is ignored": ("base_pose", _with(slice(0, 7), (0, 0, 0, 1, 0, 0, 0)), 1.0),
    "the base's position is ignored": ("base_pose", _with(slice(0, 3), (0, 0, 0)), 1.05),
    "the base's orientation is ignored": ("base_pose", _with(slice(3, 7), (1, 0, 0, 0)), 1.05),
    "the base's orientation is inverted": ("base_turn", _times(1, 1, 1, 1, -1, -1, -1), 1.0),
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
