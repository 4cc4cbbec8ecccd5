"""A robot's states and answers in dualpin's columns, rewritten in a subject's, and back.

One matrix does all of it: with v_s = G(q) v,

    a_s = G a + G' v          tau = G^T tau_s
    M_s = G^-T M G^-1         h_s = G^-T (h - M G^-1 G' v)       C_s = G^-T (C - M G^-1 G') G^-1
    J_s = P J G^-1            J'_s = P (J' - J G^-1 G') G^-1

P permutes the rows of six-vectors.  G permutes, and turns with floating bodies whose velocity is
written in other axes (or of another point); G' is its rate.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ...errors import ArgumentError, nearest
from ...model.robot import Robot
from .convention import BASE_V, Convention, base_of, columns, floats_of

States = Mapping[str, np.ndarray]


def rotations(wxyz: np.ndarray) -> np.ndarray:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    w, x, y, z = np.moveaxis(wxyz, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(r, -1) for r in rows], -2)


def cross_matrix(p: np.ndarray) -> np.ndarray:
    """[p] (..., 3, 3) with [p] u = p x u."""
    x, y, z = np.moveaxis(p, -1, 0)
    o = np.zeros_like(x)
    return np.stack([np.stack([o, -z, y], -1), np.stack([z, o, -x], -1), np.stack([-y, x, o], -1)], -2)


def transposed(x: np.ndarray) -> np.ndarray:
    return np.swapaxes(x, -1, -2)


def product(A: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A x, of matrices and vectors (n, ...)."""
    return (A @ x[..., None])[..., 0]


