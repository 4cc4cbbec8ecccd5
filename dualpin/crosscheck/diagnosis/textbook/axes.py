"""Where links stand on bodies, the directions in which joints move, and their columns in a Jacobian."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .arrays import cross
from .references import six
from .steps import Steps


@dataclass
class Placed:
    """Where a link is fixed on a body: its number, and the orientation and position there."""

    body: int
    A: np.ndarray
    p: np.ndarray


@dataclass
class Axis:
    """One direction in which a joint moves: about it, or along it."""

    link: int
    parent: int
    turns: bool
    direction: np.ndarray
    """In the axes of the link."""
    column: int
    """In v."""
    ratio: float = 1.0
    follows: bool = False
    base: bool = False
    world: np.ndarray | None = None
    """The direction in the world, where it was kept when the link was placed."""


def of_kind(steps: Steps, which: str, turns: np.ndarray, made: tuple[np.ndarray, ...]) -> np.ndarray:
    """(..., axes, 6): the column of an axis, by whether it `turns`, made of z, z x r, z, r, and a point o of it."""
    angular, lever, z, r, o = made
    zero = np.zeros_like(lever)

    def of(w: np.ndarray, v: np.ndarray) -> Callable[[], np.ndarray]:
        return lambda: six(steps.few(w), steps.few(v))

    column = steps.pick(
        f"the column of a turning axis: {which}", six(angular, lever),
        **{"[0; z x r], without z": of(zero, lever), "[0; z], as of a sliding one": of(zero, z),
           "[z; z]": of(z, z), "[z x r; z]": of(lever, z)},
    )  # fmt: skip
    slide = six(zero, z)
    if not turns.all():
        across = cross(z, r)
        slide = steps.pick(
            f"the column of a sliding axis: {which}", slide,
            **{"[z; z x r], as of a turning one": of(z, across), "[z; z]": of(z, z), "zero": of(zero, zero),
               "[0; z x r]": of(zero, across), "[z; 0]": of(z, zero), "[0; -z]": of(zero, -z),
               "[0; z + o], as if the axis were a point of the link": of(zero, z + o),
               "[0; z + z x r]": of(zero, z + across), "[0; r]": of(zero, r + zero)},
        )  # fmt: skip
    return np.asarray(turns * column + (1 - turns) * slide)


def exchanged(
    steps: Steps, z: np.ndarray, r: np.ndarray, lever: np.ndarray, in_world: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Angular and linear part of the base's turning columns, with two of its axes exchanged."""
    angular, linear = {}, {}
    for a, b in ((0, 1), (0, 2), (1, 2)):
        to = [0, 1, 2]
        to[a], to[b] = b, a
        # where the base's velocity is in world axes, the columns are those of the world's
        y = z[..., to] if in_world else z[..., [*to, *range(3, z.shape[-2])], :]
        other = cross(y, r)
        for rows, x, u in (("angular rows", y, lever), ("linear rows", z, other), ("all rows", y, other)):
            name = f"exchanged, {'xyz'[a]} with {'xyz'[b]}, in {rows}"
            angular[name], linear[name] = x, u
    site = "the base's turning columns"
    return steps.pick(site, z, **angular), steps.pick(site, lever, **linear)


def moved(group: list[int], x: np.ndarray, to: np.ndarray, z: float | None = 1.0) -> np.ndarray:
    """Of every axis, what another axis has; where there is none, the world's z or origin, or its own."""
    out = x.copy()
    if z is not None:
        out[:] = (0.0, 0.0, z)
    for k, i in enumerate(group):
        if to[i] in group:
            out[..., k, :] = x[..., group.index(to[i]), :]
    return out
