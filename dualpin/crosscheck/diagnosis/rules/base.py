"""The pose of a floating base, taken for another; its velocity is what was sent, in the axes in which it was sent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ...subjects.convention import BASE_V
from ...subjects.layout import product, rotations, transposed
from ...subjects.questions import QUESTIONS
from ..case import Case, States, View
from ..hypothesis import Hypothesis
from .inputs import passed
from .register import ALL, READINGS, proposer

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
    to = list(range(7))
    to[a], to[b] = b, a
    return _ordered(*to)


def _ordered(*places: int) -> Changed:
    return lambda x: x[:, list(places)]


def _unit(x: np.ndarray) -> np.ndarray:
    """With a quaternion that is no unit quaternion made one."""
    return np.concatenate([x[:, :3], x[:, 3:] / np.linalg.norm(x[:, 3:], axis=1, keepdims=True)], 1)


def _in_body_axes(inverse: bool) -> Changed:
    def changed(x: np.ndarray) -> np.ndarray:
        R = rotations(x[:, 3:])
        return np.concatenate([product(transposed(R) if inverse else R, x[:, :3]), x[:, 3:]], 1)

    return changed


def _in_other_axes(at: tuple[int, ...], inverse: bool, R: np.ndarray, x: np.ndarray) -> np.ndarray:
    x = x.copy()
    for k in at:
        x[:, k : k + 3] = product(transposed(R) if inverse else R, x[:, k : k + 3])
    return x


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
    "y z x of the base's position are read as x y z": ("base_entry", _ordered(1, 2, 0, 3, 4, 5, 6), 1.15),
    "z x y of the base's position are read as x y z": ("base_entry", _ordered(2, 0, 1, 3, 4, 5, 6), 1.15),
    "qy qz qx of the base's quaternion are read as qx qy qz": ("base_entry", _ordered(0, 1, 2, 3, 5, 6, 4), 1.15),
    "qz qx qy of the base's quaternion are read as qx qy qz": ("base_entry", _ordered(0, 1, 2, 3, 6, 4, 5), 1.15),
    "qx qy qz qw of the base's quaternion are read as qw qx qy qz": ("base_entry", _ordered(0, 1, 2, 4, 5, 6, 3), 1.1),
    "the base's quaternion is read before its position": ("base_entry", _ordered(4, 5, 6, 0, 1, 2, 3), 1.1),
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


VELOCITIES: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    f"{which} {how}": partial(_in_other_axes, at, inverse)
    for which, at in (("angular", (0,)), ("linear", (3,)), ("angular and linear", (0, 3)))
    for how, inverse in (("turned by its orientation", False), ("turned by the inverse of its orientation", True))
} | {
    "its other part first": lambda R, x: np.concatenate([x[:, 3:], x[:, :3]], 1),
    "zero": lambda R, x: 0 * x,
    "the angular part zero": lambda R, x: x * (np.arange(6) >= 3),
    "the linear part zero": lambda R, x: x * (np.arange(6) < 3),
}  # fmt: skip
"""Of the base's orientation (n, 3, 3), and of its velocity, or its acceleration, as the subject has it (n, 6)."""


@proposer(
    "base_motion", "the base's velocity or acceleration is taken for another where it is read",
    "use v and a as they are passed, in the axes and the order of the answers", late=READINGS,
)  # fmt: skip
def base_motion(h: Hypothesis, case: Case) -> list[Hypothesis]:
    """Of inputs alone: answers are in the columns that the subject declares."""

    def one(words: str, inputs: tuple[str, ...]) -> Hypothesis:
        def change(view: View, s: States) -> States:
            R, at = rotations(view.states["q"][:, 3:7]), [view.layout.how.v.index(n) for n in BASE_V]
            found = {k: s[k].copy() for k in inputs}
            for x in found.values():
                x[:, at] = VELOCITIES[words](R, x[:, at])
            return found

        terms = tuple(t for t in ALL if set(inputs) & set(QUESTIONS[t].inputs))
        act, values = lambda view: passed(view, change), f"{' and '.join(inputs)}: {words}"
        return replace(h, terms=terms, place="state", act=act, values=values, cost=1.1, of_a_call=True)

    each = (("v",), ("a",), ("v", "a"))
    return [one(words, inputs) for words in VELOCITIES for inputs in each] if case.floating else []


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
            return passed(view, lambda view, s: {k: _moved(s[k], 7 if k == "q" else 6, step) for k in what})

        return replace(h, says=words, terms=ALL, place="state", act=act, cost=1.05)

    return [one(words) for words in SHIFTS] if case.floating else []


def _moved(x: np.ndarray, first: int, step: int) -> np.ndarray:
    """With the columns from `first` read so many later."""
    beyond = np.concatenate([x, 0 * x[:, :1]], 1)[:, first + step :]
    return np.concatenate([x[:, :first], beyond[:, : x.shape[1] - first]], 1)
