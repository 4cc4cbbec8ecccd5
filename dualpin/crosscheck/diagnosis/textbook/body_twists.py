"""Coordinates of bodies' own frames, by exponentials of their screws: those of recursions in body twists.

    A = Ad(M^-1) S                          the screw of a joint in the frame of its body, M that frame's pose at home
    T = exp(-A q) M^-1 M_p,   X = Ad(T)     from the parent's frame into the body's
    V = X V_p + A qd      F = X_c^T F_c + G dV/dt - ad_V^T G V      tau = F^T A

The frames stand at centres of mass, where G = diag(I, m 1), or at the links' origins.

References: Lynch and Park, Modern Robotics (2017), section 8.3; Park, Bobrow and Ploen, A Lie group formulation of
robot dynamics, International Journal of Robotics Research 14 (1995).
"""

from __future__ import annotations

from enum import Enum
from functools import partial

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from .attitudes import PLAIN
from .lumps import tensor
from .plucker import Model, at_centre, inertia
from .pushes import Push
from .screws import adjoint, at_home, exponential, exponentials, inverted, products, screw, standing
from .steiner import outer, square
from .steps import Steps
from .tree import Link, Tree
from .tree import Pose as OnParent
from .turns import ONE
from .wholes import Pose, itself, multiplied, times


class Frames(Enum):
    """Where the frames of bodies stand at home."""

    AT_LINKS = "frames of links"
    AT_CENTRES = "at centres of mass, in links' axes"
    IN_BASE = "at centres of mass, in the base's axes"


def bodies(steps: Steps, tree: Tree, q: np.ndarray, frames: Frames = Frames.AT_CENTRES) -> Model:
    """Every body in its own frame."""
    home = at_home(steps, tree)
    M = [frame_at_home(steps, k, home[k.number], frames) for k in tree.links]
    X, S, space = [np.eye(6)[None, None]], dict[int, np.ndarray](), dict[int, np.ndarray]()
    for k in tree.links[1:]:
        back, up = inverted(steps, M[k.number]), _parent(steps, tree, k, M)
        site = "the pose of the parent's frame in that of the body, at home,"
        turned = {"the inverse, M_p^-1 M": partial(_from, up, M[k.number])}
        made = times(PLAIN, back, up)
        T = multiplied(steps, PLAIN, site, ("M^-1", back), ("M_p", itself(up)), made, **turned)
        if k.moves:
            space[k.number] = screw(steps, k, home)
            S[k.number] = in_body(steps, k, M, space[k.number], back)
            T = _moved(steps, S[k.number], T, q[..., k.place])
        X.append(adjoint(steps, *T))
    I = [inertia(steps, tree.links[0]), *(spatial_inertia(steps, k, home[k.number], frames) for k in tree.links[1:])]

    def framed(steps: Steps, k: Link, _: OnParent, push: Push) -> np.ndarray:
        """Of frames that stand at M_f at home: M_f^-1 M, or T M about the world's origin, or about the frame's."""
        at = times(PLAIN, home[k.number], (push.R, push.place))
        if push.reference == "local":
            back, on = inverted(steps, at), M[k.number]
            site, right = "the pose of a body in the frame of the wrench on it, M_f^-1 M,", times(PLAIN, back, on)
            turned = {"the inverse, M^-1 M_f": partial(_from, on, at)}
            T = multiplied(steps, PLAIN, site, ("M_f^-1", back), ("M", itself(on)), right, **turned)
            return adjoint(steps, *T)
        made = products(steps, tree, exponentials(steps, tree, space, q), "in poses")
        A, p = standing(steps, tree, k.number, made, M[k.number], "of bodies")
        if push.reference != "world":
            p = p - standing(steps, tree, k.number, made, at, "of frames")[1]
        return adjoint(steps, A, p)

    others = {number: {"the screw S of the space frame": x} for number, x in space.items()}
    return Model(X, S, I, to_frame=framed, others=others)


