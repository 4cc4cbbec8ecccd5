"""The largest change of each term over random states, computed by both robots themselves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...functions import crba, fk, gravity, rnea
from .compare import Pair
from .results import TermChange

LARGE = 1e-9
"""A scaled change beyond rounding; two descriptions of one robot differ by about 1e-12."""


class States:
    """The same states in the coordinates of both."""

    def __init__(self, pair: Pair, samples: int, seed: int) -> None:
        self.pair = pair
        a, b = pair.a.robot, pair.b.robot
        self.q, self.v, self.a = a.sample(samples, seed)
        self.signs, self.columns = np.ones(b.nv), np.zeros(b.nv, dtype=int)
        self.q_b = np.tile(b.neutral, (samples, 1))
        for m in pair.matching.joints:
            j, k = m.a.joint, m.b.joint
            if j.mimic or k.mimic:
                continue
            sign = -m.sign if m.reversed and j.model.nv == 1 else m.sign
            x = self.q[:, j.q]
            self.q_b[:, k.q] = sign * (x - m.offset) if j.model.nv == 1 else x
            self.signs[k.v], self.columns[k.v] = sign, range(j.v.start, j.v.stop)

    def velocity(self, v: np.ndarray) -> np.ndarray:
        """v or a of a, as b counts them."""
        return np.asarray(self.signs * v[:, self.columns])

    def torque(self, tau: np.ndarray) -> np.ndarray:
        """A torque of b, as a counts it."""
        out = np.zeros((len(tau), len(self.columns)))
        out[:, self.columns] = self.signs * tau
        return out

    def matrix(self, M: np.ndarray) -> np.ndarray:
        out = np.zeros_like(M)
        out[:, self.columns[:, None], self.columns[None, :]] = self.signs[:, None] * M * self.signs
        return out


def comparable(pair: Pair) -> str:
    """Why torques cannot be compared; empty if they can."""
    a, b = pair.a.robot, pair.b.robot
    if not a.nv and not b.nv:
        return "no joint moves"
    lost = [m for m in pair.matching.joints if m.a.joint.model.coordinates != m.b.joint.model.coordinates]
    if lost or len(pair.matching.joints) != len(a) or len(a) != len(b):
        return "the joints are not the same"
    if a.nv != b.nv or [bool(j.mimic) for j in a].count(True) != [bool(j.mimic) for j in b].count(True):
        return f"{a.nv} and {b.nv} coordinates"
    return ""


def terms(pair: Pair, samples: int, seed: int) -> Iterator[TermChange]:
    """FK of every link of both, relative to a's ground; gravity, inverse dynamics and M if both stand on one body."""
    s = States(pair, samples, seed)
    yield from _poses(pair, s)
    if pair.matching.rerooted:
        return
    a, b = pair.a.robot, pair.b.robot
    joints = [next(j for j in a if j.v.start <= k < j.v.stop and not j.mimic) for k in range(a.nv)]
    units = ["N" if not any(float(c) for c in j.model.screws[k - j.v.start].real) else "N m"
             for k, j in enumerate(joints)]  # fmt: skip
    pairs = (
        ("gravity", gravity(a, s.q, engine="numpy"), s.torque(gravity(b, s.q_b, engine="numpy"))),
        ("rnea", rnea(a, s.q, s.v, s.a, engine="numpy"),
         s.torque(rnea(b, s.q_b, s.velocity(s.v), s.velocity(s.a), engine="numpy"))),
    )  # fmt: skip
    for term, x, y in pairs:
        n, k = np.unravel_index(int(np.abs(x - y).argmax()), x.shape)
        yield _change(term, x, y, int(n), units[int(k)], f"joint {joints[int(k)].name!r}", s)
    M, N = crba(a, s.q, engine="numpy"), s.matrix(crba(b, s.q_b, engine="numpy"))
    n, i, k = np.unravel_index(int(np.abs(M - N).argmax()), M.shape)
    where = " and ".join(dict.fromkeys(f"joint {joints[int(x)].name!r}" for x in (i, k)))
    yield _change("crba", M, N, int(n), "kg m^2" if "N m" in (units[int(i)], units[int(k)]) else "kg", where, s)


def _poses(pair: Pair, s: States) -> Iterator[TermChange]:
    """Relative displacement of equally named frames by the motion of their bodies."""
    bodies = pair.matching.bodies
    ground = next((k for k, (node, _) in pair.a.links.items() if node == 0), None)
    rerooted = bool(pair.matching.rerooted) and ground in pair.b.links
    base = pair.matching.base
    if rerooted:
        assert ground is not None
        (_, X), (other, Y) = pair.a.links[ground], pair.b.links[ground]
        same = np.linalg.inv(pair.matching.motions[other] @ Y) @ X
        base = X @ np.linalg.inv(fk(pair.b.robot, s.q_b, frame=ground, engine="numpy") @ same)
    worst: TermChange | None = None
    for name, (node, X) in pair.a.links.items():
        if name not in pair.b.links or bodies.get(node) != pair.b.links[name][0]:
            continue
        other, Y = pair.b.links[name]
        # b's frame is placed at a's, so that another choice of frame does not count
        same = np.linalg.inv(pair.matching.motions[other] @ Y) @ X
        P = fk(pair.a.robot, s.q, frame=name, engine="numpy")
        Q = base @ fk(pair.b.robot, s.q_b, frame=name, engine="numpy") @ same
        off = np.linalg.norm(P[:, :3, 3] - Q[:, :3, 3], axis=-1) + np.abs(P[:, :3, :3] - Q[:, :3, :3]).max(axis=(1, 2))
        n = int(off.argmax())
        if worst is None or off[n] > worst.amount:
            scaled = float(np.abs(P[n] - Q[n]).max() / max(1.0, np.abs(P[n]).max()))
            worst = TermChange("fk", float(off[n]), "m or rad", scaled, f"link {name!r}", _state(s, n))
    if worst is not None:
        yield worst


def _change(term: str, x: np.ndarray, y: np.ndarray, n: int, unit: str, where: str, s: States) -> TermChange:
    amount = float(np.abs(x - y).max()) if x.size else 0.0
    scaled = amount / max(1.0, float(np.abs(x).max(initial=0.0)))
    return TermChange(term, amount, unit, scaled, where if amount else "", _state(s, n))


def _state(s: States, n: int) -> dict[str, list[float]]:
    return {"q": s.q[n].tolist(), "v": s.v[n].tolist(), "a": s.a[n].tolist()}
