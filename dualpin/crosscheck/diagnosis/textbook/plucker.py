"""Six-vectors: transforms, the axes of joints, inertias and cross products, in the coordinates that a code chooses.

    links:    every link in its own axes, about its origin
    centres:  in its own axes, about its centre of mass: I = diag(I_c, m 1), S = [z; z x c]
    world:    all in world axes, about the world's origin: X = 1, S = [z; p x z], I = X_0^T I X_0,
              or [R I R^T + m [c x] [c x]^T, m [c x]; m [c x]^T, m 1]

Six-vectors are [angular; linear], X = [E 0; -E [r x]  E] brings motions from the parent's coordinates into the link's.

References: Featherstone, Rigid Body Dynamics Algorithms (2008), equations 2.24, 2.31 and 2.63; Lynch and Park, Modern
Robotics (2017), section 8.3; Featherstone (2008), section 2.10, for world coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from .arrays import cross, inverse
from .lumps import Piece, tensor
from .products import skew, wedge
from .pushes import Push
from .steps import STANDING, Steps
from .tree import Link, Pose, Tree, spatial, standing_otherwise, turned_otherwise


@dataclass
class Model:
    """A robot in six-vectors, in the coordinates of a code."""

    X: Sequence[np.ndarray | None]
    """Of every link, from its parent's coordinates, where these are others; of the root, from those of the world."""
    S: dict[int, np.ndarray]
    """Of links that move."""
    I: list[np.ndarray]
    base: np.ndarray | None = None
    """The columns of a floating base's velocity, where these are not its own coordinates."""
    to_frame: Callable[[Steps, Link, Pose, Push], np.ndarray] = lambda steps, _, pose, push: to_frame(
        steps, pose, push.on(pose), push.R, push.reference == "local"
    )
    """X from the coordinates of a link to those in which a wrench on it is given."""
    others: Mapping[int, Mapping[str, np.ndarray]] = field(default_factory=dict)
    """Of links that move: axes that are mistaken for S, by name."""

    def axis(self, steps: Steps, k: Link, where: str) -> np.ndarray:
        """S of a link, as it is used there."""
        return np.asarray(
            steps.pick(f"the axis of a joint, {where},", self.S[k.number], **self.others.get(k.number, {}))
        )

    @property
    def common(self) -> bool:
        """Whether all links have the same coordinates, so that what the parent has may be taken as it is."""
        return all(X is None for X in self.X)


Coordinates = Callable[[Steps, Tree, np.ndarray], Model]


def links(steps: Steps, tree: Tree, q: np.ndarray) -> Model:
    """Every link in its own axes."""
    return _of(steps, tree, q, [inertia(steps, k) for k in tree.links])


def merged_links(steps: Steps, tree: Tree, q: np.ndarray) -> Model:
    """The same, with the inertia of bodies that several links make merged in six-vectors: sum X^T I X."""
    return _of(steps, tree, q, [_merged(steps, k) for k in tree.links])


def _of(steps: Steps, tree: Tree, q: np.ndarray, I: list[np.ndarray]) -> Model:
    S = {k.number: subspace(steps, k) for k in tree.links if k.moves}
    return Model(transforms(steps, tree, tree.poses(q)), S, I)


def centres(steps: Steps, tree: Tree, q: np.ndarray) -> Model:
    """Every link but the root about its centre of mass, in its own axes."""
    X, poses = [], tree.poses(q)
    for k in tree.links:
        pose, c = poses[k.number], k.c if k.number else 0 * k.c
        c_up = tree.links[k.parent].c if k.parent > 0 else 0 * c
        terms = {"p": pose.p, "R c": product(pose.R, c), "-c of the parent": -c_up}
        place = steps.add("the place of a link's frame, at its centre, on that of its parent", **terms)
        X.append(transform(steps, pose.R, place, "of joints"))
    S = {k.number: _about_centre(steps, k) for k in tree.links if k.moves}
    I = [inertia(steps, tree.links[0]), *(at_centre(steps, k) for k in tree.links[1:])]

    def framed(steps: Steps, k: Link, pose: Pose, push: Push) -> np.ndarray:
        R = push.R if push.reference == "local" else transposed(pose.R0)
        return transform(steps, R, push.on(pose) - (k.c if k.number else 0 * k.c))

    return Model(X, S, I, to_frame=framed)


