"""External wrenches on links, as the recursions take them among the forces that a link needs.

    f_k = F_k - f_ext          n_k = N_k - n_ext - r x f_ext          r from the link's origin to the frame's

References: Featherstone, Rigid Body Dynamics Algorithms (2008), equation 5.20; Siciliano et al., Robotics (2009),
section 7.5.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..case import View
from .steps import Steps, cross
from .tree import Tree


class Push(NamedTuple):
    """A wrench on a link, which the recursion adds to what the link needs, in world axes."""

    force: np.ndarray
    moment: np.ndarray
    """About the link's origin."""
    at: np.ndarray
    """Where it was given, from the link's origin."""
    R: np.ndarray
    """How the frame, at which it was given, stands on the link."""
    given: np.ndarray
    """The six-vector as it was given, with the sign of the sum."""


Wrenches = dict[int, Push]
"""Of links by number."""


def wrenches(steps: Steps, tree: Tree, view: View) -> tuple[np.ndarray, Wrenches]:
    """What they add to the forces of links, one frame after another in every state; and the positions, as often."""
    T, given = view.compute("fk"), view.states["f_ext"][:, None]
    R, p = T[..., :3, :3], T[..., :3, 3]
    f, n = given[..., 3:] + 0 * p, given[..., :3] + 0 * p
    if view.layout.how.reference == "local":
        f, n = ((R @ x[..., None])[..., 0] for x in (f, n))
    elif view.layout.how.reference == "world":
        n = n - cross(p, f)
    count = p.shape[1]
    q = np.repeat(view.states["q"][None], count, axis=1)
    on = [tree.frames[frame][0] for frame in view.frames]
    R_on = np.tile(np.stack([tree.stands[frame][1][:3, :3] for frame in view.frames]), (len(p), 1, 1))[None]
    out: Wrenches = {}
    for number in dict.fromkeys(on):
        here = np.array([float(k == number) for k in on])[:, None]
        at = tree.poses(view.states["q"][None])[number].p0[0][:, None]
        pushed, turned, r, place = ((x * here).reshape(1, -1, 3) for x in (f, n, p - at, p))
        others = {"that from the world's origin": place, "that of the link's origin from the world's": place - r}
        arm = steps.pick("the arm of an external force", r, **others)
        force = steps.add("the external force on a link", **{"-f_ext": -pushed})
        moments = {"-n_ext": -turned, "-r x f_ext": -cross(arm, pushed)}
        moment = steps.add("the external moment about a link's origin", **moments)
        six = -np.concatenate([turned, pushed], -1)
        out[number] = Push(force, moment, r, R_on, six)
    return q, out
