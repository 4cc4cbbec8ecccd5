"""Poses of all links of a tree, link by link from the base, as textbooks write them.

    p_j = p_p + R_p xyz          R_j = R_p R(rpy)               the fixed side of a joint
    p = p_j,  R = R_j R(q)       (turning)        p = p_j + R_j a q,  R = R_j        (sliding)

Every kind of joint that a description knows is covered, with joints that follow others.  Arrays have the axes
(runs, samples, ...), see `Steps.together`.

References: Siciliano et al., Robotics (2009), sections 2.8 and 3.1; Craig, Introduction to Robotics (2005),
section 5.6.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from ....model.robot import Joint, Robot
from ...subjects.convention import base_of
from ...subjects.layout import product, rotations, transposed
from ..description import Body, Description, Part, merged
from .attitudes import PLAIN, Ways
from .axes import Axis, Placed
from .lists import branched, by_levels
from .lumps import listed
from .steps import Steps, UncoveredError
from .turns import ONE
from .wholes import Pose, from_parent, multiplied, some, times


class Poses:
    """Poses of all links at positions q (n, nq); `velocities` finds their twists, of velocities qd (n, nv).

    Attributes
    ----------
    R, p : list of array
        Of each link, parents first: (runs, n, 3, 3), which turns vectors, and (runs, n, 3).
    attitudes : list of array
        The orientations, in the way in which they are kept.
    before : list of array
        As R, without the turn of the link's own joint.
    kept : dict of array
        Of links with axes that are turned into the world `early`: the matrices by which they are.
    placed : list of Placed
        Of each link: on which body it is fixed, and where.
    w, v : list of array
        Angular velocity, and velocity of the origin, in world axes; of the root alone, before others are found.
    listing : str
        Which order of links is meant, where that matters.
    axes : list of Axis
    sides : list of Placed
        Of each link: the fixed side of its joint, on the link or body that carries it.
    of_link : list of list of int
        The axes of the joint that carries each link.
    """

    def __init__(
        self, robot: Robot, d: Description, q: np.ndarray, qd: np.ndarray | None, steps: Steps, ways: Ways = PLAIN,
        fused: bool = False, early: bool = False, by_level: bool = False,
    ) -> None:  # fmt: skip
        """`early` says that axes are turned into the world before their own joint turns, and kept for all uses.

        Links are taken branch by branch in the file's order, or level by level.
        """
        d = by_levels(d) if by_level else replace(d, parts=tuple(listed(d)))
        self.robot, self.d, self.steps, self.ways, self.fused, self.early = robot, d, steps, ways, fused, early
        self.q, self.qd = q[None], None if qd is None else qd[None]
        self.number = {d.root: 0} | {p.link: k + 1 for k, p in enumerate(d.parts)}
        self.parent = [-1, *(self.number[p.parent] for p in d.parts)]
        self.listing = "" if not branched(d) else " (breadth first)" if by_level else " (depth first)"
        self.axes: list[Axis] = []
        self.of_link: list[list[int]] = [[]]
        zero = np.zeros((1, len(q), 3), q.dtype)
        self.attitudes: list[np.ndarray] = [ways.start()]
        self.R: list[np.ndarray] = [ONE[None, None]]
        self.before: list[np.ndarray] = [ONE[None, None]]
        self.kept: dict[int, np.ndarray] = {}
        self.placed = [Placed(0, ways.placing.start(), np.zeros((1, 1, 3)))]
        self.travel: dict[int, np.ndarray] = {}
        self.sides = [self.placed[0]]
        self._motions: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self.p, self.w, self.v, self.given = [zero], [zero], [zero], [self.R[0], self.R[0]]
        base = base_of(robot)
        if base is not None:
            self._base(base)
        joints = {j.name: j for j in robot}
        for part in d.parts:
            self._add(part, joints.get(part.joint))

    def _base(self, joint: Joint) -> None:
        self.attitudes[0] = self._quaternion(joint, "the base")
        R, at = self.ways.matrix(self.attitudes[0]), joint.q.start
        self.before[0] = self.R[0] = R
        self.p[0] = self.q[..., at : at + 3]
        self.given = [rotations(self.q[..., at + 3 : at + 7]) if world else R for world in self.ways.in_world]
        self._six(joint, 0, -1, base=True)
        if self.qd is not None:
            k, steps = joint.v.start, self.steps
            self.w[0] = steps.turn("the base's angular velocity", self.given[0], self.qd[..., k : k + 3])
            self.v[0] = steps.turn("the base's linear velocity", self.given[1], self.qd[..., k + 3 : k + 6])

    def _quaternion(self, joint: Joint, whose: str) -> np.ndarray:
        at = joint.q.start + 3
        return self.ways.of_quaternion(self.steps, self.q[..., at], self.q[..., at + 1 : at + 4], whose)

    def _six(self, joint: Joint, link: int, parent: int, base: bool = False) -> None:
        for k in range(6):
            self._axis(Axis(link, parent, k < 3, ONE[k % 3], joint.v.start + k, base=base))

    def _axis(self, axis: Axis) -> None:
        self.of_link[axis.link].append(len(self.axes))
        self.axes.append(axis)

    def _add(self, part: Part, joint: Joint | None) -> None:
        """The next link: its pose, its axes and its velocity."""
        if np.abs(part.after - np.eye(4)).max() > 0 or part.more.any():
            raise UncoveredError("a link that stands where its joint moves it")
        steps, ways, up, link = self.steps, self.ways, self.number[part.parent], len(self.R)
        Ao = ways.of_rpy(steps, part.rpy, part.rotation)
        A, p, on = self._on_body(part, up) if self.fused else self._on_link(part, up, Ao)
        self.sides.append(Placed(on.body, ways.placed(on.A), on.p) if self.fused else Placed(up, Ao, part.position))
        if self.fused:
            up = self.parent[link] = self.placed[up].body
        which, parent = "of a moving joint" if part.moves else "of a fixed joint", (self.attitudes[up], self.p[up])
        site, side = f"the product of the parent's pose and a joint's origin: {which}", self.sides[link]
        origin = side.A, side.p
        A, p = multiplied(steps, ways, site, ("the parent's", parent), ("the origin's", lambda: origin), (A, p))
        before = A
        self.of_link.append([])
        if joint is not None and part.axial:
            A, p = self._axial(part, joint, link, up, A, p, Ao)
        elif joint is not None and part.type == "floating":
            k = joint.q.start
            p = p + steps.turn("the position of a joint that floats", ways.matrix(A), self.q[..., k : k + 3])
            A = ways.then(A, self._quaternion(joint, "a joint that floats"))
            self._six(joint, link, up)
        elif joint is not None and part.type == "planar":
            A, p = self._planar(joint, link, up, A, p)
        elif part.moves:
            raise UncoveredError(f"a joint of type {part.type}")
        if joint is None or part.axial:
            which = "of the first links" if up == 0 else "of further links"
            of = "a fixed link" if self.fused and not self.of_link[link] else "a link", which
            A, p = from_parent(steps, ways, parent, partial(self.on_parent, link), (A, p), of)
            if part.moves:
                of = "a link, by its joint", "that slides" if part.slides else "that turns"
                A, p = from_parent(steps, ways, parent, partial(self.on_parent, link), (A, p), of)
        self.attitudes.append(A)
        moves = bool(self.of_link[link])
        self.before.append(ways.matrix(before))
        fixed_there = self.fused and not moves
        self.R.append(self.R[up] @ ways.placing.matrix(on.A) if fixed_there else ways.matrix(A))
        self.placed.append(on if fixed_there else Placed(link, ways.placing.start(), np.zeros((1, 1, 3))))
        self.p.append(p)

    def _on_link(self, part: Part, up: int, Ao: np.ndarray) -> tuple[np.ndarray, np.ndarray, Placed]:
        """Where the fixed side of a joint is, from the pose of the link that it is on."""
        steps, ways = self.steps, self.ways
        Ap, Rp, at = self._carrying(len(self.R), up, part.moves)
        which = "of a moving joint" if part.moves else "of a fixed joint"
        both = ways.then(Ap, Ao)
        further = {"by its own rpy too": lambda: ways.matrix(both)}
        from_centre = {"counted from the parent's centre of mass": part.position - self.centre(up) + 0 * at}
        origin = steps.pick(f"xyz of a joint's origin: {which}", part.position + 0 * at, **from_centre)
        xyz = steps.turn(f"xyz: {which}", Rp, origin, **further)
        p = steps.add(f"the position of an origin: {which}", **{"that of the parent": at, "xyz": xyz})
        A = self._oriented(f"the orientation of an origin: {which}", Ap, Ao, both, self.ways)
        return A, p, self.placed[0]

    def _carrying(self, link: int, up: int, moves: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the link that carries a joint: orientation, matrix and position."""
        if not moves:
            return self.attitudes[up], self.R[up], self.p[up]
        others = {
            f"the one before in the list{self.listing}": self.before_in_list(link), "the root": 0,
            "the parent's parent": max(0, self.parent[up]),
        }  # fmt: skip

        def built(site: str, x: np.ndarray, of: list[np.ndarray]) -> np.ndarray:
            return np.asarray(self.steps.pick(site, x, **{words: of[k] for words, k in others.items()}))

        site, frame = "the link on which a moving joint is placed", "the frame in which a moving joint has its place"
        A, R, p = (built(site, of[up], of) for of in (self.attitudes, self.R, self.p))
        R, p = built(frame, R, self.R), built(frame, p, self.p)
        A = built("the orientation of what carries a moving joint", A, self.attitudes)
        return A, R, built("the position of what carries a moving joint", p, self.p)

    def _oriented(self, site: str, Ap: np.ndarray, Ao: np.ndarray, both: np.ndarray, ways: Ways) -> np.ndarray:
        others = {
            "multiplied in the other order": lambda: ways.then(Ao, Ap), "that of rpy alone": Ao,
            "that of the parent times the transposed one of rpy": lambda: ways.then(Ap, ways.inverse(Ao)),
            "that of the parent alone": Ap,
            "that of the parent, transposed, times that of rpy": lambda: ways.then(ways.inverse(Ap), Ao),
        }  # fmt: skip
        return np.asarray(self.steps.pick(site, both, **others))

    def _on_body(self, part: Part, up: int) -> tuple[np.ndarray, np.ndarray, Placed]:
        """The same from the pose of the body that carries that link, on which it was placed when the file was read."""
        steps, ways, there = self.steps, self.ways, self.placed[up]
        placing = ways.placing
        Ao = placing.of_rpy(steps, part.rpy, part.rotation)
        which = "of a moving joint" if part.moves else "of a fixed joint"
        both = placing.then(there.A, Ao)
        further = {"by its own rpy too": lambda: placing.matrix(both)}
        xyz = steps.turn(f"xyz: {which}", placing.matrix(there.A), part.position[None, None], **further)
        r = steps.add(f"the position of an origin on its body: {which}", **{"that of the parent": there.p, "xyz": xyz})
        local = self._oriented(f"the orientation of an origin: {which}", there.A, Ao, both, placing)
        on, local = Placed(there.body, local, r), ways.placed(local)
        Ab, Rb, p = self._carrying(len(self.R), there.body, part.moves)
        R = self._oriented(
            f"the orientation of what is fixed on a body: {which}", Ab, local, ways.then(Ab, local), ways
        )
        further = {"by its own rpy too": lambda: Rb @ ways.matrix(local)}
        offset = steps.turn(f"xyz on a body: {which}", Rb, r + 0 * p, **further)
        ends = {"the body's position": p, "the offset": offset}
        return R, steps.add(f"the position of what is fixed on a body: {which}", **ends), on

    def _axial(
        self, part: Part, joint: Joint, link: int, up: int, A: np.ndarray, p: np.ndarray, Ao: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
        steps, ways, Ap, start = self.steps, self.ways, self.attitudes[up], (A, p)
        which = "sliding" if part.slides else "turning"
        x = self.q[..., joint.q.start]
        x = steps.pick(f"the position q: of a {which} joint", x, **self._of_other_joints(link, up, x))
        ratio, offset = (float(c) for c in joint.coupling)
        follows = joint.mimic is not None
        if follows:
            terms = {"multiplier times q": ratio * x, "offset": offset + 0 * x}
            x = steps.add("the position of a joint that follows", **terms)
        x = part.rate * x
        axis = part.unit_axis[None, None]
        raw, own = _lengths(part.unit_axis if part.axis is None else part.axis, axis), ways.own or steps
        if raw:
            axis = own.pick("the axis of a joint", axis, **raw)
        always = {f"{x}, whatever it is": e[None, None] for x, e in zip("xyz", ONE, strict=True)}
        always["turned into the world's axes"] = product(ways.matrix(A), axis + 0 * p)
        about = own.pick("the axis in a joint's rotation", axis, **raw, **always)
        others = {"by the parent's rotation, without its own rpy": lambda: self.R[up]}
        z = None
        if self.early:
            site = "the axis of a joint, kept in world axes for all its uses,"
            columns = [steps.turn(site, ways.matrix(A), e + 0 * p, **others) for e in ONE]
            self.kept[link] = np.stack(np.broadcast_arrays(*columns), -1)
            z = product(self.kept[link], axis + 0 * p)
        if part.slides:
            along = z
            if along is None:
                others["by its own rpy transposed"] = lambda: self.R[up] @ transposed(ways.matrix(self.sides[link].A))
                along = steps.turn("the direction of a sliding joint", ways.matrix(A), axis + 0 * p, **others)
            self.travel[link] = along * x[..., None]
            self._motions[link] = ways.start(), axis * x[..., None]
            p = steps.pick(
                "the origin of a sliding joint", p, **{"that of the link on which it is": self.p[up] + 0 * p}
            )
            p = steps.add("the position of a sliding joint", **{"its origin": p, "a q": self.travel[link]})
            before, turned = A, {"that of its origin turned by q about the axis": lambda: ways.then(
                before, ways.of_axis(Steps(), axis, x)
            )}  # fmt: skip
            A = steps.pick("the rotation of a sliding link", A, **turned)
        else:
            T, before = ways.of_axis(steps, about, x), A
            self._motions[link] = T, 0 * axis
            moved = {
                "that of its origin moved along the axis by q":
                    lambda: p + product(ways.matrix(before), axis + 0 * p) * x[..., None]
            }  # fmt: skip
            p = steps.pick("the position of a turning link", p, **moved)
            A = steps.pick(
                "the rotation of a link", ways.then(A, T),
                **{
                    "that with the joint's turn before its rpy": lambda: ways.then(ways.then(Ap, T), Ao),
                    "that with the joint's turn multiplied from the left": lambda: ways.then(T, before),
                    "that with the joint's turn transposed": lambda: ways.then(before, ways.inverse(T)),
                    "that without the joint's turn": lambda: before + 0 * T, "that of the joint's turn alone": T,
                },
            )  # fmt: skip
        again = {"turned by its own rpy once more": lambda A=A: ways.then(A, Ao)}
        A = steps.pick("the rotation of a link, behind its joint,", A, **again)
        self._axis(Axis(link, up, part.turns, axis, joint.v.start, part.rate * ratio, follows, world=z))
        other, few = "a turning joint" if part.slides else "a sliding joint", some(steps, ways)

        def of_other() -> Pose:
            turn, slide = (ways.of_axis(Steps(), axis, x), 0 * axis), (ways.start(), axis * x[..., None])
            return times(ways, few(start), turn if part.slides else slide)

        def first() -> Pose:
            side = self.sides[link]
            return times(ways, times(ways, few((Ap, self.p[up])), few(self._motions[link])), few((side.A, side.p)))

        further = {f"that with the motion of {other}": of_other, "that with the motion before the origin": first}
        site, motion = "the product of a joint's origin in the world and its motion", lambda: self._motions[link]
        return multiplied(steps, ways, site, ("the origin's", start), ("the motion's", motion), (A, p), **further)

    def on_parent(self, link: int) -> tuple[np.ndarray, np.ndarray]:
        """Attitude and position of a link on its parent (or on the body that carries that), by one axis at most."""
        side, ways = self.sides[link], self.ways
        T, shift = self._motions.get(link, (ways.start(), np.zeros((1, 1, 3))))
        R = ways.matrix(side.A)
        return ways.then(side.A, T), side.p + product(R, shift + 0 * R[..., 0])

    def _planar(
        self, joint: Joint, link: int, up: int, A: np.ndarray, p: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
        k, v = joint.q.start, joint.v.start
        flat = np.concatenate([self.q[..., k : k + 2], 0 * self.q[..., :1]], -1)
        p = p + self.steps.turn("the position of a planar joint", self.ways.matrix(A), flat)
        for i, (turns, e) in enumerate(((False, ONE[0]), (False, ONE[1]), (True, ONE[2]))):
            self._axis(Axis(link, up, turns, e, v + i))
        return self.ways.then(A, self.ways.of_axis(self.steps, ONE[2][None, None], self.q[..., k + 2])), p

    def centre(self, link: int) -> np.ndarray:
        """Of mass, in the link's axes."""
        body = self.bodies[link]
        return np.zeros(3) if body is None else body.com

    def _of_other_joints(self, link: int, up: int, x: np.ndarray) -> dict[str, np.ndarray]:
        """Positions of the joints before one, on its way from the root and in the list."""
        joints = {j.name: j for j in self.robot}

        def of(k: int) -> np.ndarray:
            joint = joints.get(self.d.parts[k - 1].joint) if k else None
            return self.q[..., joint.q.start] if joint is not None and joint.model.nq == 1 else 0 * x

        while up and not self.of_link[up]:
            up = self.parent[up]
        before = next((k for k in range(link - 1, 0, -1) if self.of_link[k]), 0)
        last = max(k for k, part in enumerate(self.d.parts, 1) if part.joint in joints)
        return {
            "that of the joint before it": of(up),
            f"that of the joint before in the list{self.listing}": of(before),
            f"that of the joint before in the list{self.listing}, of the last one for the first": of(before or last),
        }

    def before_in_list(self, link: int) -> int:
        """The link before in the list, of those that move where fixed ones are merged."""
        return next(k for k in range(link - 1, -1, -1) if not self.fused or k == 0 or self.of_link[k])

    # what the formulas take

    @cached_property
    def bodies(self) -> list[Body | None]:
        """Of each link; of links that are merged, in the one that carries them."""
        d = merged(self.d) if self.fused else self.d
        return [d.base, *(p.body for p in d.parts)]

    def carrier(self, link: int) -> int:
        """The link that a joint moves and on which this one is fixed, or the root."""
        while link > 0 and not self.of_link[link]:
            link = self.parent[link]
        return link

    def carries(self) -> np.ndarray:
        """(links, axes): whether an axis moves a link."""
        out = np.zeros((len(self.R), len(self.axes)), bool)
        for k in range(len(self.R)):
            if k:
                out[k] = out[self.parent[k]]
            out[k, self.of_link[k]] = True
        return out

    def pose(self, link: int, unit: bool = True) -> np.ndarray:
        """(runs, n, 4, 4); `unit` as of `Ways.seen`."""
        R, p = self.ways.seen(self.attitudes[link], unit), self.p[link]
        H = np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 4, 4), p.dtype)
        H[..., :3, :3], H[..., :3, 3], H[..., 3, 3] = R, p, 1.0
        return H