def world(steps: Steps, tree: Tree, q: np.ndarray) -> Model:
    """All about the world's origin, in its axes."""
    poses = tree.poses(q)
    whole = [transform(steps, pose.R0, pose.p0, "of links in the world") for pose in poses]
    I = [
        steps.congruent("a body's inertia, X^T I X, in the world", transposed(X), inertia(steps, k))
        for k, X in zip(tree.links, whole, strict=True)
    ]
    return _about_world(steps, tree, poses, I)


def world_blocks(steps: Steps, tree: Tree, q: np.ndarray) -> Model:
    """The same, with inertias put together there: of R I R^T, and of the place of the centre in the world."""
    poses = tree.poses(q)
    return _about_world(steps, tree, poses, [_placed(steps, k, poses) for k in tree.links])


def _about_world(steps: Steps, tree: Tree, poses: Sequence[Pose], I: list[np.ndarray]) -> Model:
    S = {k.number: _in_world(steps, k, poses) for k in tree.links if k.moves}
    base = inverse(transform(Steps(), poses[0].R0, poses[0].p0)) if tree.floating else None

    def framed(steps: Steps, k: Link, pose: Pose, push: Push) -> np.ndarray:
        R = pose.R0 @ push.R if push.reference == "local" else np.eye(3)[None, None]
        return transform(steps, R, pose.p0 + push.at)

    return Model([None for _ in tree.links], S, I, base, framed)


# --- transforms ----------------------------------------------------------------------------------


def transforms(steps: Steps, tree: Tree, poses: Sequence[Pose]) -> list[np.ndarray]:
    """X of every link, from the parent's axes into its own."""
    return [
        transform(steps, pose.R, pose.p, "of joints", partial(_exchanged, k, pose))
        for k, pose in zip(tree.links, poses, strict=True)
    ]


def transform(
    steps: Steps, R: np.ndarray, p: np.ndarray, which: str = "of frames", both: Callable[[], np.ndarray] | None = None
) -> np.ndarray:
    """X to what stands at R, p; `both` is the lower block where it is that of two such matrices."""
    E, r = steps.pick(f"E of X: {which}", transposed(R), **{"R itself, not transposed": R}), skew(steps, p)
    makers: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]] = {
        "E [r x], with the other sign": lambda E, r, p: E @ r, "-[r x] E, in the other order": lambda E, r, p: -r @ E,
        "left out": lambda E, r, p: 0 * (E @ r), "-[r x], without E": lambda E, r, p: -r + 0 * E,
        "[r x], without -E": lambda E, r, p: r + 0 * E, "-E^T [r x]": lambda E, r, p: -transposed(E) @ r,
        "-E [r x] with the two multiplied entry by entry": lambda E, r, p: -E * r,
        "-[r x] E, in the other order, of the joint's motion and of its placement": lambda E, r, p: -r @ E,
        "R [p x] for [p x] R, of the inverse pose R, p": lambda E, r, p: -E @ _inverse(E, p),
        "[p x] without R, of the inverse pose R, p": lambda E, r, p: -_inverse(E, p),
        "[p x] R with the two multiplied entry by entry, of the inverse pose R, p": lambda E, r, p: -_inverse(E, p) * E,
    }  # fmt: skip

    def of(f: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]) -> Callable[[], np.ndarray]:
        return lambda: f(steps.few(E), steps.few(r), steps.few(p))

    wrong = {name: of(f) for name, f in makers.items()}
    if both:
        wrong["-[r x] E, in the other order, of the joint's motion and of its placement"] = both
    lower = steps.pick(f"the block -E [r x] of X: {which}", -E @ r, **wrong)
    lead = np.broadcast_shapes(E.shape, lower.shape)
    E, lower = np.broadcast_to(E, lead), np.broadcast_to(lower, lead)
    return spatial([[E, 0 * E], [lower, E]])


def _inverse(E: np.ndarray, p: np.ndarray) -> np.ndarray:
    """[E p x]: the inverse pose stands at -E p."""
    return cross_matrix(product(E, p))


def to_frame(steps: Steps, pose: Pose, r: np.ndarray, R: np.ndarray, local: bool = False) -> np.ndarray:
    """From the axes of a body to a frame that stands on it at r and R, in world axes or (`local`) in its own."""
    if local:
        return transform(steps, R, r)
    turn = pose.R0 @ R
    return spatial([[turn, 0 * turn], [0 * turn, turn]]) @ transform(steps, R, r)


def _exchanged(k: Link, pose: Pose) -> np.ndarray:
    """The lower block of X_J X_T where both have -[r x] E there."""
    back = transposed(k.R)
    E_J, E_T = transposed(back @ pose.R), back
    r_J, r_T = cross_matrix(product(back, pose.p - k.p)), cross_matrix(k.p)
    return np.asarray(-r_J @ E_J @ E_T - E_J @ r_T @ E_T)


