"""External wrenches on links, as the recursions take them among the forces that a link needs.

    f_k = F_k - f_ext          n_k = N_k - n_ext - r x f_ext          r from the link's origin to the frame's

References: Featherstone, Rigid Body Dynamics Algorithms (2008), equation 5.20; Siciliano et al., Robotics (2009),
section 7.5.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .products import wedge
from .steps import Steps, cross
from .tree import Pose, Tree


class Push(NamedTuple):
    """A wrench on a link, which the recursion adds to what the link needs, in world axes."""

    force: np.ndarray
    moment: np.ndarray
    """About the link's origin."""
    at: np.ndarray
    """The point about which it was given, from the link's origin."""
    R: np.ndarray
    """How the frame, at which it was given, stands on the link."""
    given: np.ndarray
    """The six-vector as it was given, with the sign of the sum."""
    place: np.ndarray
    """Where the frame stands on the link, in its axes."""
    reference: str
    """In which axes, and about which point, it was given."""

    def on(self, pose: Pose) -> np.ndarray:
        """The point about which it was given, in the link's axes."""
        return product(transposed(pose.R0), self.at)


Wrenches = dict[int, Push]
"""Of links by number."""


def wrenches(steps: Steps, tree: Tree, view: View) -> tuple[np.ndarray, Wrenches]:
    """What they add to the forces of links, one frame after another in every state; and the positions, as often."""
    T, given = view.compute("fk"), view.states["f_ext"][:, None]
    R, p = T[..., :3, :3], T[..., :3, 3]
    about, reference, six = p, view.layout.how.reference, given + np.zeros((*p.shape[:-1], 6))
    f, n = six[..., 3:], six[..., :3]
    if reference == "local":
        f, n = ((R @ x[..., None])[..., 0] for x in (f, n))
    elif reference == "world":
        about, n = 0 * p, n - cross(p, f)
    count = p.shape[1]
    q = np.repeat(view.states["q"][None], count, axis=1)
    on = [tree.frames[frame][0] for frame in view.frames]
    H = np.tile(np.stack([tree.stands[frame][1] for frame in view.frames]), (len(p), 1, 1))[None]
    R_on, p_on = H[..., :3, :3], H[..., :3, 3]
    out: Wrenches = {}
    for number in dict.fromkeys(on):
        here = np.array([float(k == number) for k in on])[:, None]
        at = tree.poses(view.states["q"][None])[number].p0[0][:, None]
        pushed, turned, r, place, point = ((x * here).reshape(1, -1, 3) for x in (f, n, p - at, p, about - at))
        others = {"that from the world's origin": place, "that of the link's origin from the world's": place - r}
        arm = steps.pick("the arm of an external force", r, **others)
        force = steps.add("the external force on a link", **{"-f_ext": -pushed})
        moments = {"-n_ext": -turned, "-r x f_ext": -wedge(steps, arm, pushed)}
        moment = steps.add("the external moment about a link's origin", **moments)
        given_here = -(six * here).reshape(1, -1, 6)
        out[number] = Push(force, moment, point, R_on, given_here, p_on, reference)
    return q, out
