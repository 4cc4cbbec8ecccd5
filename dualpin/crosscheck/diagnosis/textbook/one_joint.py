"""Derivatives of columns by the position of one joint: their rates where it alone moves, with unit velocity.

    w_i = z_k,  v_i = z_k x (p_i - p_k)       of what a turning joint k moves
    w_i = 0,    v_i = z_k                     of what a sliding joint k moves

References: Siciliano et al., Robotics (2009), section 3.1.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np

from .columns import Columns
from .poses import stacked
from .products import wedge
from .references import six


def rates(
    cols: Columns, points: np.ndarray, links: Sequence[int], whose: str = "a frame", apart: bool = False
) -> list[np.ndarray]:  # fmt: skip
    """For every axis: the rates (runs, n, points, 6, axes) where it alone moves, with unit velocity.

    `apart` says that the motions of other axes and origins are made of axes and arms, not of these Jacobians.
    """
    ends = cols.carried(cols.at(points, links, whose))[..., 3:, :]
    if not apart:
        every = list(range(len(cols.poses.p)))
        J = cols.carried(cols.at(stacked(cols.poses.p, every, 1), every))
    out = []
    for m in range(len(cols.axes)):
        here = copy(cols)
        w, v = _carried_by(cols, m) if apart else (J[..., :3, m], J[..., 3:, m])
        here.w, here.v = (list(np.moveaxis(x, 2, 0)) for x in (w, v))
        felt = cols.moving(links)[..., m, None]  # a joint off the path moves nothing
        out.append(felt * Columns.rates(here, points, ends[..., m], links, whose))
    return out


def _carried_by(cols: Columns, m: int) -> tuple[np.ndarray, np.ndarray]:
    """w of all links, and the velocities of their origins (runs, n, links, 3), where joint m moves alone."""
    steps, t, number = cols.steps, cols.poses, cols.links[m]
    p, carries, turns = stacked(t.p, list(range(len(t.p))), 1), t.carries(), cols.turns[m] > 0
    o, z = (x[..., m, None, :] + 0 * p for x in (cols.o, cols.z))
    moved = carries[:, m]
    earlier = np.array([k != number and bool(carries[number, some].any()) for k, some in enumerate(t.of_link)])
    right, of_earlier, of_both = (y.astype(float)[:, None] for y in (moved, earlier, moved | earlier))
    behind = right * (np.arange(len(t.p)) != number)[:, None]
    arms = {"p_i alone": behind * p, "-p_k alone": -behind * o, "p_i + p_k": behind * (p + o)}
    arm = steps.pick("the arm p_i - p_k in derivatives of columns", p - o, **arms)
    terms = {"z_k x (p_i - p_k)": wedge(steps, z + 0 * arm, arm)}
    v = steps.add("the derivative of an origin by a turning joint", **terms)
    z = z + 0 * v
    turning, sliding = six(z, v), six(0 * z, z)
    wrong = {
        f"that by a {'sliding' if turns else 'turning'} one": sliding if turns else turning, "zero": 0 * turning,
        "that of origins alone": six(0 * z, v) if turns else sliding,
    } | ({"[z_k; z_k], that of origins as by a sliding one": six(z, z)} if turns else {})  # fmt: skip
    site = f"the derivative of axes and origins by a {'turning' if turns else 'sliding'} joint"
    x = steps.pick(site, turning if turns else sliding, **wrong)
    masks = {"those before it": of_earlier[None, None], "all those of a path": of_both[None, None]}
    moved_axes, moved_origins = (
        steps.pick(f"what a joint moves in derivatives of columns: {what}", right[None, None], **masks)
        for what in ("axes", "origins")
    )
    return x[..., :3] * moved_axes, x[..., 3:] * moved_origins