def of_others(tree: Tree, m: Model, k: Link) -> dict[str, np.ndarray]:
    """X of other links, by what they do in the place of a link's own."""
    others = {"by X of its parent": k.parent, "by X of the next link in the list": (k.number + 1) % len(tree.links)}
    mine = m.X[k.number]
    found = {what: m.X[i] for what, i in others.items() if i >= 0}
    return {
        what: X for what, X in found.items() if X is not None and mine is not None and X.shape[-2:] == mine.shape[-2:]
    }


def brought(
    steps: Steps, site: str, X: np.ndarray | None, m: np.ndarray, plain: bool = False,
    beside: Mapping[str, np.ndarray] | None = None,
) -> np.ndarray:  # fmt: skip
    """X m, with what may stand in the place of X: also X of others `beside`; if `plain`, nothing but its transpose."""
    if X is None:
        return m
    others: dict[str, Callable[[], Any]] = {
        "by the inverse": lambda: inverse(steps.few(X)),
        "as a force, by X^-T": lambda: transposed(inverse(steps.few(X))),
        **{what: partial(steps.few, Y) for what, Y in (beside or {}).items()},
    }
    return np.asarray(steps.turn(site, X, m, **({} if plain else others)))


def to_parent(
    steps: Steps, site: str, X: np.ndarray | None, f: np.ndarray, beside: Mapping[str, np.ndarray] | None = None
) -> np.ndarray:  # fmt: skip
    """X^T f, with what may stand in the place of X^T: also that of others `beside`."""
    if X is None:
        return f
    others: dict[str, Callable[[], Any]] = {
        "by the inverse of X, as a motion": lambda: inverse(steps.few(X)),
        "by X^-T, the inverse of what is right": lambda: transposed(inverse(steps.few(X))),
        **{what: partial(steps.few, transposed(Y)) for what, Y in (beside or {}).items()},
    }
    return np.asarray(steps.turn(site, transposed(X), f, **others))


def to_parent_inertia(steps: Steps, site: str, X: np.ndarray | None, I: np.ndarray) -> np.ndarray:
    """X^T I X."""
    return I if X is None else np.asarray(steps.congruent(site, transposed(X), I))


# --- axes of joints ------------------------------------------------------------------------------


def subspace(steps: Steps, k: Link) -> np.ndarray:
    """S: [z; 0] of a turning joint, [0; z] of a sliding one."""
    return _subspace(steps, k, *_six(k.z, 0 * k.z))


