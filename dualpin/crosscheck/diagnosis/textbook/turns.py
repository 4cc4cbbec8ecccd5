"""Rotations as textbooks write them: by Rodrigues' formula, by quaternions, by roll, pitch and yaw, entry by entry.

Arrays have the axes (runs, samples, ...), see `Steps.together`.

References: Siciliano et al., Robotics (2009), sections 2.4 to 2.6; Murray, Li and Sastry, A Mathematical Introduction
to Robotic Manipulation (1994), section 2.2.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import transposed
from ..description import turn
from .steps import Steps

ONE = np.eye(3)
Turn = Callable[[Steps, np.ndarray, np.ndarray], np.ndarray]


def rodrigues(steps: Steps, axis: np.ndarray, q: np.ndarray, K: np.ndarray | None = None) -> np.ndarray:
    """R = 1 + sin q K + (1 - cos q) K^2; axis (..., 3), q (...), K by default [axis x]."""
    s, c = _sin_cos(steps, q)
    K, x = cross_matrix(axis) if K is None else K, q[..., None, None]
    K = steps.pick("K in Rodrigues' formula", K, **_skews(K))
    f = steps.pick(
        "the factor of K in Rodrigues' formula", s, **{"cos q": c, "1 - cos q": 1 - c, "q": x, "1": 0 * x + 1}
    )
    g = steps.pick(
        "the factor of K^2 in Rodrigues' formula", 1 - c,
        **{"sin q": s, "cos q": c, "1 + cos q": 1 + c, "1 - sin q": 1 - s, "q^2 / 2": x**2 / 2, "1": 0 * c + 1,
           "-cos q": -c},
    )  # fmt: skip
    square = steps.pick(
        "K^2 in Rodrigues' formula", K @ K,
        **{"K": K, "a a^T": lambda: _outer(axis), "the square of each entry of K": lambda: K * K},
    )  # fmt: skip
    one = steps.pick("the 1 of Rodrigues' formula", ONE + 0 * f, **{"cos q 1": c * ONE, "(1 - cos q) 1": (1 - c) * ONE})
    terms = {"1": one, "sin q K": f * K, "(1 - cos q) K^2": g * square}
    return np.asarray(steps.add("the rotation of a joint, by Rodrigues' formula", **terms))


def by_outer_product(steps: Steps, axis: np.ndarray, q: np.ndarray) -> np.ndarray:
    """R = cos q 1 + sin q K + (1 - cos q) a a^T."""
    s, c = _sin_cos(steps, q)
    g = steps.pick("the factor of a a^T", 1 - c, **{"sin q": s, "cos q": c, "1 + cos q": 1 + c, "1 - sin q": 1 - s})
    square = steps.pick(
        "a a^T", _outer(axis),
        **{"its diagonal alone": lambda: _outer(axis) * ONE, "K^2": lambda: cross_matrix(axis) @ cross_matrix(axis)},
    )  # fmt: skip
    K = cross_matrix(axis)
    K = steps.pick("K in a rotation by axis and angle", K, **_skews(K))
    one = steps.pick("cos q 1", c * ONE, **{"1": ONE + 0 * c, "(1 - cos q) 1": (1 - c) * ONE})
    terms = {"cos q 1": one, "sin q K": s * K, "(1 - cos q) a a^T": g * square}
    return np.asarray(steps.add("the rotation of a joint, by axis and angle", **terms))


def by_axis_entries(steps: Steps, axis: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The same, entry by entry: t x x + c, t x y - s z, ..., with t = 1 - cos q."""
    s, c = (f[..., 0, 0] for f in _sin_cos(steps, q))
    x, y, z = np.moveaxis(axis, -1, 0)
    t = steps.pick(
        "t = 1 - c, in a rotation by axis and angle", 1 - c, **{"1 + c": 1 + c, "1 - s": 1 - s, "c": c, "1": 0 * c + 1}
    )
    a = {"x": x, "y": y, "z": z}

    def off(i: str, j: str, k: str, sign: float) -> dict[str, np.ndarray]:
        entry = f"entry {'xyz'.index(i) + 1}{'xyz'.index(j) + 1} of the rotation by axis and angle"
        sine = steps.pick(f"the component beside s in {entry}", a[k], **{n: v for n, v in a.items() if n != k})
        wrong = {f"{m} {n}": a[m] * a[n] for m, n in ("xy", "xz", "yz", "xx", "yy", "zz") if {m, n} != {i, j}}
        both = steps.pick(f"the components beside t in {entry}", a[i] * a[j], **wrong)
        return {f"t {min(i, j)} {max(i, j)}": t * both, f"s {k}": sign * s * sine}

    table = [
        [{"t x x": t * x * x, "c": c}, off("x", "y", "z", -1), off("x", "z", "y", 1)],
        [off("y", "x", "z", 1), {"t y y": t * y * y, "c": c}, off("y", "z", "x", -1)],
        [off("z", "x", "y", -1), off("z", "y", "x", 1), {"t z z": t * z * z, "c": c}],
    ]
    return _matrix(steps, table, "of the rotation by axis and angle")


