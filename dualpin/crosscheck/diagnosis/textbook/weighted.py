"""Sums over bodies: centre of mass, momentum and energies.

    G = sum m c / sum m          J_G = sum m J_c / sum m         A_G = sum [I J_w + (c - G) x m J_c;  m J_c]
    T = sum m v_c.v_c / 2 + w.I w / 2                            V = -sum m gravity.c

References: Siciliano et al., Robotics (2009), section 7.1; Orin, Goswami and Lee, Centroidal Dynamics of a Humanoid
Robot, Autonomous Robots 35 (2013); Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.14.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from ...subjects.layout import product, transposed
from ..description import Body
from .attitudes import INERTIAL
from .columns import CENTRE, Columns
from .in_place import KEPT, in_one_array
from .lumps import CARRIED, MISREAD, READ, TURNED
from .poses import Poses, stacked
from .products import IN_MOMENTUM, wedge
from .steps import Slip, Steps, UncoveredError
from .tree import BEFORE
from .turns import ONE

RIGHT = Steps(Slip("", "", ""))
"""Steps at which nothing can go wrong, and nothing is noted."""


MASSLESS = Body(0.0, np.zeros(3), np.zeros(3), ONE, np.zeros((3, 3)))


class Piece(NamedTuple):
    """A link's mass, centre and tensor, in the axes of what carries it."""

    m: np.ndarray
    c: np.ndarray
    I: np.ndarray


def together(pieces: Sequence[Piece]) -> Piece:
    """One body: the arrays of `Piece` have the axes (runs, 1, ...)."""
    if len(pieces) == 1:
        return pieces[0]
    m = sum((p.m for p in pieces[1:]), pieces[0].m)
    c = sum((p.m[..., None] * p.c for p in pieces[1:]), pieces[0].m[..., None] * pieces[0].c) / m[..., None]
    tensors = [p.I + steiners(p.m, p.c - c) for p in pieces]
    return Piece(m, c, sum(tensors[1:], tensors[0]))


