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
from .arrays import cross
from .products import wedge
from .steps import Steps
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
    q = np.repeat(view.states["q"][None], len(view.frames), axis=1)
    w = _given(tree, view, q)
    on = [tree.stands[frame][0] for frame in view.frames]
    H = np.tile(np.stack([tree.stands[frame][1] for frame in view.frames]), (len(view.states["q"]), 1, 1))[None]
    R_on, p_on = H[..., :3, :3], H[..., :3, 3]
    out: Wrenches = {}
    for number in dict.fromkeys(on):
        here = np.array([float(k == number) for k in on])[:, None]
        at = _each(tree.poses(q)[number].p0, w)
        pushed, turned, r, place, point = (_flat(x * here) for x in (w.force, w.moment, w.p - at, w.p, w.about - at))
        others = {"that from the world's origin": place, "that of the link's origin from the world's": place - r}
        arm = steps.pick("the arm of an external force", r, **others)
        force = steps.add("the external force on a link", **{"-f_ext": -pushed})
        moments = {"-n_ext": -turned, "-r x f_ext": -wedge(steps, arm, pushed)}
        moment = steps.add("the external moment about a link's origin", **moments)
        out[number] = Push(force, moment, point, R_on, -_flat(w.six * here), p_on, w.reference)
    return q, out


def torques(tree: Tree, view: View) -> np.ndarray:
    """J^T f of each frame's wrench (runs, samples, frames, nv), with the poses of the tree."""
    if tree.right or tree.floating:
        pushed = view.compute("rnea_f_ext", view.layout.how.reference)
        return np.asarray(view.compute("rnea")[:, None] - pushed)[None]
    q = np.repeat(view.states["q"][None], len(view.frames), axis=1)
    w, poses = _given(tree, view, q), tree.poses(q)
    out = np.zeros((*w.p.shape[:-1], tree.nv))
    for f, frame in enumerate(view.frames):
        for k in tree.joints_of(tree.links[tree.stands[frame][0]]):
            z, at = (_each(x, w)[:, :, f] for x in (poses[k.number].axis(k), poses[k.number].p0))
            force = w.force[:, :, f]
            felt = force if k.slides else w.moment[:, :, f] + cross(w.p[:, :, f] - at, force)
            out[:, :, f, k.column] = (z * felt).sum(-1)
    return out


class _Given(NamedTuple):
    """Wrenches on frames (runs, samples, frames, ...): in world axes, about the frames' origins."""

    force: np.ndarray
    moment: np.ndarray
    p: np.ndarray
    about: np.ndarray
    six: np.ndarray
    reference: str


def _given(tree: Tree, view: View, q: np.ndarray) -> _Given:
    """Those of a view, at the poses of its frames in the tree; q is repeated for every frame."""
    poses, places, count = tree.poses(q), [], len(view.frames)
    for f, frame in enumerate(view.frames):
        number, H = tree.stands[frame]
        pose, some = poses[number], (slice(None), slice(f, None, count))
        R0 = np.broadcast_to(pose.R0, (len(pose.R0), q.shape[1], 3, 3))[some]
        p0 = np.broadcast_to(pose.p0, (len(pose.p0), q.shape[1], 3))[some]
        places.append((R0 @ H[:3, :3], p0 + R0 @ H[:3, 3]))
    R, p = (np.stack(np.broadcast_arrays(*(place[k] for place in places)), 2) for k in (0, 1))
    reference, about = view.layout.how.reference, p
    six = view.states["f_ext"][None, :, None] + np.zeros((*p.shape[:-1], 6))
    moment, force = six[..., :3], six[..., 3:]
    if reference == "local":
        moment, force = product(R, moment), product(R, force)
    elif reference == "world":
        about, moment = 0 * p, moment - cross(p, force)
    return _Given(force, moment, p, about, six, reference)


def _each(x: np.ndarray, w: _Given) -> np.ndarray:
    """Of a link, at the state of each wrench."""
    _, samples, frames, _ = w.p.shape
    return np.broadcast_to(x, (len(x), samples * frames, 3)).reshape(len(x), samples, frames, 3)


def _flat(x: np.ndarray) -> np.ndarray:
    """One frame after another in every state."""
    return x.reshape(len(x), -1, x.shape[-1])