def by_quaternion(steps: Steps, axis: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The unit quaternion (cos q/2, sin q/2 a), and its rotation."""
    half = steps.pick("the angle in a joint's quaternion", q / 2, **{"q": q, "2 q": 2 * q, "q / 4": q / 4})
    pair = np.stack([np.cos(half), np.sin(half)], -1)
    pair = steps.pick("cosine and sine in a joint's quaternion", pair, exchanged=pair[..., ::-1])
    return of_quaternion(steps, pair[..., 0], pair[..., 1:] * axis, "a joint")


def of_quaternion(steps: Steps, w: np.ndarray, u: np.ndarray, whose: str) -> np.ndarray:
    """R = (w^2 - u.u) 1 + 2 u u^T + 2 w [u]; w (...), u (..., 3)."""
    w = w[..., None, None]
    terms = {
        "w^2 1": w * w * ONE, "-u.u 1": -(u * u).sum(-1)[..., None, None] * ONE, "2 u u^T": 2 * _outer(u),
        "2 w [u]": 2 * w * cross_matrix(u),
    }  # fmt: skip
    return np.asarray(steps.add(f"the rotation of {whose}, from its quaternion", **terms))


def by_square(steps: Steps, w: np.ndarray, u: np.ndarray, whose: str) -> np.ndarray:
    """R = 1 + 2 w [u] + 2 [u]^2."""
    K, w = cross_matrix(u), w[..., None, None]
    K = steps.pick(f"[u] in the rotation of {whose}", K, **_skews(K))
    terms = {"1": ONE + 0 * w, "2 w [u]": 2 * w * K, "2 [u]^2": 2 * K @ K}
    return np.asarray(steps.add(f"the rotation of {whose}, from its quaternion", **terms))


def entry_by_entry(steps: Steps, w: np.ndarray, u: np.ndarray, whose: str) -> np.ndarray:
    """The nine entries of a quaternion's rotation, each a sum of two or three products."""
    v = dict(zip("wxyz", (w, *np.moveaxis(u, -1, 0)), strict=True))
    products = {a + b: v[a] * v[b] for a, b in ("wx", "wy", "wz", "xy", "xz", "yz", "xx", "yy", "zz")}
    squares, mixed, scaled = ("xx", "yy", "zz"), ("xy", "xz", "yz"), ("wx", "wy", "wz")

    def one_of(entry: str, right: str, family: tuple[str, ...], beside: str = "") -> np.ndarray:
        others = {what: products[what] for what in family if what not in (right, beside)}
        return np.asarray(steps.pick(f"{right} in entry {entry} of the rotation of {whose}", products[right], **others))

    def diagonal(i: str, a: str, b: str) -> dict[str, np.ndarray]:
        entry = f"{'xyz'.index(i) + 1}" * 2
        first, second = one_of(entry, a, squares, b), one_of(entry, b, squares, a)
        return {"1": np.ones_like(w), f"2 {a}": -2 * first, f"2 {b}": -2 * second}

    def off(i: str, j: str, k: str, sign: float) -> dict[str, np.ndarray]:
        entry, both = f"{'xyz'.index(i) + 1}{'xyz'.index(j) + 1}", min(i, j) + max(i, j)
        first, second = one_of(entry, both, mixed), one_of(entry, "w" + k, scaled)
        return {f"2 {both}": 2 * first, f"2 w{k}": 2 * sign * second}

    table = [
        [diagonal("x", "yy", "zz"), off("x", "y", "z", -1), off("x", "z", "y", 1)],
        [off("y", "x", "z", 1), diagonal("y", "xx", "zz"), off("y", "z", "x", -1)],
        [off("z", "x", "y", -1), off("z", "y", "x", 1), diagonal("z", "xx", "yy")],
    ]
    return _matrix(steps, table, f"of the rotation of {whose}")


ANGLES = ("roll", "pitch", "yaw")


def of_rpy(steps: Steps, rpy: np.ndarray, whose: str) -> np.ndarray:
    """Rz(yaw) Ry(pitch) Rx(roll), as the product of three matrices; rpy (3,)."""
    turns = []
    for k, (name, angle) in enumerate(zip("xyz", rpy, strict=True)):
        R = turn(k, angle)[None, None]
        wrong = {
            "transposed": transposed(R), "with sine and cosine exchanged": turn(k, np.pi / 2 - angle)[None, None],
            "with both sines positive": R * ONE + np.sin(angle) * _sines(k),
            "with both sines negative": R * ONE - np.sin(angle) * _sines(k), "without its 1": R - np.diag(ONE[k]),
            "1": ONE + 0 * R,
        }  # fmt: skip
        own = np.diag(ONE[k])
        for other in (n for n in range(3) if n != k):
            s = (turn(k, np.pi / 2) - own) * (ONE == 0) * (np.sin(rpy[other]) - np.sin(angle))
            c = (ONE - own) * (np.cos(rpy[other]) - np.cos(angle))
            wrong |= {f"with the sine of {ANGLES[other]}": R + s, f"with the cosine of {ANGLES[other]}": R + c}
        turns.append(steps.pick(f"R{name} of roll, pitch and yaw: {whose}", R, **wrong))
    x, y, z = turns
    others = {
        "1 + [rpy x], as for small angles": lambda: ONE + cross_matrix(rpy)[None, None],
        "Rx Ry Rz": lambda: x @ y @ z, "Rz Rx Ry": lambda: z @ x @ y, "Ry Rz Rx": lambda: y @ z @ x,
        "Ry Rx Rz": lambda: y @ x @ z, "Rx Rz Ry": lambda: x @ z @ y,
    }  # fmt: skip
    return np.asarray(steps.pick(f"the product of roll, pitch and yaw: {whose}", z @ y @ x, **others))


def rpy_by(make: Turn) -> Callable[[Steps, np.ndarray, str], np.ndarray]:
    """Rz(yaw) Ry(pitch) Rx(roll), each as joints turn, where a code has one function for all rotations."""

    def of(steps: Steps, rpy: np.ndarray, whose: str) -> np.ndarray:
        x, y, z = (make(steps, ONE[k][None, None], np.asarray(rpy[k])[None, None]) for k in range(3))
        return z @ y @ x

    return of


def rpy_entries(steps: Steps, rpy: np.ndarray, whose: str) -> np.ndarray:
    """The same, entry by entry: sums of products of sines and cosines."""
    what = f"of the rotation by roll, pitch and yaw: {whose}"
    factor = {f + a: x for f, of in (("c", np.cos), ("s", np.sin)) for a, x in zip("rpy", of(rpy), strict=True)}

    def made(names: tuple[str, ...], sign: float) -> np.ndarray:
        return np.full((1, 1), sign * np.prod([factor[x] for x in names]))

    def term(entry: str, names: tuple[str, ...], sign: float) -> np.ndarray:
        """A product; with a factor left out, or another one in its place."""
        wrong: dict[str, np.ndarray] = {}
        for k, name in enumerate(names):
            others = [x for x in factor if x not in names and (x[0] == name[0] or x[1] == name[1])]
            for x in ((), *((x,) for x in others)):
                changed = (*names[:k], *x, *names[k + 1 :])
                wrong[" ".join(changed) or "1"] = made(changed, sign)
        return np.asarray(steps.pick(f"{' '.join(names)} in entry {entry} {what}", made(names, sign), **wrong))

    table = [
        [
            {" ".join(names): term(f"{i + 1}{j + 1}", names, sign) for names, sign in terms}
            for j, terms in enumerate(row)
        ]
        for i, row in enumerate(_OF_RPY)
    ]
    return _matrix(steps, table, what)


_OF_RPY = (
    ((("cy", "cp"), 1),), ((("cy", "sp", "sr"), 1), (("sy", "cr"), -1)), ((("cy", "sp", "cr"), 1), (("sy", "sr"), 1)),
), (
    ((("sy", "cp"), 1),), ((("sy", "sp", "sr"), 1), (("cy", "cr"), 1)), ((("sy", "sp", "cr"), 1), (("cy", "sr"), -1)),
), (
    ((("sp",), -1),), ((("cp", "sr"), 1),), ((("cp", "cr"), 1),),
)  # fmt: skip
"""The entries of Rz(yaw) Ry(pitch) Rx(roll): products of sines and cosines, with their signs."""


def _matrix(steps: Steps, table: list[list[dict[str, np.ndarray]]], what: str) -> np.ndarray:
    """Of sums, entry by entry."""
    made = [[steps.add(f"entry {i + 1}{j + 1} {what}", **x) for j, x in enumerate(row)] for i, row in enumerate(table)]
    shape = np.broadcast_shapes(*(x.shape for row in made for x in row))
    return np.stack([np.stack([np.broadcast_to(x, shape) for x in row], -1) for row in made], -2)


def _sin_cos(steps: Steps, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of a joint's angle, (..., 1, 1) each."""
    others = {"halved": q / 2, "doubled": 2 * q, "taken for degrees": q * (np.pi / 180)}
    x = steps.pick("the angle of a joint", q, **others)
    pair = np.stack([np.sin(x), np.cos(x)], -1)
    pair = steps.pick(
        "the sine and cosine of a joint's angle", pair,
        **{"exchanged": pair[..., ::-1], "q and 1, as for small angles": np.stack([x, 0 * x + 1], -1),
           "q and 1 - q^2 / 2": np.stack([x, 1 - x * x / 2], -1)},
    )  # fmt: skip
    return pair[..., 0, None, None], pair[..., 1, None, None]


def _skews(K: np.ndarray) -> dict[str, np.ndarray]:
    """What may stand in the place of a skew matrix."""
    upper = np.triu(K)
    found = {
        "symmetric, with positive entries": np.abs(K), "symmetric, with its upper triangle": upper + transposed(upper)
    }  # fmt: skip
    for i, j in ((0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)):
        E = ONE[:, [i]] * ONE[[j]]
        found[f"[a] with the other sign of entry {i + 1}{j + 1}"] = K * (1 - 2 * E)
    return found


def _outer(u: np.ndarray) -> np.ndarray:
    return np.asarray(u[..., :, None] * u[..., None, :])


def _sines(k: int) -> np.ndarray:
    """Where the sines stand in a turn about axis k."""
    i, j = (k + 1) % 3, (k + 2) % 3
    E = np.zeros((3, 3))
    E[i, j] = E[j, i] = 1.0
    return E
