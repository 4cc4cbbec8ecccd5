"""Inverse dynamics as a linear function of the inertial parameters of links, in world axes.

    force  = (a - g) m + ([alpha] + [w] [w]) R (m c)
    moment = -[a - g] R (m c) + I alpha + w x I w            I = R J R^T, about the link's origin
    Y = sum Jv^T force + Jw^T moment                         of unit parameters, one after another

References: Atkeson, An and Hollerbach, Estimation of Inertial Parameters of Manipulator Loads and Links, IJRR 5
(1986); Siciliano et al., Robotics (2009), section 7.2.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import permutations
from typing import Any

import numpy as np

from ...subjects.convention import PARAMETERS, parameter_names
from ...subjects.layout import carried, product, transposed
from . import world_motions
from .arrays import cross
from .poses import stacked
from .products import rows_of, skew, wedge
from .references import six
from .steps import Steps, UncoveredError
from .tree import Pose, Tree

View = Any
"""`case.View`: the cases stand on this module."""

PLACES = [("xyz".index(name[1]), "xyz".index(name[2])) for name in PARAMETERS[4:]]
TENSORS = np.array([[[float((i, j) in (at, at[::-1])) for j in range(3)] for i in range(3)] for at in PLACES])
"""Unit second moments, in the order of `PARAMETERS`."""
PRODUCTS = np.array([i != j for i, j in PLACES])[:, None, None]
ORDERS = ("xx yy zz xy xz yz", "xx yy zz xy yz xz", "xx xy xz yy yz zz")
"""Of which of these the columns are, where codes list them in another order than they say."""


@dataclass
class Moving:
    """Links in world axes, (runs, samples, links, ...); `a` is that of the origin."""

    R: np.ndarray
    w: np.ndarray
    alpha: np.ndarray
    a: np.ndarray


def wrenches(steps: Steps, m: Moving, g: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force, and moment about the link's origin, of unit parameters: (runs, samples, links, 3, 10); centres at `c`."""
    of_centre = m.a + cross(m.alpha, c) + cross(m.w, cross(m.w, c))
    a = steps.pick("the acceleration in a regressor", m.a, **{"that of the centre of mass": of_centre})
    return _made(steps, m, _lift(steps, a, g))


def _lift(steps: Steps, a: np.ndarray, g: np.ndarray) -> np.ndarray:
    return np.asarray(steps.add("the acceleration without gravity, in a regressor", a=a, g=-g + 0 * a))