class Layout:
    """How a robot's arrays become a subject's.

    Parameters
    ----------
    robot : Robot
    how : Convention
    turned : sequence of str
        Columns of v that the subject counts the other way round (while it does not those of q).
    point : sequence of float, optional
        The base's velocity is that of this point of it (in the base's own axes).

    Raises
    ------
    ArgumentError
        If the subject names a column that the robot does not have, or lacks one.
    """

    def __init__(
        self, robot: Robot, how: Convention, turned: Sequence[str] = (), point: Sequence[float] | None = None
    ) -> None:
        self.how, self.nv = how, robot.nv
        self.point = None if point is None else np.asarray(point, float)
        self.base = base_of(robot)
        self.floats = floats_of(robot)
        names = columns(robot)
        self.to_q, self.to_v = (
            _places(w, ours, theirs) for w, ours, theirs in zip("qv", names, (how.q, how.v), strict=True)
        )
        self.signs = np.array([-1.0 if n in turned else 1.0 for n in how.v])
        self.rows = [BASE_V.index(r) for r in how.rows]

    def matrices(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """G and its rate, (n, nv, nv), for dualpin's q and v."""
        n = len(q)
        G = np.broadcast_to(np.eye(self.nv), (n, self.nv, self.nv)).copy()
        D = np.zeros_like(G)
        for j in self.floats:
            self._base(G, D, j.v.start, q[:, j.q], v[:, j.v])
        pick = self.signs[:, None]
        return G[:, self.to_v] * pick, D[:, self.to_v] * pick

    def _base(self, G: np.ndarray, D: np.ndarray, start: int, q: np.ndarray, v: np.ndarray) -> None:
        """A floating body's block of G: its velocity in other axes, or of another point."""
        R, p, (w, l) = rotations(q[:, 3:]), q[:, :3], (v[:, :3], v[:, 3:])
        rate = R @ cross_matrix(w)  # of R
        a, b = slice(start, start + 3), slice(start + 3, start + 6)
        if self.how.angular == "world":
            G[:, a, a], D[:, a, a] = R, rate
        if self.how.linear != "body":
            G[:, b, b], D[:, b, b] = R, rate
        if self.how.linear == "origin":
            G[:, b, a] = cross_matrix(p) @ R
            D[:, b, a] = cross_matrix(p) @ rate + cross_matrix(product(R, l)) @ R
        elif self.point is not None:
            c = cross_matrix(self.point)
            G[:, b, a], D[:, b, a] = -G[:, b, b] @ c, -D[:, b, b] @ c

    # states

    def states(self, ours: States) -> dict[str, np.ndarray]:
        """dualpin's q, v, a, tau to the subject's."""
        G, D = self.matrices(ours["q"], ours["v"])
        return {
            "q": ours["q"][:, self.to_q],
            "v": product(G, ours["v"]),
            "a": product(G, ours["a"]) + product(D, ours["v"]),
            "tau": np.linalg.solve(transposed(G), ours["tau"][..., None])[..., 0],
        }

    def back(self, theirs: States) -> dict[str, np.ndarray]:
        """The subject's q, v, a, tau to dualpin's."""
        q = np.empty_like(theirs["q"])
        q[:, self.to_q] = theirs["q"]
        G, _ = self.matrices(q, np.zeros((len(q), self.nv)))
        v = np.linalg.solve(G, theirs["v"][..., None])[..., 0]
        _, D = self.matrices(q, v)
        a = np.linalg.solve(G, (theirs["a"] - product(D, v))[..., None])[..., 0]
        return {"q": q, "v": v, "a": a, "tau": product(transposed(G), theirs["tau"])}

    # answers

    def answer(self, form: str, x: np.ndarray, ours: States, other: np.ndarray | None = None) -> np.ndarray:
        """dualpin's answer (n, ...) or (n, frames, ...) in the subject's form.

        `other` is the mass matrix for the forms "bias" and "coriolis", and the Jacobian for "six_rate".
        """
        if form == "plain":
            return x
        if form == "twist":
            return x[..., self.rows]
        G, D = self.matrices(ours["q"], ours["v"])
        return FORMS[form](self, x, G, D, ours["v"], other)

    @property
    def turns(self) -> bool:
        """Whether G depends on the state, so that its rate counts."""
        return bool(self.floats) and (self.how.angular != "body" or self.how.linear != "body")


def _force(
    to: Layout, x: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, other: np.ndarray | None
) -> np.ndarray:
    return product(transposed(np.linalg.inv(G)), x)


def _bias(to: Layout, h: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, M: np.ndarray | None) -> np.ndarray:
    H = np.linalg.inv(G)
    if M is not None:
        h = h - product(M @ H @ D, v)
    return product(transposed(H), h)


def _acceleration(
    to: Layout, a: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, other: np.ndarray | None
) -> np.ndarray:
    return product(G, a) + product(D, v)


def _matrix(
    to: Layout, M: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, other: np.ndarray | None
) -> np.ndarray:
    H = np.linalg.inv(G)
    return transposed(H) @ M @ H


def _inverse(
    to: Layout, W: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, other: np.ndarray | None
) -> np.ndarray:
    return G @ W @ transposed(G)


def _coriolis(
    to: Layout, C: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, M: np.ndarray | None
) -> np.ndarray:
    H = np.linalg.inv(G)
    if M is not None:
        C = C - M @ H @ D
    return transposed(H) @ C @ H


def _columns(
    to: Layout, J: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, other: np.ndarray | None
) -> np.ndarray:
    H = np.linalg.inv(G)
    return J @ (H if J.ndim == 3 else H[:, None])


def _six(
    to: Layout, J: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, other: np.ndarray | None
) -> np.ndarray:
    return _columns(to, J[..., to.rows, :], G, D, v, None)


def _six_rate(
    to: Layout, Jd: np.ndarray, G: np.ndarray, D: np.ndarray, v: np.ndarray, J: np.ndarray | None
) -> np.ndarray:
    if J is not None:
        Jd = Jd - J @ (np.linalg.inv(G) @ D)[:, None]
    return _six(to, Jd, G, D, v, None)


FORMS: dict[str, Callable[..., np.ndarray]] = {
    "force": _force, "bias": _bias, "acceleration": _acceleration, "matrix": _matrix, "inverse": _inverse,
    "coriolis": _coriolis, "columns": _columns, "six": _six, "six_rate": _six_rate,
}  # fmt: skip
"""How each kind of answer is rewritten."""


def _places(what: str, ours: Sequence[str], theirs: Sequence[str]) -> list[int]:
    unknown = [n for n in theirs if n not in ours]
    if unknown:
        raise ArgumentError(
            f"the subject's {what} names {unknown[0]!r}, which is no column of the robot; "
            + nearest(unknown[0], ours, "columns", most=40)
        )
    missing = [n for n in ours if n not in theirs]
    if missing:
        raise ArgumentError(f"the subject's {what} lacks {', '.join(missing)}")
    return [ours.index(n) for n in theirs]