def _lengths(axis: np.ndarray, right: np.ndarray) -> dict[str, np.ndarray]:
    """An axis that is not divided by its length, or is rounded, where that is another one."""
    if max(np.abs(axis - right).max(), np.abs(np.round(right) - right).max()) < 1e-12:
        return {}
    other = {
        "divided by the square of its length": axis @ axis, "divided by the sum of its entries": axis.sum(),
        "divided by the sum of its entries' absolute values": np.abs(axis).sum(),
        "divided by its largest entry": np.abs(axis).max(), "multiplied by its length": 1 / np.linalg.norm(axis),
    }  # fmt: skip
    found = {"not normalised": axis, **{words: axis / (x if abs(x) > 1e-9 else 1.0) for words, x in other.items()}}
    found["rounded to whole numbers"] = np.round(right[0, 0])
    return {words: x[None, None] for words, x in found.items()}


def stacked(arrays: list[np.ndarray], links: list[int], tail: int) -> np.ndarray:
    """(runs, n, links, ...): of these links, arrays whose last `tail` axes are their own."""
    chosen = [arrays[k] for k in links]
    shapes = {x.shape for x in chosen}
    if len(shapes) > 1:
        shape = np.broadcast_shapes(*shapes)
        chosen = [np.broadcast_to(x, shape) for x in chosen]
    return np.stack(chosen, -1 - tail)
