"""Geometric Jacobians of points, column by column, and their rates, as textbooks write them.

    turning: [z; z x (p_e - p_i)]        rate: [zd; zd x (p_e - p_i) + z x (v_e - v_i)]        zd = w x z
    sliding: [0; z]                      rate: [0; zd]

A floating base turns about three axes of its own and slides along them.  Arrays have the axes (runs, samples, points,
axes, ...), see `Steps.together`.

References: Siciliano et al., Robotics (2009), section 3.1.3; Orin and Schrader, Efficient Computation of the Jacobian
for Robot Manipulators, IJRR 3 (1984).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial

import numpy as np

from ....spatial.adjoint import cross_matrix
from ...subjects.layout import product, transposed
from .arrays import cross
from .axes import exchanged, moved, of_kind
from .lists import beside
from .poses import Poses, stacked
from .products import wedge
from .references import joined, six
from .steps import Steps
from .velocities import of_origin
from .walks import ENDS, walks

CENTRE, LEVER = "a centre of mass", "the lever arm to a centre of mass"
ACROSS = "z x r"
TO_LINK, TO_CENTRE = "the arm to the link's origin", "R c, from there to the centre of mass,"
MOVING = "the axes that have a column"
HERE = f"{MOVING}: in a Jacobian, not in its rate"
UNCOUNTED = " (links without one do not count)"


class Columns:
    """The axes of a tree in the world, and the Jacobians of points that are on its links.

    Attributes
    ----------
    z, o : array
        (runs, n, axes, 3): directions of the axes, and origins of the links that they move.
    w, v : list of array
        Motions of the links: from link to link, or `by_jacobians`.
    by_parents : bool
        Whether axes turn by w of their parents, not of their own links: w x z is the same for both.
    by_origins : bool
        Whether velocities of joints' origins are made of those of the links on which they are.
    world : (bool, bool)
        Whether the subject writes the base's columns for angular and linear velocities in world axes.
    """

    def __init__(self, poses: Poses, steps: Steps, world: tuple[bool, bool] = (False, False)) -> None:
        self.poses, self.steps, self.axes, self.world = poses, steps, poses.axes, world
        self.links, self.parents = [a.link for a in self.axes], [max(0, a.parent) for a in self.axes]
        base = [i for i, a in enumerate(self.axes) if a.base]
        joints = [i for i, a in enumerate(self.axes) if not a.base]
        self.groups = [(g, w) for g, w in ((base, "of the base"), (joints, "of joints")) if g]
        self.turns = np.array([float(a.turns) for a in self.axes])
        self.order = np.argsort(base + joints)
        self.before = np.array([self._before(i) for i in range(len(self.axes))], int)
        self.after = np.array([self._after(i) for i in range(len(self.axes))], int)
        self.listed, self.follow = beside(poses.parent, self.links, (self.before, self.after))
        self.o = stacked(poses.p, self.links, 1)
        self.z = self._whole([self._directions(g, which) for g, which in self.groups], -2)
        self.w, self.v, self.by_product, self.by_parents, self.by_origins = poses.w, poses.v, False, False, False

    def by_jacobians(self) -> Columns:
        """With the motions of links as the product of their Jacobians and the velocity; the root's is given."""
        t, qd = self.poses, self.poses.qd
        assert qd is not None
        links = list(range(len(t.p)))
        J = self.reduced(self.carried(self.at(stacked(t.p, links, 1), links)))
        motion = np.moveaxis(product(J, qd[..., None, :]), -2, 0)
        self.w, self.v = [t.w[0], *motion[1:, ..., :3]], [t.v[0], *motion[1:, ..., 3:]]
        self.by_product = True
        return self

    def carried(self, J: np.ndarray) -> np.ndarray:
        """Columns as they make velocities."""
        if self.turns.all():
            return J
        still = {"zero, as if it stood still": lambda: J * self.turns}
        return np.asarray(
            self.steps.pick("the velocity of what a sliding joint carries, in rates of columns,", J, **still)
        )

    def _whole(self, parts: list[np.ndarray], axis: int) -> np.ndarray:
        """Base and joints, in the order of the axes."""
        if len(parts) == 1:
            return parts[0]
        return np.take(joined(parts, axis), self.order, axis)

    def _directions(self, group: list[int], which: str) -> np.ndarray:
        """z = R a, in world axes."""
        a = stacked([self.axes[i].direction for i in group], list(range(len(group))), 1)
        kept = [self.axes[i].world for i in group]
        R = stacked(self.poses.R, [self.links[i] for i in group], 2)
        parents = [self.parents[i] for i in group]
        t, of_links = self.poses, [self.links[i] for i in group]
        others = {
            "by the parent's rotation, without its own rpy": lambda: stacked(t.R, parents, 2),
            "by its own rpy, without the parent's rotation": (
                lambda: stacked([t.ways.matrix(x.A) for x in t.sides], of_links, 2)
            ),
            "by the rotation of its origin, transposed": lambda: transposed(stacked(t.before, of_links, 2)),
        }
        a = a + 0 * R[..., 0]
        if group and self.axes[group[0]].base:
            R = stacked([t.given[not self.axes[i].turns] for i in group], list(range(len(group))), 2)
            return self.steps.turn("the axis of a base's column", R, a)
        turns = self.turns[group, None]
        kinds = [(kind, mask) for kind, mask in (("turning", turns), ("sliding", 1 - turns)) if mask.any()]
        z = sum(
            mask * self.steps.turn(f"the axis of a column: of {kind} joints", R, a, **others) for kind, mask in kinds
        )
        for k, x in enumerate(kept):
            if x is not None:
                z = z + 0 * x[..., None, :]
                z[..., k, :] = x
        o = self.o[..., group, :]
        wrong = {
            "the joint before": lambda: moved(group, z, self.before),
            "the next joint": lambda: moved(group, z, self.after, None),
            "the first joint": lambda: z[..., :1, :] + 0 * z,
            **{words: partial(moved, group, z, to, 0.0) for words, to in self.listed.items()},
            **{words: partial(moved, group, z, to, None) for words, to in self.follow.items()},
        }
        z = np.asarray(self.steps.pick("the joint whose axis is in a column", z, **wrong))
        point = {"a point, with the position of its origin added": lambda: z + o}
        point |= {f"that of the link's {'xyz'[k]} axis": R[..., k] + 0 * z for k in range(3)}
        return np.asarray(self.steps.pick("the direction in a column, of joints,", z, **point))

    def _before(self, i: int) -> int:
        """The axis of the nearest joint below, or -1."""
        k = self.poses.parent[self.links[i]]
        while k >= 0:
            if self.poses.of_link[k]:
                return self.poses.of_link[k][-1]
            k = self.poses.parent[k]
        return -1

    def _after(self, i: int) -> int:
        return next((j for j in range(len(self.axes)) if j > i and self._before(j) == i), -1)

    # columns

    def at(self, points: np.ndarray, links: Sequence[int], whose: str = "a frame") -> np.ndarray:
        """(runs, n, points, 6, axes): [w; v] of points (runs, n, points, 3) of links, by the rate of each axis."""
        J = self._whole([self._columns(points, links, g, which, whose) for g, which in self.groups], -1)
        J, found = J * self.moving(links, HERE), self._walks(list(links))
        halves = []
        for rows, at in (("angular", slice(0, 3)), ("linear", slice(3, 6))):
            x = J[..., at, :]
            wrong = {name: partial(np.multiply, x, found[name][None, None, :, None]) for name in ENDS}
            wrong["each with the axis of the last one"] = partial(self._of_last, points, links, J, at)
            halves.append(self.steps.pick(f"the joints that have {rows} rows in a Jacobian", x, **wrong))
        return joined(halves, -2)

    def _of_last(self, points: np.ndarray, links: Sequence[int], J: np.ndarray, rows: slice) -> np.ndarray:
        """These rows, where turning joints all have the axis of the last joint which moves the point."""
        moving, few = self.poses.carries()[list(links)], self.steps.few
        z = few(self.z)[..., [max(np.flatnonzero(k), default=0) for k in moving], None, :]
        r = few(points)[..., None, :] - few(self.o)[..., None, :, :]
        turning = np.swapaxes(six(z + 0 * r, cross(z, r)), -1, -2)
        return np.where((moving * self.turns)[:, None, :] > 0, turning, few(J))[..., rows, :]

    def _columns(
        self, points: np.ndarray, links: Sequence[int], group: list[int], which: str, whose: str
    ) -> np.ndarray:  # fmt: skip
        steps, p = self.steps, points[..., None, :]
        z, o = self.z[..., None, group, :], self.o[..., None, group, :]
        if not self.axes[group[0]].base:
            carriers = [self.poses.carrier(k) for k in links]
            wrong = {
                "that of the link on which the point is": lambda: self._seen(links, group) + 0 * z,
                "that of the link that carries the point": lambda: self._seen(carriers, group) + 0 * z,
            }
            z = steps.pick("the matrix that turns an axis in a column", z, **wrong)
        arm = p - o
        if whose == CENTRE:
            to_link = stacked(self.poses.p, list(links), 1)[..., None, :]
            arm = steps.add(f"{LEVER}: {which}", **{TO_LINK: to_link - o, TO_CENTRE: p - to_link})
        r = steps.pick(f"the lever arm of a column: {which}: to {whose}", arm, **self._arms(group, links, p, o))
        lever = steps.add(f"the linear part of a turning column: {which}", **{ACROSS: wedge(steps, z, r)})
        lever = steps.pick(f"the product z x r in a column: {which}", lever, **{"taken entry by entry": z * r})
        z = z + np.zeros_like(lever)
        own = {"in its link's axes": lambda: self._own(group) + 0 * z}
        angular = steps.pick(f"the axis in the angular part of a column: {which}", z, **own)
        if self.axes[group[0]].base:
            angular, lever = exchanged(steps, z, r, lever, self.world[0])
        J = of_kind(steps, which, self.turns[group, None], (angular, lever, z, r, o))
        return np.swapaxes(J, -1, -2)

    def _own(self, group: list[int]) -> np.ndarray:
        """(runs, n, 1, axes, 3): the axes of this group, in their links' axes."""
        return stacked([self.axes[i].direction for i in group], list(range(len(group))), 1)[:, :, None]

    def _seen(self, links: Sequence[int], group: list[int]) -> np.ndarray:
        """(runs, n, points, axes, 3): the axes of this group, turned by the matrices of other links."""
        a = self._own(group)
        R = stacked(self.poses.R, list(links), 2)[..., None, :, :]
        return product(R, a + 0 * R[..., 0])

    def _carriers(self, links: Sequence[int], of: Sequence[np.ndarray]) -> np.ndarray:
        """Of the links on which points are: where fixed links are merged, of those that joints move."""
        return stacked(list(of), [self.poses.carrier(k) if self.poses.fused else k for k in links], 1)

    def _arms(self, group: list[int], links: Sequence[int], p: np.ndarray, o: np.ndarray) -> dict[str, object]:
        """Other lever arms."""
        t, few = self.poses, self.steps.few
        found: dict[str, object] = {
            "counted from the world's origin": lambda: few(p) + 0 * few(o),
            "counted from the joint to the world's origin": lambda: -few(o) + 0 * few(p),
            "the sum of both positions, not their difference": lambda: few(p) + few(o),
        }  # fmt: skip
        if not self.axes[group[0]].base:
            parents = [self.parents[i] for i in group]

            def counted(to: np.ndarray) -> np.ndarray:
                root = few(t.p[0])[..., None, :]
                from_root = few(o)[..., 0, :, :] - root  # a joint without another one has the root before it
                return few(p) - (root + moved(group, from_root, to, 0.0))[..., None, :, :]

            def counted_from(x: Callable[[], np.ndarray]) -> Callable[[], np.ndarray]:
                return lambda: few(p) - few(x()) + 0 * few(o)

            found |= {
                "counted from the root link": counted_from(lambda: t.p[0][..., None, None, :]),
                "counted from the joint's parent link": counted_from(lambda: stacked(t.p, parents, 1)[..., None, :, :]),
                "counted from the joint before": partial(counted, self.before),
                "counted from the next joint": partial(counted, self.after),
                "that of the joint itself from the world's origin": lambda: few(o) + 0 * few(p),
                "counted from the first joint": counted_from(lambda: o[..., :1, :]),
                "counted from the centre of mass of the joint's link": counted_from(lambda: self._centres(group)),
                "counted to the origin of the link that carries the point": (
                    lambda: few(self._carriers(links, t.p))[..., None, :] - few(o) + 0 * few(p)
                ),
                **{f"counted from {w}": partial(counted, to) for w, to in (self.listed | self.follow).items()},
            }  # fmt: skip
        return found

    def _centres(self, group: list[int]) -> np.ndarray:
        """(runs, n, 1, axes, 3): the centres of mass of the links that joints move."""
        t, links = self.poses, [self.links[i] for i in group]
        there = product(stacked(t.R, links, 2), np.stack([t.centre(k) for k in links]))
        return (stacked(t.p, links, 1) + there)[..., None, :, :]

    def moving(self, links: Sequence[int], site: str = MOVING) -> np.ndarray:
        """(runs, 1, points, 1, axes): whether an axis moves a point."""
        right = self.poses.carries()[list(links)][None, None, :, None]
        wrong = {name: x[None, None, :, None] for name, x in self._walks(list(links)).items()}
        found = self.steps.pick(site, right, **wrong)
        return np.asarray(self.steps.mistaken(site, found, **{x + UNCOUNTED: wrong[x] for x in self._uncounted}))

    def counted(self, links: Sequence[int]) -> np.ndarray:
        """(runs, 1, links): whether links count as bodies, where this is seen from the same walk."""
        shaped = {name + UNCOUNTED: x[None, None, list(links)] for name, x in self._uncounted.items()}
        return np.asarray(self.steps.mistaken(HERE, np.ones((1, 1, len(links)), bool), **shaped))

    @cached_property
    def _uncounted(self) -> dict[str, np.ndarray]:
        """Walks that find no axis for some link that moves: of all links, whether they find one."""
        moves, every = self.poses.carries().any(1), list(range(len(self.poses.R)))
        found = {name: x.any(1) for name, x in self._walks(every).items()}
        return {name: np.asarray(some | ~moves) for name, some in found.items() if (moves & ~some).any()}

    def _walks(self, links: list[int]) -> dict[str, np.ndarray]:
        return walks(self.poses, np.array([a.base for a in self.axes], bool), self.before, links)

    def rates(
        self, points: np.ndarray, velocities: np.ndarray, links: Sequence[int], whose: str = "a frame"
    ) -> np.ndarray:  # fmt: skip
        """(runs, n, points, 6, axes): d/dt of `at`, for points that move with these velocities.

        Of a base whose columns are in world axes without the turning of these columns, J T as in `turning`.
        """
        D = self._whole([self._rates(points, velocities, links, g, which, whose) for g, which in self.groups], -1)
        walks = {name: x[None, None, :, None] for name, x in self._walks(list(links)).items() if name in ENDS}
        return D * self.steps.pick(f"{MOVING}: in its rate alone", self.moving(links), **walks)

    @cached_property
    def turning(self) -> np.ndarray:
        """T (1, n, nv, nv) of J_w dR/dt = J T: what a base's own axes have besides those of the world, J_w = J R^T."""
        qd = self.poses.qd
        assert qd is not None
        T = np.zeros((*qd.shape, qd.shape[-1]))
        for k in (0, 1):
            if self.world[k] and self.axes[0].base:
                T[..., 3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = cross_matrix(qd[..., :3])
        return T

    def _rates(
        self, points: np.ndarray, velocities: np.ndarray, links: Sequence[int], group: list[int], which: str, whose: str
    ) -> np.ndarray:  # fmt: skip
        steps, mine = self.steps, [self.links[i] for i in group]
        z, o, p = self.z[..., None, group, :], self.o[..., None, group, :], points[..., None, :]
        turning = [self.parents[i] for i in group] if self.by_parents else mine
        w, u = stacked(self.w, turning, 1)[..., None, :, :], stacked(self.v, mine, 1)[..., None, :, :]
        frames = stacked(self.w, list(links), 1)[..., :, None, :]
        arms = self._arms(group, links, p, o)
        r = steps.pick(f"the lever arm in the rate of a column: {which}: to {whose}", p - o, **arms)
        w = steps.pick(
            f"the angular velocity that turns an axis: {which}", w,
            **{"that of the frame's link": frames + 0 * w, "that of the axis against the frame": w - frames,
               "that of the root": self.w[0][..., None, None, :] + 0 * w,
               **self._others(group, self.w, w)},
        )  # fmt: skip
        if not self.axes[group[0]].base:
            z = self._in_rate(z, group)
        ends = velocities[..., None, :] + 0 * u
        body_w, body_v, body_p = (self._carriers(links, x)[..., None, :] for x in (self.w, self.v, self.poses.p))
        wrong = {
            "that of its body's origin": body_v + 0 * ends,
            "that of its body's origin with w x p added, not w x r": body_v + cross(body_w, p) + 0 * ends,
            "that of its body's origin with r x w added, not w x r": body_v - cross(body_w, p - body_p) + 0 * ends,
            "w x r alone, without that of its body's origin": cross(body_w, p - body_p) + 0 * ends,
            "that of its body's origin with w x the sum of both positions":
                body_v + cross(body_w, p + body_p) + 0 * ends,
            "that of the centre of mass of its link": lambda: self._of_centres(list(links))[..., None, :] + 0 * ends,
        }  # fmt: skip
        ends = steps.pick(f"the velocity of the end of a lever arm: at {whose}", ends, **wrong)
        if self.by_origins and not self.axes[group[0]].base:
            on = [self.parents[i] for i in group]
            up_w, up_v, up_p = (stacked(x, on, 1)[..., None, :, :] for x in (self.w, self.v, self.poses.p))
            u = of_origin(steps, up_w, up_v, up_p, o)
        others = self._others(group, self.v, u)
        if others:
            others["that of the centre of mass of its link"] = lambda: self._of_centres(mine)[..., None, :, :] + 0 * u
        u = steps.pick(f"the velocity of a joint in the rate of a lever arm: {which}", u, **others)
        still = np.array([self.axes[i].base and self.world[not self.axes[i].turns] for i in group])
        turned = 0 * cross(w, z)
        if not still.all():  # those that are axes of the world do not turn, for now
            turned = ~still[:, None] * steps.add(f"the rate of an axis: {which}", **{"w x z": wedge(steps, w, z)})
        terms = {"the velocity of its end": ends, "the velocity of the joint": -u}
        moving = steps.add(f"the rate of the lever arm: {which}: to {whose}", **terms)
        zero = np.zeros_like(turned + moving)
        lever = {"z x dr/dt": wedge(steps, z + zero, moving)}
        if not still[self.turns[group] > 0].all():
            lever = {"(w x z) x r, the turning of the axis,": wedge(steps, turned + zero, r + zero), **lever}
        rate = steps.add(f"the rate of the linear part of a turning column: {which}", **lever)
        column = six(turned + zero, rate)
        linear = {
            "[0; its linear part], without the turning of the axis": six(zero, rate),
            "that of a sliding one": six(zero, turned + zero),
        }  # fmt: skip
        column = steps.pick(f"the rate of a turning column: {which}", column, **linear)
        slide = six(zero, turned + zero)
        if not self.turns[group].all():
            wrong = {"zero": 0 * slide, "that of a turning one": column}
            slide = steps.pick(f"the rate of a sliding column: {which}", slide, **wrong)
        turns = self.turns[group, None]
        return np.swapaxes(turns * column + (1 - turns) * slide, -1, -2)

    def _of_centres(self, links: list[int]) -> np.ndarray:
        """(runs, n, links, 3): the velocities of links' centres of mass."""
        t = self.poses
        w, v = (stacked(x, links, 1) for x in (self.w, self.v))
        r = product(stacked(t.R, links, 2), np.stack([t.centre(k) for k in links]) + 0 * w)
        return np.asarray(v + cross(w + 0 * r, r))

    def _in_rate(self, z: np.ndarray, group: list[int]) -> np.ndarray:
        """The axes of joints, as codes find them again for the rates of columns."""
        a = stacked([self.axes[i].direction for i in group], list(range(len(group))), 1)
        R = stacked(self.poses.R, [self.links[i] for i in group], 2)[..., None, :, :, :]
        a = a[..., None, :, :] + 0 * R[..., 0]
        wrong = {"not turned into world axes": a, "turned by the transposed matrix": product(transposed(R), a)}
        return np.asarray(self.steps.pick("the axis in the rate of a column", z, **wrong))

    def _others(self, group: list[int], of: Sequence[np.ndarray], like: np.ndarray) -> dict[str, object]:
        """What other links have than those that the joints of a group move."""
        if self.axes[group[0]].base:
            return {}
        own = stacked(list(of), self.links, 1)
        found: dict[str, object] = {
            "that of its parent": stacked(list(of), [self.parents[i] for i in group], 1)[..., None, :, :] + 0 * like
        }
        before = [self.poses.parent[self.parents[i]] for i in group]
        there = stacked(list(of), [max(0, k) for k in before], 1) * (np.array(before) >= 0)[:, None]
        found["that of its parent's parent"] = there[..., None, :, :] + 0 * like
        for words, to in {**self.listed, **self.follow}.items():
            others = own[..., [to[i] for i in group], :] * (to[group] >= 0)[:, None]
            found[f"that of {words}"] = others[..., None, :, :] + 0 * like
        return found

    def reduced(self, J: np.ndarray) -> np.ndarray:
        """The columns of v, of those of the axes; a joint that follows moves with its leader."""
        S = np.zeros((self.steps.rows, len(self.axes), self.poses.robot.nv))
        for i, a in enumerate(self.axes):
            ratio = np.array([a.ratio])
            if a.follows:
                wrong = {"taken without its multiplier": np.ones(1), "left out": np.zeros(1)}
                ratio = self.steps.pick("the column of a joint that follows", ratio, **wrong)
            S[:, i, a.column] = ratio
        return J @ S[:, None, None]