def _made(steps: Steps, m: Moving, lift: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of accelerations without gravity."""
    A, W = skew(steps, m.alpha), skew(steps, m.w)
    turning = steps.add("the force of a first moment, in a regressor", **{"alpha x": A, "w x (w x)": W @ W})
    turned = {"not turned into world axes": np.eye(3) + 0 * m.R, "turned by the transposed matrix": transposed(m.R)}
    R = steps.pick("a first moment, in a regressor,", m.R, **turned)
    arms = steps.add("the moment of a first moment, in a regressor", **{"-(a - g) x": -skew(steps, lift)})
    I = steps.congruent("a unit inertia, in a regressor,", m.R[..., None, :, :], TENSORS)
    wrong = {
        "half of it": np.where(PRODUCTS, 0.5, 1.0) * I,
        "in one place of the matrix alone": m.R[..., None, :, :] @ np.triu(TENSORS) @ transposed(m.R[..., None, :, :]),
        "of the other sign": np.where(PRODUCTS, -1.0, 1.0) * I,
        **{f"another: in the order {words}": I[..., _listed(words), :, :] for words in ORDERS},
        **{f"without its place {i + 1}{j + 1}": partial(_without, m.R, i, j) for i, j in permutations(range(3), 2)},
    }  # fmt: skip
    I = steps.pick("a unit product of inertia, in a regressor,", I, **wrong)
    w, alpha = m.w[..., None, :] + 0 * I[..., 0], m.alpha[..., None, :] + 0 * I[..., 0]
    parts = {"I alpha": product(I, alpha), "w x I w": wedge(steps, w, product(I, w))}
    second = transposed(steps.add("the moment of second moments, in a regressor", **parts))
    zero = 0 * second
    forces = [lift[..., None] + zero[..., :1], turning @ R + zero[..., :3], zero]
    moments = [zero[..., :1], arms @ R + zero[..., :3], second]
    return _joined(forces), _joined(moments)


def _without(R: np.ndarray, i: int, j: int) -> np.ndarray:
    """Unit inertias whose products lack one of their two places."""
    R = R[..., None, :, :]
    return np.asarray(R @ (TENSORS * (1 - np.outer(np.eye(3)[i], np.eye(3)[j]))) @ transposed(R))


def _listed(words: str) -> list[int]:
    """Where the columns of another order are in that of `PARAMETERS`."""
    return [PARAMETERS[4:].index(f"I{name}") for name in words.split()]


def in_links(steps: Steps, m: Moving, g: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same, made in the links' axes and turned into the world's: not so if matrices are no rotations."""
    back = transposed(m.R)
    w = steps.turn("the angular velocity in a regressor", back, m.w)
    alpha = steps.turn("the angular acceleration in a regressor", back, m.alpha)
    lift = steps.turn("the acceleration without gravity, in a regressor,", back, _lift(steps, m.a, g))
    made = _made(steps, Moving(np.eye(3) + 0 * m.R, w, alpha, 0 * lift), lift)
    return _in_world(steps, m.R, made[0], "force"), _in_world(steps, m.R, made[1], "moment")


def _in_world(steps: Steps, R: np.ndarray, x: np.ndarray, words: str) -> np.ndarray:
    wrong = {"in the link's axes": x, "turned by the transposed matrix": transposed(R) @ x}
    return np.asarray(steps.pick(f"the wrench of a unit parameter: its {words}", R @ x, **wrong))


def _joined(parts: Sequence[np.ndarray]) -> np.ndarray:
    lead = np.broadcast_shapes(*(x.shape[:-1] for x in parts))
    return np.concatenate([np.broadcast_to(x, (*lead, x.shape[-1])) for x in parts], -1)


def torques(steps: Steps, J: np.ndarray, forces: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """(runs, samples, links, nv, 10), by Jacobians of the links' origins (runs, samples, links, 6, nv)."""
    J = rows_of(steps, "J^T f", J)
    Jw, Jv = transposed(J[..., :3, :]), transposed(J[..., 3:, :])
    parts = {"Jv^T f": Jv @ forces, "Jw^T n": Jw @ moments}
    return np.asarray(steps.add("the torques of a unit parameter", **parts))


def in_columns(view: View, Y: np.ndarray, links: Sequence[str]) -> np.ndarray:
    """(runs, samples, nv, parameters): those of `links`, in the subject's columns."""
    B = view.once(("the columns of a regressor", *links), lambda: _columns(view, links))
    flat = np.moveaxis(Y, -3, -2).reshape(*Y.shape[:-3], Y.shape[-2], -1)
    return np.asarray(flat @ B + _rotors(view))


def _columns(view: View, links: Sequence[str]) -> np.ndarray:
    """(ten parameters of each of these links, the subject's parameters)."""
    names = view.layout.how.parameters or parameter_names(view.robot)
    at, standing = {link: 10 * k for k, link in enumerate(links)}, view.description.carried()
    B = np.zeros((10 * len(links), len(names)))
    for k, name in enumerate(names):
        link, _, what = name.rpartition(".")
        if what not in PARAMETERS:
            continue
        if link in at:
            B[at[link] + PARAMETERS.index(what), k] = 1.0
        elif link in standing and standing[link][0] in at:
            on, _ = standing[link]
            B[at[on] : at[on] + 10, k] = carried(view.robot.frame(link).placement)[:, PARAMETERS.index(what)]
        elif link not in standing:
            raise UncoveredError(f"no link {link}")
    return B


def _rotors(view: View) -> np.ndarray:
    """Those of rotors are the accelerations of their joints."""
    names = view.layout.how.parameters or parameter_names(view.robot)
    a = view.states["a"]
    out = np.zeros((len(a), a.shape[-1], len(names)))
    joints = {j.name: j for j in view.robot}
    for k, name in enumerate(names):
        joint, _, what = name.rpartition(".")
        if what not in PARAMETERS:
            row = joints[joint].v.start
            out[:, row, k] = a[:, row]
    return out


@dataclass(frozen=True)
class Regressor:
    """(runs, samples, links, nv, 10), of the motions of Newton's and Euler's equations.

    Slips are made in `motions`, in the wrenches and torques of unit parameters (`units`), or in both.
    """

    motions: bool = False
    units: bool = False
    made: Callable[..., tuple[np.ndarray, np.ndarray]] = wrenches

    def __call__(
        self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, J: np.ndarray | None = None
    ) -> np.ndarray:  # fmt: skip
        """By Jacobians J of the links' origins, if they are told."""
        motions = world_motions.motions(steps if self.motions else Steps(), tree, q, v, a)
        return _of_motions(steps if self.units else Steps(), tree, tree.poses(q), motions, self.made, J)

    def beside(self, other: Regressor) -> Regressor | None:
        """With the slips of both."""
        joins = self.motions and other.units and not other.motions
        return replace(other, motions=True) if joins else None


def _of_motions(
    steps: Steps, tree: Tree, poses: Sequence[Pose], motions: Sequence[world_motions.Motion],
    made: Callable[..., tuple[np.ndarray, np.ndarray]], J: np.ndarray | None,
) -> np.ndarray:  # fmt: skip
    if tree.floating:
        raise UncoveredError("a fixed base only")
    every = list(range(len(tree.links)))
    w, alpha, a, z = (stacked([getattr(m, x) for m in motions], every, 1) for x in ("w", "alpha", "a", "z"))
    R, p = stacked([x.R0 for x in poses], every, 2), stacked([x.p0 for x in poses], every, 1)
    c = product(R, stacked([k.c for k in tree.links], every, 1) + 0 * R[..., 0])
    forces, moments = made(steps, Moving(R, w, alpha, a), tree.gravity[:, :, None], c)
    return torques(steps, _jacobians(steps, tree, p, c, z) if J is None else J, forces, moments)


def _jacobians(steps: Steps, tree: Tree, p: np.ndarray, c: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Of the links' origins, (runs, samples, links, 6, nv)."""
    every = range(len(tree.links))
    lead = np.broadcast_shapes(z.shape[:2], p.shape[:2], (steps.rows, 1))
    J = np.zeros((*lead, len(every), 6, tree.nv))
    for j in (j for j in tree.links if j.moves):
        on = [k.number for k in tree.links if j in tree.joints_of(k)]
        o, axis = p[:, :, j.number, None], z[:, :, j.number, None]
        ends = {"that of its centre of mass": lambda on=on: p[:, :, on] + c[:, :, on]}
        end = steps.pick("the point of a link's Jacobian, in a regressor,", p[:, :, on], **ends)
        lever = wedge(steps, axis + 0 * end, end - o)
        lever = steps.add("the moment of a force about a joint, in a regressor", **{"r x f": lever})
        turning = six(axis + 0 * lever, lever)
        slide = six(0 * lever, axis + 0 * lever)
        wrong = {"the moment along its axis": turning}
        feels = steps.pick("what a sliding joint feels, in a regressor,", slide, **wrong) if j.slides else turning
        J[:, :, on, :, j.column] = np.moveaxis(np.broadcast_to(feels, (*lead, len(on), 6)), 2, 0)
    return J