def frame_at_home(steps: Steps, k: Link, home: Pose, frames: Frames) -> Pose:
    """M of a body's frame; the root's is its link's."""
    R, p = home
    if frames is Frames.AT_LINKS or not k.number:
        return home
    c = steps.turn("the centre of mass in the pose of a body's frame at home", R, k.c + 0 * p)
    p = steps.add("the place of a body's frame at home", **{"the link's place": p, "R c": c})
    return (ONE[None, None] if frames is Frames.IN_BASE else R), p


def spatial_inertia(steps: Steps, k: Link, home: Pose, frames: Frames) -> np.ndarray:
    """G of a body, in its frame."""
    if frames is Frames.AT_LINKS:
        return inertia(steps, k)
    return at_centre(steps, k, _in_base(steps, k, home) if frames is Frames.IN_BASE else None)


def _in_base(steps: Steps, k: Link, home: Pose) -> np.ndarray:
    """The tensor about the centre of mass, in the base's axes at home, of those of the links that make the body."""
    R, p = home

    def turned(steps: Steps) -> np.ndarray:
        alone = ((x.Q @ x.R, tensor(steps, x._replace(Q=ONE, p=np.zeros(3), R=ONE))) for x in k.pieces)
        parts = (steps.congruent("a link's tensor, in the base's axes at home,", R @ Q, I) for Q, I in alone)
        return sum(parts, np.zeros((1, 1, 3, 3)))

    right = R @ k.I @ transposed(R)
    I = right + turned(steps) - turned(Steps())
    if len(k.pieces) > 1:
        arms = ((x.mass, product(R, x.Q @ x.com + x.p - k.c)) for x in k.pieces)
        I = I + sum(m * (_steiner(steps, d) - _steiner(Steps(), d)) for m, d in arms)
    c = p + product(R, k.c + 0 * p)
    far = {"that about the base's origin": lambda: right + k.mass * (cross_matrix(c) @ transposed(cross_matrix(c)))}
    return np.asarray(steps.pick("the inertia about the centre of mass", I, **far))


def _steiner(steps: Steps, d: np.ndarray) -> np.ndarray:
    """d.d 1 - d d^T, in the base's axes."""
    where = ", in the base's axes,"
    return square(steps, d, where) - outer(steps, d, where)


def _parent(steps: Steps, tree: Tree, k: Link, M: list[Pose]) -> Pose:
    """M of the parent's frame."""
    site = "the motion that a link starts from: the pose of its frame at home"

    def of(link: Link) -> Pose:
        return M[link.number if link.number < k.number else k.parent]

    A, p = M[k.parent]
    As, ps = tree.near(k, lambda link: of(link)[0]), tree.near(k, lambda link: of(link)[1])
    return steps.pick(site, A, **As), steps.pick(site, p, **ps)


def _from(T: Pose, M: Pose) -> Pose:
    """T^-1 M."""
    return times(PLAIN, inverted(Steps(), T), M)


def in_body(steps: Steps, k: Link, M: list[Pose], S: np.ndarray, back: Pose) -> np.ndarray:
    """A = Ad(M^-1) S."""
    others = {
        "by Ad(M), with M not inverted": lambda: adjoint(Steps(), *M[k.number]),
        "by that of its parent's frame": lambda: adjoint(Steps(), *inverted(Steps(), M[k.parent])),
        "as a force, by Ad(M)^T": lambda: transposed(adjoint(Steps(), *M[k.number])),
    }  # fmt: skip
    site = "the screw of a joint, in the frame of its body"
    return np.asarray(steps.turn(site, adjoint(steps, *back), S, **others))


def _moved(steps: Steps, A: np.ndarray, home: Pose, q: np.ndarray) -> Pose:
    """exp(-A q) M^-1 M_p."""
    x = steps.pick("-q in exp(-A q) of the recursion", -q, **{"q, with the other sign": q})
    E = exponential(steps, A, x)
    site = "the pose of the parent's frame in that of the body, exp(-A q) M^-1 M_p,"
    made = times(PLAIN, E, home)
    return multiplied(steps, PLAIN, site, ("exp(-A q)", E), ("M^-1 M_p", lambda: home), made)