class Sums:
    """The bodies of a tree in the world, of what joints move; of all links, where the base floats.

    Attributes
    ----------
    links : list of int
        Of the bodies.
    m : array
        (runs, 1, bodies).
    about : array, optional
        The robot's centre of mass about which momenta are taken, if it is not that of these bodies.
    p, R, r, c : array
        (runs, n, bodies, ...): origins and orientations of the links, the centres of mass from there, and in the world.
    """

    def __init__(
        self, poses: Poses, columns: Columns, steps: Steps, reading: Steps | None = None, rooted: bool = False,
        bare: bool = False,
    ) -> None:  # fmt: skip
        """`rooted` says that links which nothing moves count as bodies too, `bare` that those without mass do."""
        self.poses, self.columns, self.steps, self.reading = poses, columns, steps, reading or RIGHT
        self.about: np.ndarray | None = None
        carries, d = poses.carries(), poses.d
        bodies = [b or MASSLESS for b in (d.base, *(p.body for p in d.parts))]
        every = [(k, b) for k, b in enumerate(bodies) if bare or b.mass > 0]
        counted = [(k, b) for k, b in every if rooted or carries[k].any()]
        self.total = sum(b.mass for _, b in counted)
        self.grounded = sum(b.mass for _, b in every) - self.total
        pieces: dict[int, list[Piece]] = {}
        for k, b in counted:
            pieces.setdefault(poses.placed[k].body if poses.fused else k, []).append(self._piece(k, b))
        self.links, count = list(pieces), len(pieces)
        made = [together(some) for some in pieces.values()]
        one = np.ones((1, 1))
        parts = [steps.part("the bodies", one, k, count) for k in range(count)]
        self.counts = stacked(parts, list(range(count)), 0) * columns.counted(self.links)
        m, com, tensors = (stacked([x[i] for x in made], list(range(count)), i) for i in range(3))
        self.m = self.counts * m
        self.p, self.R = stacked(poses.p, self.links, 1), stacked(poses.R, self.links, 2)
        self.tensors = self.counts[..., None, None] * tensors
        self.steiner = steiners(m, com)
        self.parents = parents = [max(0, poses.parent[k]) for k in self.links]
        others = {
            "by the parent's matrix": lambda: stacked(poses.R, parents, 2),
            BEFORE: lambda: stacked(poses.before, self.links, 2),
        }
        com = steps.components("the centre of mass of a body, in its link's axes,", com)
        self.local = com + 0 * self.p
        there, origin = self._standing("in placing its centre")
        self.r = steps.turn("the centre of mass of a body", there, self.local, **others) + (origin - self.p)
        still = [poses.p[k] - poses.travel.get(k, 0 * poses.p[k]) for k in self.links]
        wrong = {
            "that of the parent": lambda: stacked(poses.p, parents, 1) + 0 * self.p,
            "that of its joint, before it slides": lambda: stacked(still, list(range(len(still))), 1) + 0 * self.p,
        }  # fmt: skip
        p = steps.pick("the origin from which a body's centre is counted", self.p, **wrong)
        c = steps.add("the place of a body's centre", **{"the link's origin": p, "R c": self.r})
        self.c = np.asarray(steps.components("the place of a body's centre, in world axes,", c))

    def _standing(self, where: str) -> tuple[np.ndarray, np.ndarray]:
        """R and p of the frames in which bodies stand, with frames before them on their way from the root."""
        t = self.poses
        up = self.parents
        still = [t.p[k] - t.travel.get(k, 0 * t.p[k]) for k in self.links]

        def both(R: np.ndarray, p: np.ndarray) -> np.ndarray:
            return np.concatenate(np.broadcast_arrays(R, p[..., None] + 0 * R), -1)[..., :4]

        others = {
            "that of its joint, before it moves": lambda: both(
                stacked(t.before, self.links, 2), stacked(still, list(range(len(still))), 1)
            ),
            "that of its parent": lambda: both(stacked(t.R, up, 2), stacked(t.p, up, 1)),
        }  # fmt: skip
        H = self.steps.pick(f"the frame in which a body stands: {where}", both(self.R, self.p), **others)
        return H[..., :3], H[..., 3]

    def _piece(self, link: int, b: Body) -> Piece:
        """A link's body in the axes of what carries it, or in its own."""
        t, ways = self.poses, self.poses.ways
        there = t.placed[link] if t.fused else t.placed[0]
        fixed = t.fused and there.body != link
        ways = ways.placing
        turn = ways.of_rpy(t.steps, b.rpy, b.rotation, INERTIAL)
        J = b.inertia[None, None]

        read = {words: partial(misread, J) for words, misread in MISREAD.items()}
        I = self.reading.congruent(TURNED, ways.matrix(turn), self.reading.pick(READ, J, **read))
        if not fixed:
            return Piece(np.full((1, 1), b.mass), b.com[None, None], I)
        Q = ways.matrix(there.A)
        I = (
            self.reading.congruent(CARRIED, Q, I)
            if self.reading is not RIGHT
            else _rotated(ways.matrix(ways.then(there.A, turn)), J)
        )
        return Piece(np.full((1, 1), b.mass), there.p + product(Q, b.com[None, None] + 0 * there.p), I)

    @cached_property
    def mass(self) -> np.ndarray:
        """What sums are divided by, (runs, 1, 1)."""
        m = self.m[..., None]
        right = m.sum(-2)
        wrong = {
            "the number of bodies": np.full((1, 1, 1), float(len(self.links))), "1, not the mass": np.ones((1, 1, 1)),
            "the number of all links, also of those without mass": np.full((1, 1, 1), float(len(self.poses.p))),
        }  # fmt: skip
        if self.grounded:
            wrong["the mass of all links, also of those that cannot move"] = right + self.grounded
        if self.links[0] == 0:
            wrong["the mass of all links but the base"] = m[..., 1:, :].sum(-2)
        return np.asarray(self.steps.pick("the divisor of the sum over bodies", right, **wrong))

    @cached_property
    def com(self) -> np.ndarray:
        """(runs, n, 3)."""
        m = self.masses("the weight of a body's centre") * self.every("the bodies whose m c is added up")
        c = (m[..., None] * self._paired()).sum(-2) / self.mass
        return np.asarray(self.steps.pick("the centre of mass", c, **self._means()))

    def _paired(self) -> np.ndarray:
        """The centres that masses are paired with."""
        t = self.poses

        def before() -> np.ndarray:
            found = [t.before_in_list(k) if k else 0 for k in self.links]
            centres = [t.p[k] + product(t.R[k], t.centre(k) + 0 * t.p[k]) for k in found]
            return stacked(centres, list(range(len(found))), 1) + 0 * self.c

        wrong = {f"that of the link before in the list{t.listing}": before}
        return np.asarray(self.steps.pick("the centre that a mass is paired with", self.c, **wrong))

    def _means(self) -> dict[str, np.ndarray]:
        """Of centres without their masses: then links that have none count as well, and the root may."""
        t = self.poses
        bare = [] if t.fused else [k for k, some in enumerate(t.carries()) if some.any() and k not in self.links]
        every, count, found = self.c.sum(-2), len(self.links) + len(bare), dict[str, np.ndarray]()
        if bare:
            every = every + stacked(t.p, bare, 1).sum(-2)
            found["the mean of all links that move, of those without mass too"] = every / count
        if self.links[0] and 0 not in bare:
            base = np.zeros(3) if t.d.base is None else t.d.base.com
            root = t.p[0] + product(t.R[0], base + 0 * t.p[0])
            found["the mean of all links, of the root too"] = (every + root) / (count + 1)
        return found

    @cached_property
    def by_axes(self) -> np.ndarray:
        """(runs, n, bodies, 6, axes), of the bodies' centres."""
        wrong = {"R c alone, without the link's origin": self.r}
        J = self.columns.at(self.steps.pick("the point of a body's Jacobian", self.c, **wrong), self.links, CENTRE)
        J, moved = np.broadcast_arrays(J, self.columns.moving(self.links).astype(float))
        return self.steps.pick("the array of a body's Jacobian", J, **{KEPT: lambda: in_one_array(J, moved)})

    @cached_property
    def jacobians(self) -> np.ndarray:
        """(runs, n, bodies, 6, nv)."""
        return self.columns.reduced(self.by_axes)

    def com_jacobian(self) -> np.ndarray:
        m = self.masses("the weight of a body's Jacobian") * self.every("the bodies whose m Jv is added up")
        other = {"its angular ones": self.jacobians[..., :3, :]}
        Jv = self.steps.pick("the rows of a body's Jacobian that are added up", self.jacobians[..., 3:, :], **other)
        return np.asarray((m[..., None, None] * Jv).sum(-3) / self.mass[..., None])

    def masses(self, site: str) -> np.ndarray:
        """(runs, 1, bodies), with what else is taken for them."""
        m = self.m
        wrong = {"1": self.counts}
        if len(self.links) > 1:
            wrong |= {
                "that of the body before": np.roll(m, 1, -1), "that of the next body": np.roll(m, -1, -1),
                "the mean mass": 0 * m + m.mean(-1, keepdims=True), "its square": m * m,
            }  # fmt: skip
        return np.asarray(self.steps.pick(site, m, **wrong))

    def every(self, site: str) -> np.ndarray:
        """One for each body (runs, 1, bodies): slips lose some of them."""
        count, one = len(self.links), np.ones((1, 1))
        ones = [self.steps.part(site, one, k, count, alone=True) for k in range(count)]
        return stacked(ones, list(range(count)), 0)

    # momentum

    @cached_property
    def inertia(self) -> np.ndarray:
        """Of each body about its centre, in world axes (runs, n, bodies, 3, 3)."""
        tensors = self.tensors
        wrong = {
            "that about the link's origin": lambda: tensors + self.steiner, "zero, as of a point": 0 * tensors,
            "its diagonal alone": tensors * ONE,
        }  # fmt: skip
        I = self.steps.pick("the tensor of a body", tensors, **wrong)
        there, _ = self._standing("in turning its tensor")
        return np.asarray(self.steps.congruent("the inertia of a body", there, I))

    def momentum(self) -> np.ndarray:
        """(runs, n, 6, nv): about the centre of mass, in world axes."""
        steps, rows = self.steps, transposed(self.jacobians)
        w, v = rows[..., :3], rows[..., 3:]
        root, G = self.poses.p[0][..., None, :], (self.com if self.about is None else self.about)[..., None, :]
        means = {"the mean of the bodies' centres": self.c.mean(-2), **self._means()}
        means = {words: x[..., None, :] + 0 * G for words, x in means.items()}
        G = steps.pick("the robot's centre of mass, in the arm of a momentum,", G, **means)
        ends = {"the body's centre": self.c, "the robot's centre of mass": -G}
        arm = steps.add("the arm of a body's momentum", **ends)
        wrong = {
            "counted from the root link": self.c - root,
            "that of the link's origin": self.p - G,
            "R c alone": self.r,
        }
        arm = steps.pick("the whole arm of a body's momentum", arm, **wrong)
        spin, mv, orbit = (
            (self.masses(f"the mass in a momentum: in {of}") if "m" in of else 1.0) * self.every(f"the momenta: {of}")
            for of in ("I w", "m v", "r x m v")
        )
        arm, mv, orbit = arm[..., None, :] + 0 * v, mv[..., None, None] * v, orbit[..., None, None] * v
        parts = {
            "I w": spin[..., None, None] * (w @ transposed(self.inertia)),
            "r x m v": wedge(steps, arm + 0 * orbit, orbit + 0 * arm, IN_MOMENTUM),
        }
        both = self.every("the angular momenta")[..., None, None]
        angular = (both * steps.add("the angular momentum of a body", **parts)).sum(-3)
        linear = steps.add("the linear momentum of a body", **{"m v": mv}).sum(-3)
        angular = steps.add("the angular rows of the momentum", **{"sum I w + r x m v": angular})
        return transposed(np.concatenate(np.broadcast_arrays(angular, linear), -1))

    # energies, by the velocities of links

    def centre_velocities(self) -> tuple[np.ndarray, np.ndarray]:
        """w of each body, and the velocity of its centre."""
        if self.columns.by_product:
            assert self.poses.qd is not None
            J = self.columns.reduced(self.columns.carried(self.by_axes))
            motion = product(J, self.poses.qd[..., None, :])
            return motion[..., :3], motion[..., 3:]
        w, v = (stacked(x, self.links, 1) for x in (self.columns.w, self.columns.v))
        arms = {
            "c, not turned": self.local + 0 * self.r, "that from the world's origin": self.c,
            "the sum of the positions of centre and origin, not their difference": self.c + self.p,
        }  # fmt: skip
        r = self.steps.pick("the arm in w x R c", self.r, **arms)
        parents = {"the parent's": lambda: stacked(self.columns.w, self.parents, 1) + 0 * w}
        about = self.steps.pick("the angular velocity that carries a centre of mass", w, **parents)
        terms = {"that of the link's origin": v, "w x R c": wedge(self.steps, about + 0 * r, r + 0 * w)}
        return w, self.steps.add("the velocity of a body's centre", **terms)

    def kinetic_energy(self) -> np.ndarray:
        w, v = self.centre_velocities()
        parents = {"the parent's": lambda: stacked(self.columns.w, self.parents, 1) + 0 * w}
        parents["that of the body before in the list"] = lambda: np.concatenate([0 * w[..., :1, :], w[..., :-1, :]], -2)
        sides = ("its first", "its second")
        one, two = (self.steps.pick(f"the angular velocity in w . I w: {x}", w, **parents) for x in sides)
        turning = (one * product(self.inertia, two)).sum(-1)
        mean = np.trace(self.inertia, axis1=-2, axis2=-1) / 3 * (w * w).sum(-1)
        turning = self.steps.pick("w . I w in the kinetic energy", turning, **{"that of the mean of its moments": mean})
        m = self.masses("the mass in the kinetic energy") * self.every("the kinetic energies: m v.v / 2")
        turning = turning * self.every("the kinetic energies: w.I w / 2")
        vv = (v * v).sum(-1)
        vv = self.steps.pick("v.v in the kinetic energy", vv, **{"|v|, not squared": lambda: np.sqrt(vv)})
        parts = {"m v.v / 2": m * vv / 2, "w.I w / 2": turning / 2}
        assert self.poses.qd is not None
        rotors = (self.rotors * self.poses.qd**2).sum(-1) / 2
        return np.asarray(self.steps.add("the kinetic energy", **parts).sum(-1) + rotors)

    def potential_energy(self, g: np.ndarray) -> np.ndarray:
        root = self.poses.p[0][..., None, :]
        wrong = {
            "counted from the root link": self.c - root, "counted from its link's origin": self.r,
            "counted from the first body's centre": self.c - self.c[..., :1, :],
        }  # fmt: skip
        c = self.steps.pick("the place of a body, whose height counts,", self._paired(), **wrong)
        m = self.masses("the mass in the potential energy") * self.every("the potential energies")
        heights = c @ g
        distance = {"-|g| |c|, of the distance from the world's origin": lambda: -np.linalg.norm(g) * _length(c)}
        heights = self.steps.pick("g.c in the potential energy", heights, **distance)
        V = self.steps.add("the potential energy", **{"-m g.c": -(m * heights).sum(-1)})
        more = 1 + self.grounded / self.total
        wrong = {"that of all links, also of those that cannot move": V * more} if self.grounded else {}
        return np.asarray(self.steps.pick("the mass whose height is that of the centre of mass", V, **wrong))

    @cached_property
    def rotors(self) -> np.ndarray:
        """Inertias of rotors, by the columns of v."""
        joints, out = {j.name: j for j in self.poses.robot}, np.zeros(self.poses.robot.nv)
        for part in (p for p in self.poses.d.parts if any(p.armature)):
            joint = joints.get(part.joint)
            if joint is None or joint.mimic is not None:
                raise UncoveredError("rotors of joints with coordinates of their own only")
            out[joint.v] = part.armature
        return out


def _length(x: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt((x * x).sum(-1)))  # not `norm`: of complex steps too


def _rotated(R: np.ndarray, I: np.ndarray) -> np.ndarray:
    return np.asarray(R @ I @ transposed(R))


def steiners(m: np.ndarray, c: np.ndarray) -> np.ndarray:
    """m (c.c 1 - c c^T), (..., 3, 3)."""
    return np.asarray(m[..., None, None] * ((c * c).sum(-1)[..., None, None] * ONE - c[..., :, None] * c[..., None, :]))