def _six(angular: np.ndarray, linear: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of a joint that turns, and the same that slides along its axis."""
    z, r = np.broadcast_arrays(angular, linear)
    return np.concatenate([z, r], -1), np.concatenate([0 * z, z], -1)


def _subspace(steps: Steps, k: Link, turning: np.ndarray, sliding: np.ndarray, **wrong: Any) -> np.ndarray:
    if k.slides:
        others = {"[z; 0], as of a turning one": turning, "[z; z]": turning + sliding, "-[0; z]": -sliding}
        return np.asarray(steps.pick("S of a sliding joint", sliding, **others))
    others = {"[0; z], as of a sliding one": sliding, "[z; z]": turning + sliding, "-[z; 0]": -turning}
    return np.asarray(steps.pick(f"S of a turning joint: of {k.type} joints", turning, **others, **wrong))


def _about_centre(steps: Steps, k: Link) -> np.ndarray:
    """About the link's centre of mass, at c from the axis."""
    turning, sliding = _six(k.z, cross(k.z, k.c))
    wrong = {
        "[z; c x z], with the other sign": _six(k.z, cross(k.c, k.z))[0],
        "[z; 0], as if the axis passed through the frame's origin": _six(k.z, 0 * k.z)[0],
    }
    return _subspace(steps, k, turning, sliding, **wrong)


def _in_world(steps: Steps, k: Link, poses: Sequence[Pose]) -> np.ndarray:
    pose, on = poses[k.number], poses[k.parent]
    other = {"by the parent's matrix, without the joint's own placement": lambda: on.R0}
    kind = "of sliding links" if k.slides else "of turning links"
    z = steps.turn(f"the joint's axis: {kind}", pose.turns_axis, k.z, **other)
    turning, sliding = _six(z, wedge(steps, pose.p0, z))
    at_centre = pose.p0 + product(pose.R0, k.c)
    wrong = {
        "[z; z x p], with the other sign": _six(z, cross(z, pose.p0))[0], "[z; 0], without p x z": _six(z, 0 * z)[0],
        "[z; p x z] with the origin of its parent": _six(z, cross(on.p0, z))[0],
        "[z; p x z] with its centre of mass": _six(z, cross(at_centre, z))[0],
    }  # fmt: skip
    return _subspace(steps, k, turning, sliding, **wrong)


# --- inertias ------------------------------------------------------------------------------------


def inertia(steps: Steps, k: Link) -> np.ndarray:
    """The spatial inertia about the link's origin."""
    return of_body(steps, k.mass, k.c, k.tensor(steps))


def of_body(steps: Steps, mass: float, c: np.ndarray, I: np.ndarray) -> np.ndarray:
    """The spatial inertia of a mass, about a point from which its centre is at c."""
    c = steps.components("the centre of mass of a body, in its link's axes,", c)
    return _blocks(steps, mass, c, I, "a link's origin")


def _placed(steps: Steps, k: Link, poses: list[Pose]) -> np.ndarray:
    """The spatial inertia about the world's origin, in its axes."""
    pose = poses[k.number]
    local = steps.components("the centre of mass of a body, in its link's axes,", k.c)
    arm = steps.turn("the centre of mass of a body", pose.R0, local, **turned_otherwise(poses, k))
    c = steps.add("the place of a body's centre", **{"the link's origin": pose.p0, "R c": arm})
    standing = steps.pick(STANDING, pose.R0, **standing_otherwise(poses, k))
    I = steps.congruent("the inertia of a body", standing, k.tensor(steps))
    return _blocks(steps, k.mass, c, I, "the world's origin")


def _blocks(steps: Steps, mass: float, c: np.ndarray, I: np.ndarray, about: str) -> np.ndarray:
    """[I + m [c x] [c x]^T, m [c x]; m [c x]^T, m 1]."""
    K, one = skew(steps, c), np.eye(3)[None, None]
    square, right = K @ transposed(K), c[..., :, None] * c[..., None, :]
    wrong = {
        "without the mass": square, "m c.c 1, without c c^T": mass * (square + right), "-m c c^T, without c.c 1":
        -mass * right, "m [c x] [c x]^T with the two multiplied entry by entry": mass * K * transposed(K),
    }  # fmt: skip
    arms = steps.pick("m (c.c 1 - c c^T) in a spatial inertia", mass * square, **wrong)
    first = steps.add(f"the inertia about {about}", **{"I of the centre": I, "m (c.c 1 - c c^T)": arms})
    upper, lower = (
        steps.pick(
            f"the block m [c x] of the inertia: {which}", mass * x,
            **{"of the other sign, which is its transpose": -mass * x, "left out": 0 * x, "without the mass": x},
        )
        for which, x in (("the upper right one", K), ("the lower left one", transposed(K)))
    )  # fmt: skip
    last = steps.pick("the block m 1 of the inertia", mass * one, **_masses(mass))
    return spatial([[first, upper], [lower, last]])


def _masses(mass: float) -> dict[str, np.ndarray]:
    """What may stand in the place of m 1."""
    one = np.eye(3)[None, None]
    return {"1, without the mass": one, "left out": 0 * one, "m in every entry": mass * np.ones_like(one)}


def at_centre(steps: Steps, k: Link, I: np.ndarray | None = None) -> np.ndarray:
    """The spatial inertia about the centre of mass; I is the tensor there, by default in the link's axes."""
    one = np.eye(3)[None, None]
    if I is None:
        wrong = {"that about the link's origin": k.about_origin}
        I = steps.pick("the inertia about the centre of mass", k.tensor(steps), **wrong)
    last = steps.pick("the block m 1 of the inertia", k.mass * one, **_masses(k.mass))
    G = spatial([[I, 0 * I], [0 * I, last]])
    whole = {"that about the link's origin, with m [c x]": lambda: inertia(Steps(), k)}
    return np.asarray(steps.pick("the spatial inertia, about the centre of mass,", G, **whole))


def _merged(steps: Steps, k: Link) -> np.ndarray:
    """The links that make a body, each about its own origin first; X leads from the body to them."""
    total: np.ndarray = np.zeros((1, 1, 6, 6))
    for p in k.pieces:
        alone = Piece(p.mass, p.com, p.R, p.J, np.eye(3), np.zeros(3))
        I = of_body(steps, p.mass, p.com[None, None], tensor(steps, alone))
        if p.fixed:
            X = transform(steps, p.Q[None, None], p.p[None, None], "in merging")
            I = steps.congruent("a fixed link's spatial inertia, X^T I X,", transposed(X), I)
        total = total + I
    return total
