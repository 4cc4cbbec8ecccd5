"""A robot's states and answers in dualpin's columns, rewritten in a subject's, and back.

One matrix does all of it: v_s = G(q) v, with

    a_s = G a + G' v          tau = G^T tau_s

and, for answers, the algebra of `algebra` with v = G^-1 v_s.  G permutes, and turns with floating bodies whose
velocity is written in other axes (or of another point); G' is its rate.  Where joints follow others and a
subject has them as joints of its own, G has a row for each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ...errors import ArgumentError, nearest
from ...model.robot import Joint, Robot
from ...spatial.adjoint import cross_matrix
from ...spatial.inertia import Inertia
from ...spatial.pose import Pose
from .algebra import REWRITINGS, SIX, Change, product, transposed
from .convention import BASE_V, PARAMETERS, Convention, base_of, columns, floats_of, parameter_names

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


def quaternions(R: np.ndarray) -> np.ndarray:
    """Unit quaternions (..., 4), w x y z, of rotation matrices; of the two, one whose largest entry is positive."""
    R = np.asarray(R)
    xx, yy, zz = (R[..., k, k] for k in range(3))
    squares = np.stack([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz], -1)
    a, b, c = (R[..., i, j] - R[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0)))
    d, e, f = (R[..., i, j] + R[..., j, i] for i, j in ((1, 0), (0, 2), (2, 1)))
    w, x, y, z = np.moveaxis(squares, -1, 0)
    rows = np.stack([np.stack(r, -1) for r in ((w, a, b, c), (a, x, d, e), (b, d, y, f), (c, e, f, z))], -2)
    best = np.take_along_axis(rows, squares.argmax(-1)[..., None, None], axis=-2)[..., 0, :]
    return np.asarray(best / np.linalg.norm(best, axis=-1, keepdims=True))


class Layout:
    """How a robot's arrays become a subject's.

    Parameters
    ----------
    robot : Robot
    how : Convention
    turned : sequence of (str, float)
        Columns of v that the subject counts by this factor, such as -1 (while it does not those of q).
    point : sequence of float, optional
        The base's velocity is that of this point of it (in the base's own axes).
    followers : bool
        Whether joints that follow others may be columns of the subject: then its answers can be read, and not
        predicted, since it says more than dualpin does.

    Raises
    ------
    ArgumentError
        If the subject names a column that the robot does not have, or lacks one.
    """

    def __init__(
        self, robot: Robot, how: Convention, turned: Sequence[tuple[str, float]] = (),
        point: Sequence[float] | None = None, followers: bool = False,
    ) -> None:  # fmt: skip
        self.how, self.nv, self.robot = how, robot.nv, robot
        self.point = None if point is None else np.asarray(point, float)
        self.base = base_of(robot)
        self.floats = floats_of(robot)
        follows = {j.name: j for j in robot if j.mimic is not None} if followers else {}
        names = columns(robot)
        self.to_q, self.to_v = (
            _places(w, ours, theirs, follows) for w, ours, theirs in zip("qv", names, (how.q, how.v), strict=True)
        )
        coupling = {name: tuple(map(float, j.coupling)) for name, j in follows.items()}
        self.ratios, self.offsets = np.array([coupling.get(n, (1.0, 0.0)) for n in how.q]).reshape(-1, 2).T
        rates = dict(turned)
        self.factors = np.array([rates.get(n, 1.0) for n in how.v]) * [coupling.get(n, (1.0, 0.0))[0] for n in how.v]
        self.rows = [BASE_V.index(r) for r in how.rows]

    def matrices(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """G and its rate, (n, nv, nv), for dualpin's q and v."""
        n = len(q)
        G = np.broadcast_to(np.eye(self.nv), (n, self.nv, self.nv)).copy()
        D = np.zeros_like(G)
        for j in self.floats:
            self._base(G, D, j.v.start, q[:, j.q], v[:, j.v])
        pick = self.factors[:, None]
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

    def positions(self, q: np.ndarray) -> np.ndarray:
        """dualpin's q to the subject's."""
        return self.ratios * q[..., self.to_q] + self.offsets

    def states(self, ours: States) -> dict[str, np.ndarray]:
        """dualpin's q, v, a, tau to the subject's."""
        G, D = self.matrices(ours["q"], ours["v"])
        return {
            "q": self.positions(ours["q"]),
            "v": product(G, ours["v"]),
            "a": product(G, ours["a"]) + product(D, ours["v"]),
            "tau": np.linalg.solve(transposed(G), ours["tau"][..., None])[..., 0],
            **({"f_ext": ours["f_ext"][:, self.rows]} if "f_ext" in ours else {}),
        }

    def back(self, theirs: States) -> dict[str, np.ndarray]:
        """The subject's q, v, a, tau to dualpin's."""
        q = np.empty_like(theirs["q"])
        q[:, self.to_q] = theirs["q"]
        G, _ = self.matrices(q, np.zeros((len(q), self.nv)))
        v = np.linalg.solve(G, theirs["v"][..., None])[..., 0]
        _, D = self.matrices(q, v)
        a = np.linalg.solve(G, (theirs["a"] - product(D, v))[..., None])[..., 0]
        wrenches = {"f_ext": theirs["f_ext"][:, np.argsort(self.rows)]} if "f_ext" in theirs else {}
        return {"q": q, "v": v, "a": a, "tau": product(transposed(G), theirs["tau"]), **wrenches}

    # answers

    def answer(self, form: str, x: np.ndarray, ours: States, other: np.ndarray | None = None) -> np.ndarray:
        """dualpin's answer (n, ...) or (n, frames, ...) in the subject's form.

        `other` is the mass matrix for the forms "bias" and "coriolis", and the Jacobian for "six_rate".
        """
        return self.answers(form, x[None], ours, None if other is None else other[None])[0]

    def answers(self, form: str, x: np.ndarray, ours: States, other: np.ndarray | None = None) -> np.ndarray:
        """Many of them, (runs, n, ...) or (runs, n, frames, ...), at the same states."""
        x, other = (_ordered(y, form, self.rows) for y in (x, other))
        if form in UNCHANGED:
            return x
        if form == "derivatives" and self.turns:
            raise ArgumentError("derivatives are compared where the base's velocity is in its own axes")
        x = x @ self.bodies if form == "regressor" else x
        to, runs = self.change(ours), len(x)
        back, w = to.back.times(runs), np.tile(product(to.G, ours["v"]), (runs, 1))
        others = None if other is None else other.reshape(-1, *other.shape[2:])
        out = REWRITINGS[form](back, x.reshape(-1, *x.shape[2:]), w, others)
        return out.reshape(runs, x.shape[1], *out.shape[1:])

    def read(self, form: str, x: np.ndarray, ours: States, other: np.ndarray | None = None) -> np.ndarray:
        """The subject's answer in dualpin's form; `other` is the subject's."""
        order = list(np.argsort(self.rows))
        x, other = (_ordered(y, form, order) for y in (x, other))
        return x if form in UNCHANGED else REWRITINGS[form](self.change(ours), x, ours.get("v", NOTHING), other)

    def change(self, ours: States) -> Change:
        """v_s = G v, for dualpin's states."""
        if not self.turns:
            return self._constant
        return Change(*self.matrices(ours["q"], ours["v"]))

    @cached_property
    def _constant(self) -> Change:
        """Where no axes turn, at any state."""
        q = np.zeros((1, self.robot.nq))
        return Change(self.matrices(q, np.zeros((1, self.nv)))[0][0])

    @cached_property
    def bodies(self) -> np.ndarray:
        """B with p = B p_s: dualpin's inertial parameters, of joints' bodies, of the subject's, of links."""
        names = parameter_names(self.robot)
        if not self.how.parameters:
            return np.eye(len(names))
        frames = {f.name: f for f in self.robot.frames if f.role == "link"}
        B = np.zeros((len(names), len(self.how.parameters)))
        for k, name in enumerate(self.how.parameters):
            link, _, what = name.rpartition(".")
            if what in PARAMETERS and link in frames:
                joint = frames[link].joint
                if joint is not None:  # what no joint moves is felt nowhere
                    column = carried(frames[link].placement)[:, PARAMETERS.index(what)]
                    B[10 * joint.index : 10 * joint.index + 10, k] = column
            elif name in names:
                B[names.index(name), k] = 1.0
            else:
                near = nearest(name, names, "parameters", most=12)
                raise ArgumentError(f"the subject's parameter {name!r} is of no link or joint; {near}")
        return B

    @property
    def turns(self) -> bool:
        """Whether G depends on the state, so that its rate counts."""
        return bool(self.floats) and (self.how.angular != "body" or self.how.linear != "body")


