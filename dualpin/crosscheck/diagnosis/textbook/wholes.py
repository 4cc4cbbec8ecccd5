"""Whole poses as products of poses, and what may stand in the place of each product.

    H = H_p H_o M        of the parent, of the joint's origin on it, of the joint's motion

Codes multiply from the left, (H_p H_o) M, or make a link's own pose first, H_p (H_o M).  Slips in such a product are in
orientation and position at once; those in one of them alone are made where that is made (`Poses`).

References: Siciliano et al., Robotics (2009), section 2.7; Craig, Introduction to Robotics (2005), section 2.4.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ...subjects.layout import product, transposed
from .attitudes import Ways
from .steps import Steps
from .turns import ONE

Pose = tuple[np.ndarray, np.ndarray]
"""An attitude, in the way in which these are kept, and a position."""


def itself(T: Pose) -> Callable[[], Pose]:
    return lambda: T


def times(ways: Ways, one: Pose, other: Pose) -> Pose:
    R = ways.matrix(one[0])
    return ways.then(one[0], other[0]), one[1] + product(R, other[1] + 0 * R[..., 0])


def multiplied(
    steps: Steps, ways: Ways, site: str, one: tuple[str, Pose], other: tuple[str, Callable[[], Pose]], made: Pose,
    **further: Callable[[], Pose],
) -> Pose:  # fmt: skip
    """`made`, which is one times the other, both by name; or what may stand in its place."""
    few, (first, A), (second, B) = some(steps, ways), one, (other[0], cache(other[1]))

    def H() -> Pose:
        return few(A)

    def K() -> Pose:
        return few(B())

    wrong: dict[str, Callable[[], Pose]] = {
        "in the other order": lambda: times(ways, K(), H()), f"{first} alone": H, f"{second} alone": K,
        "taken entry by entry": lambda: (H()[0] * K()[0], H()[1] * K()[1]),
        **further,
    }  # fmt: skip
    R, p = (
        steps.pick(
            site, made[i], **{name: lambda f=f, i=i: few(f())[i] + 0 * few(made)[i] for name, f in wrong.items()}
        )
        for i in (0, 1)
    )
    return R, p


def some(steps: Steps, ways: Ways) -> Callable[[Pose], Pose]:
    """`Steps.few` of a pose; all rows where these rotations have slips of their own, which are made in all."""
    return (lambda H: (steps.few(H[0]), steps.few(H[1]))) if ways.own is None else lambda H: H


def from_parent(
    steps: Steps, ways: Ways, parent: Pose, own: Callable[[], Pose], made: Pose, of: tuple[str, str]
) -> Pose:  # fmt: skip
    """`made` of the pose of the parent and its own there; `of` says of which links, and which of these."""
    (Ap, pp), (A, p), (link, which) = parent, made, of
    few, own = some(steps, ways), cache(own)

    def local(turn: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        R, up = few((ways.matrix(Ap), pp))
        return up + product(turn(R), few(own())[1] + 0 * few(made)[1])

    def attitude(of: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Callable[[], np.ndarray]:
        return lambda: of(few(parent)[0], few(own())[0])

    positions = {
        "the parent's plus its place there, not turned": lambda: local(lambda R: ONE),
        "the parent's plus its place there, turned by the transposed matrix": lambda: local(transposed),
        "the parent's minus its place there": lambda: 2 * pp - p, "that of the parent alone": lambda: pp + 0 * p,
        "its place on the parent alone": lambda: p - pp,
    }  # fmt: skip
    attitudes = {
        "its own multiplied by the parent's from the right": attitude(lambda up, own: ways.then(own, up)),
        "its own on the parent alone": lambda: own()[0] + 0 * A, "that of the parent alone": Ap,
        "that of the parent, transposed, times its own": attitude(lambda up, own: ways.then(ways.inverse(up), own)),
        "that of the parent and its own, multiplied entry by entry": attitude(lambda up, own: up * own),
    }  # fmt: skip
    sites = {
        "a link": ("the orientation of a link", "the position of a link"),
        "a fixed link": ("the orientation of a fixed link", "the position of a fixed link"),
    }  # fmt: skip
    by_kind = "the orientation of a link on a joint", "the position of a link on a joint"
    orientation, position = sites.get(link, by_kind)
    A = steps.pick(f"{orientation}: {which}", A, **attitudes)
    p = np.asarray(steps.pick(f"{position}: {which}", p, **positions))
    site = f"the product of the parent's pose and that of {link} on it: {which}"
    return multiplied(steps, ways, site, ("the parent's", (Ap, pp)), ("its own", own), (A, p))
