"""Screws at home, their exponentials, and adjoints: what codes are made of that multiply exponentials.

    M_k = M_p H_k                    the pose of link k at home
    S = [w; -w x p] of a turning joint, [0; w] of a sliding one, at home
    exp(S q) = (R, G v):   R = 1 + sin q [w] + (1 - cos q) [w]^2,   G = q 1 + (1 - cos q) [w] + (q - sin q) [w]^2
    Ad(T) = [R 0; [p x] R  R]        T^-1 = (R^T, -R^T p)

Six-vectors are [angular; linear] of the point at the world's origin.  Arrays have the axes (runs, samples, ...).

References: Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation (1994), sections 2.3 and 2.4;
Lynch and Park, Modern Robotics (2017), sections 3.3 and 4.1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from ...subjects.layout import product, transposed
from .arrays import cross
from .attitudes import PLAIN
from .products import skew
from .references import joined
from .steps import Steps
from .tree import Link, Tree, spatial
from .turns import ONE, rodrigues
from .wholes import Pose, itself, multiplied, times

START: Pose = (ONE[None, None], np.zeros((1, 1, 3)))
STILL = 1e-9
"""Angular parts below this are none: screws are unit vectors."""
six = partial(joined, axis=-1)


def at_home(steps: Steps, tree: Tree) -> list[Pose]:
    """Of all links."""
    home = [START]
    site = "the pose of a link at home, the parent's times its own,"
    for k in tree.links[1:]:
        up, on = home[k.parent], (k.R, k.p)
        made = times(PLAIN, up, on)
        home.append(multiplied(steps, PLAIN, site, ("the parent's", up), ("its own", itself(on)), made))
    return home


def screw(steps: Steps, k: Link, home: list[Pose]) -> np.ndarray:
    """S of the joint that moves a link."""
    (R, p), up = home[k.number], home[k.parent]
    others = {"by the parent's pose, without its own rpy": lambda: up[0]}
    z = k.z
    if abs(k.length - 1) > 1e-12:
        z = steps.pick("the axis of a screw, as the file gives it,", z, **{"not normalised": k.length * z})
    w = steps.turn("the axis of a screw, at home,", R, z + 0 * p, **others)
    lever = cross(w, p)
    turning, sliding = six([w, -lever]), six([0 * w, w])
    if k.slides:
        wrong = {"[w; 0], as of a turning one": six([w, 0 * w]), "[w; -w x p], as of a turning one": turning}
        wrong |= {"-[0; w]": -sliding, "[w; w]": six([w, w])}
        return np.asarray(steps.pick("the screw of a sliding joint", sliding, **wrong))
    wrong = {
        "[w; w x p], with the other sign": six([w, lever]), "[w; 0], without its place": six([w, 0 * w]),
        "[w; p], with its place itself": six([w, p]), "[0; w], as of a sliding one": sliding,
        "-[w; -w x p]": -turning, "[w; -w x p] with the parent's place": six([w, -cross(w, up[1])]),
    }  # fmt: skip
    return np.asarray(steps.pick(f"the screw of a turning joint: of {k.type} joints", turning, **wrong))


def exponentials(steps: Steps, tree: Tree, screws: Mapping[int, np.ndarray], q: np.ndarray) -> dict[int, Pose]:
    """Of the screws of links that move."""
    return {k.number: exponential(steps, screws[k.number], q[..., k.place]) for k in tree.links if k.moves}


def products(steps: Steps, tree: Tree, own: Mapping[int, Pose], where: str) -> list[Pose]:
    """Of the exponentials up to every link."""
    made = [START]
    for k in tree.links[1:]:
        T = before(steps, tree, k, made, where)
        if k.moves:
            E = own[k.number]
            site = f"the product of exponentials, those of the joints before times a joint's own: {where}"
            T = multiplied(steps, PLAIN, site, ("those before", T), ("its own", itself(E)), times(PLAIN, T, E))
        made.append(T)
    return made


def before(steps: Steps, tree: Tree, k: Link, made: list[Pose], where: str, **others: Pose) -> Pose:
    """Of the joints before that of a link."""
    T = made[k.parent]

    def of(link: Link) -> Pose:
        return made[link.number] if link.number < k.number else T

    def part(i: int) -> np.ndarray:
        near = tree.near(k, lambda link: of(link)[i] + 0 * T[i])
        wrong = near | {what: x[i] + 0 * T[i] for what, x in others.items()}
        return np.asarray(steps.pick(f"the product of the exponentials before a joint: {where}", T[i], **wrong))

    return part(0), part(1)


def standing(steps: Steps, tree: Tree, number: int, made: list[Pose], M: Pose, whose: str) -> Pose:
    """T M of what stands at M at home, on a link."""
    T, k = made[number], tree.links[number]
    short: dict[str, Callable[[], Pose]] = {}
    if k.moves:
        short["without the last exponential"] = partial(times, PLAIN, made[max(0, k.parent)], M)
    site = f"the pose, the product of exponentials times the pose at home: {whose}"
    one, other = ("the product", T), ("the pose at home", itself(M))
    return multiplied(steps, PLAIN, site, one, other, times(PLAIN, T, M), **short)


def exponential(steps: Steps, S: np.ndarray, q: np.ndarray) -> Pose:
    """exp(S q), by whether S has an angular part."""
    w, v = S[..., :3], S[..., 3:]
    slides = (np.abs(w) < STILL).all(-1)[..., None]
    if not slides.any():
        return _turning(steps, w, v, q)
    slid = v * q[..., None]
    p = steps.pick("the position of a sliding joint's exponential", slid, **{"v, without q": v + 0 * slid})
    if slides.all():
        return ONE[None, None], p
    R, turned = _turning(steps, w, v, q)
    return np.where(slides[..., None], ONE, R), np.where(slides, p, turned)


def _turning(steps: Steps, w: np.ndarray, v: np.ndarray, q: np.ndarray) -> Pose:
    W, slid = skew(steps, w), v * q[..., None]
    R = rodrigues(steps, w, q, W)
    t = q[..., None, None]
    s, c = np.sin(t), np.cos(t)
    first = {"1 + cos q": 1 + c, "sin q": s, "1 - sin q": 1 - s, "cos q": c, "1": 0 * c + 1, "-cos q": -c}
    second = {
        "q + sin q": t + s, "sin q": s, "1 - sin q": 1 - s, "q": t, "1": 0 * t + 1, "1 - cos q": 1 - c,
        "q - cos q": t - c, "-sin q": -s,
    }  # fmt: skip
    f = steps.pick("the factor of [w] in G of an exponential", 1 - c, **first)
    g = steps.pick("the factor of [w]^2 in G of an exponential", t - s, **second)
    f, g = (
        steps.pick("the factors of [w] and [w]^2 in G of an exponential", x, exchanged=y) for x, y in ((f, g), (g, f))
    )
    squares = {"[w]": W, "w w^T": w[..., None] * w[..., None, :], "the square of each entry of [w]": W * W}
    W2 = steps.pick("[w]^2 in G of an exponential", W @ W, **squares)
    wrong = {"1, without q": ONE + 0 * t, "q in every entry": t + 0 * ONE}
    one = steps.pick("q 1 in G of an exponential", t * ONE, **wrong)
    G = steps.add("G of an exponential", **{"q 1": one, "(1 - cos q) [w]": f * W, "(q - sin q) [w]^2": g * W2})
    p = steps.turn("v of a screw, in the position G v of an exponential,", G, v)
    others = {"v q, as of a sliding joint": slid, "p - R p of the joint, with the other sign": -p}
    p = steps.pick("the position of an exponential", p, **others)
    site, slides = "the exponential of a turning joint", "that of a sliding one, 1 and v q"
    return steps.pick(site, R, **{slides: ONE + 0 * R}), steps.pick(site, p, **{slides: slid + 0 * p})


def adjoint(steps: Steps, R: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Ad(T) = [R 0; [p x] R  R]."""
    P = skew(steps, p)
    few = steps.few
    wrong: dict[str, Any] = {
        "R [p x], in the other order": lambda: few(R) @ few(P), "-[p x] R": lambda: -few(P) @ few(R),
        "left out": lambda: 0 * (few(P) @ few(R)), "[p x], without R": lambda: few(P) + 0 * few(R),
        "R, without [p x]": lambda: few(R) + 0 * few(P), "[p x] R^T": lambda: few(P) @ transposed(few(R)),
    }  # fmt: skip
    lower = steps.pick("the block [p x] R of Ad", P @ R, **wrong)
    X = spatial([[R, 0 * R], [lower, R]])
    others: dict[str, Any] = {
        "[R  [p x] R; 0  R], with the block in the upper right": lambda: _upper(few(R), few(lower)),
        "its transpose": lambda: transposed(few(X)),
        "that with R^T in the place of R": lambda: _of_back(few(R), few(P)),
        "that of the inverse": lambda: adjoint(Steps(), *inverted(Steps(), (few(R), few(p)))),
        "its dual, Ad^-T": lambda: transposed(adjoint(Steps(), *inverted(Steps(), (few(R), few(p))))),
    }  # fmt: skip
    return np.asarray(steps.pick("Ad(T)", X, **others))


def _upper(R: np.ndarray, block: np.ndarray) -> np.ndarray:
    return spatial([[R, block], [0 * R, R]])


def _of_back(R: np.ndarray, P: np.ndarray) -> np.ndarray:
    E = transposed(R)
    return spatial([[E, 0 * E], [P @ E, E]])


def inverted(steps: Steps, T: Pose) -> Pose:
    """(R^T, -R^T p), also where R is no rotation any more."""
    R, p = T
    back = transposed(R)
    E = steps.pick("R^T of the inverse of a pose", back, **{"R itself, not transposed": R})
    there = product(back, p + 0 * R[..., 0])
    wrong = {"-p, not turned": -p + 0 * there, "-R p": lambda: -product(R, p + 0 * R[..., 0]), "R^T p": there}
    return E, np.asarray(steps.pick("-R^T p of the inverse of a pose", -there, **wrong))