def carried(placement: Pose) -> np.ndarray:
    """(10, 10): from the inertial parameters of a link to those of the body on which it stands so."""
    key = placement.array.tobytes()
    if (known := _CARRIED.get(key)) is None:
        if len(_CARRIED) >= PLACEMENTS:
            _CARRIED.clear()
        known = _CARRIED[key] = np.array([unit.moved(placement).array for unit in Inertia.basis()]).T
        known.flags.writeable = False
    return known


PLACEMENTS = 1024
"""Of which the last ones are kept: robots that are read in many ways have most in common."""
_CARRIED: dict[bytes, np.ndarray] = {}


UNCHANGED = ("plain", "twist")
"""Forms that have no columns of velocities."""
NOTHING = np.zeros(0)


def _ordered(x: Any, form: str, rows: Sequence[int]) -> Any:
    """Its six rows in this order, where it has any."""
    return np.take(x, rows, SIX[form]) if form in SIX and x is not None else x


def _places(what: str, ours: Sequence[str], theirs: Sequence[str], follows: Mapping[str, Joint]) -> list[int]:
    """Where each of the subject's columns is in dualpin's; those of a joint that follows, where its leader's is."""
    unknown = [n for n in theirs if n not in ours and n not in follows]
    if unknown:
        raise ArgumentError(
            f"the subject's {what} names {unknown[0]!r}, which is no column of the robot; "
            + nearest(unknown[0], ours, "columns", most=40)
        )
    missing = [n for n in ours if n not in theirs]
    if missing:
        raise ArgumentError(f"the subject's {what} lacks {', '.join(missing)}")
    leaders = {n: getattr(j, what).start for n, j in follows.items()}
    return [leaders[n] if n in leaders else ours.index(n) for n in theirs]
