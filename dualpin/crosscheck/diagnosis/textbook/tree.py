"""The tree of bodies that textbook algorithms walk through: plain arrays, poses from q, and transforms.

All arrays have the axes (runs, samples, ...), see `Steps.together`; those of the tree have one run and one sample.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ....spatial.adjoint import cross_matrix
from ....spatial.inertia import steiner
from ...subjects.convention import base_of
from ...subjects.layout import product, rotations, transposed
from ..case import View
from ..description import Description, Part, merged
from .lists import LISTED, ORDERS
from .lumps import Piece, listed, pieces, products, tensor
from .steps import Steps, UncoveredError

THAT_TURN, THAT_SLIDE = "of links that move: that turn", "of links that move: that slide"
MOVERS, RATES_OF = "the joints whose unit accelerations make M", "the joints whose rates move links"
"""Which of a group of sites are those of a link."""


@dataclass(frozen=True, eq=False)
class Link:
    """A body, and the joint that moves it: from the parent's frame by a placement, then about or along an axis."""

    number: int
    name: str
    parent: int
    """-1 for the root."""
    R: np.ndarray
    p: np.ndarray
    z: np.ndarray
    """The unit axis, in the link's own axes; zero where the link is fixed."""
    slides: bool
    column: int
    """Its place in v; -1 where the link is fixed."""
    place: int
    """Its place in q."""
    mass: float
    c: np.ndarray
    """The centre of mass."""
    I: np.ndarray
    """The inertia about the centre of mass, in the link's axes."""
    pieces: Sequence[Piece] = ()
    """The links that it was made of."""
    length: float = 1.0
    """That of its <axis>, as the file gives it."""
    type: str = ""
    """That of its joint in the file: "revolute", "continuous", ..."""

    @property
    def moves(self) -> bool:
        return self.column >= 0

    def tensor(self, steps: Steps) -> np.ndarray:
        """`I`, from what <inertial> of one or several links says."""
        read = sum((tensor(steps, p) for p in self.pieces), np.zeros((1, 1, 3, 3)))
        return np.asarray(self.I + (read - self._read) + products(steps, self.pieces, self.c[0, 0]))

    @cached_property
    def _read(self) -> np.ndarray:
        return sum((tensor(Steps(), p) for p in self.pieces), np.zeros((1, 1, 3, 3)))

    @cached_property
    def moments(self) -> np.ndarray:
        """The principal moments, the smallest first, as a matrix."""
        return np.diag(np.linalg.eigvalsh(self.I[0, 0]))[None, None]

    @cached_property
    def about_origin(self) -> np.ndarray:
        return np.asarray(self.I + steiner(self.mass, self.c[0, 0]))


@dataclass(frozen=True)
class Pose:
    """Of a link: R and p on its parent, and R0 and p0 in the world."""

    R: np.ndarray
    p: np.ndarray
    R0: np.ndarray
    p0: np.ndarray
    before: np.ndarray | None = None
    """R0 without the turn of the link's own joint, where its axis is turned into the world by that."""

    def axis(self, k: Link) -> np.ndarray:
        """That of a link's joint, in the world."""
        return product(self.turns_axis, k.z)

    @property
    def turns_axis(self) -> np.ndarray:
        return self.R0 if self.before is None else self.before


BEFORE = "by the matrix of its joint, before it turns"


def turned_otherwise(poses: Sequence[Pose], k: Link) -> dict[str, Callable[[], np.ndarray]]:
    """Matrices by which what is on a link may be turned into the world, in the place of its own."""
    on = poses[max(0, k.parent)]
    return {"by the parent's matrix": lambda: on.R0, BEFORE: lambda: on.R0 @ k.R}


def standing_otherwise(poses: Sequence[Pose], k: Link) -> dict[str, Callable[[], np.ndarray]]:
    """Frames in which a body may stand, in the place of its link's."""
    on = poses[max(0, k.parent)]
    return {"that of its parent": lambda: on.R0, "that of its joint, before it moves": lambda: on.R0 @ k.R}


Twist = tuple[np.ndarray, np.ndarray]
"""Angular velocity, and velocity of a link's origin, in world axes."""


class Tree:
    """The links of one description, parents first, branch by branch as in the file; a floating base is the root's.

    Parameters
    ----------
    fused : bool
        Whether fixed links are merged into the bodies that carry them, and are no links any more, as in many codes.
    order : str, optional
        One of `ORDERS` in which links are listed, if not branch by branch.

    Raises
    ------
    ValueError
        For joints that do not have one axis and one coordinate of their own.
    """

    def __init__(self, view: View, fused: bool = False, order: str = "") -> None:
        robot, d = view.jointed, merged(view.description) if fused else view.description
        self.robot, self.description, self.fused = robot, view.description, fused
        made_of = pieces(view.description, fused)
        self.floating, self.nv = base_of(robot) is not None, robot.nv
        self.gravity = np.array(d.gravity)[None, None]
        self.rotors = np.zeros(robot.nv)
        self.links = [replace(_root(d), pieces=made_of.get(d.root, ()))]
        number, joints = {d.root: 0}, {j.name: j for j in robot}
        standing = d.carried()
        for part in listed(d):
            if fused and not part.moves:
                continue
            if fused:  # its place on what carries its parent
                carrier, H = standing[part.parent]
                part = replace(part.placed(H @ part.pose), parent=carrier)
            joint = joints.get(part.joint)
            if joint is not None and (joint.model.nv != 1 or joint.mimic is not None or not part.axial):
                raise UncoveredError("joints with one axis and one coordinate of their own only")
            if np.abs(part.after - np.eye(4)).max() > 0 or part.more.any() or part.rate != 1.0:
                raise UncoveredError("links that stand where their joints move them, by their coordinates only")
            where = (-1, -1) if joint is None else (joint.v.start, joint.q.start)
            link = _link(part, len(self.links), number[part.parent], *where)
            self.links.append(replace(link, pieces=made_of.get(part.link, ())))
            number[part.link] = len(self.links) - 1
            if joint is not None and part.armature:
                self.rotors[joint.v] = part.armature
        self.order = order
        if order:
            listed_so = ORDERS[order]([k.parent for k in self.links])
            at = {-1: -1} | {k: i for i, k in enumerate(listed_so)}
            self.links = [
                replace(x, number=at[x.number], parent=at[x.parent]) for x in map(self.links.__getitem__, listed_so)
            ]
            number = {link: at[k] for link, k in number.items()}
        nowhere = {link: (link, np.eye(4)) for link in standing}
        self.stands = {link: (number[on], H) for link, (on, H) in (standing if fused else nowhere).items()}
        """Of every link: the number of the one that carries it, and its pose there."""
        self.frames = {link: (k, H[:3, 3][None, None]) for link, (k, H) in self.stands.items()}
        self._children: list[list[int]] = [[] for _ in self.links]
        for k in self.links[1:]:
            self._children[k.parent].append(k.number)
        self._poses: tuple[np.ndarray, list[Pose]] | None = None
        self._made: Callable[[np.ndarray], list[Pose]] = self._posed
        self._moved: Callable[[np.ndarray, np.ndarray], list[Twist]] | None = None
        self.right = True
        """Whether poses are those of the description."""

    @cached_property
    def _lists(self) -> dict[str, list[int]]:
        """The links' numbers as codes list them, in different orders."""
        depth_first, order = list(range(len(self.links))), [0]
        for k in order:
            order += self._children[k]
        if self.order:
            return {LISTED[self.order]: depth_first}
        same = order == depth_first
        return {"": order} if same else {" (depth first)": depth_first, " (breadth first)": order}

    def neighbours(self, k: Link) -> dict[str, Link]:
        """The links that move before and after it in the list, which begins again at its end."""
        moving = [link for link in self.links if link.moves]
        at = moving.index(k)
        return {"previous": moving[at - 1], "next": moving[(at + 1) % len(moving)]}

    def near(self, k: Link, of: Callable[[Link], np.ndarray]) -> dict[str, np.ndarray]:
        """What another link has: that before it in a list, a base that moves."""
        found = {"that of the base": of(self.links[0])} if self.floating else {}
        for words, order in self._lists.items():
            at = order.index(k.number)
            found[f"that of the link before in the list{words}"] = of(self.links[order[max(0, at - 1)]])
        return found

    def masses(self, k: Link, m: np.ndarray) -> dict[str, np.ndarray]:
        """Other masses that may stand in the place of a link's."""
        return {"left out": 0 * m + 1, **self.near(k, lambda x: x.mass + 0 * m)}

    def alone(self, k: Link, x: np.ndarray) -> dict[str, np.ndarray]:
        """What a child gives where others overwrite it, or it them."""
        siblings = self._children[k.parent]
        ends = {"that of the last one is left": siblings[-1], "that of the first one is left": siblings[0]}
        if len(siblings) < 2:
            return dict.fromkeys(ends, x)
        return {words: x * float(k.number == last) for words, last in ends.items()}

    @property
    def bodies(self) -> list[Link]:
        return [k for k in self.links if k.mass > 0]

    @property
    def carried(self) -> list[Link]:
        """The bodies that joints move."""
        return [k for k in self.bodies if self.floating or self.joints_of(k)]

    @cached_property
    def first(self) -> frozenset[int]:
        """The numbers of the links that the first joints move, counted from a base that rests."""
        return frozenset(k.number for k in self.links if k.moves and not self.floating and len(self.joints_of(k)) == 1)

    def joints_of(self, link: Link) -> list[Link]:
        """The links whose joints move this one, from the root on."""
        chain: list[Link] = []
        while link.parent >= 0:
            chain += [link] * link.moves
            link = self.links[link.parent]
        return chain[::-1]

    def poses(self, q: np.ndarray) -> list[Pose]:
        """Of all links; the last ones are kept, since many runs ask for the same."""
        if self._poses is None or self._poses[0] is not q:
            self._poses = q, self._made(q)
        return self._poses[1]

    def posed(
        self, made: Callable[[np.ndarray], list[Pose]],
        moved: Callable[[np.ndarray, np.ndarray], list[Twist]] | None = None,
    ) -> Tree:  # fmt: skip
        """The same, with other poses of its links, of q, and with other twists, of q and v."""
        tree = copy(self)
        tree._poses, tree._made, tree._moved, tree.right = None, made, moved, False
        return tree

    @property
    def known(self) -> list[Pose]:
        """The last ones."""
        assert self._poses is not None
        return self._poses[1]

    def twists(self, v: np.ndarray) -> list[Twist] | None:
        """Where they are no matter of the recursion: of all links at the last positions."""
        return self._moved(self._poses[0], v) if self._moved and self._poses else None

    def _posed(self, q: np.ndarray) -> list[Pose]:
        zero = np.zeros((*q.shape[:-1], 3), q.dtype)
        R: np.ndarray = np.eye(3)[None, None]
        p = zero
        if self.floating:
            R, p = rotations(q[..., 3:7]), q[..., :3]
        out = [Pose(R, p, R, p)]
        for k in self.links[1:]:
            up, R, p = out[k.parent], k.R, k.p
            if k.moves:
                x = q[..., k.place, None]
                if k.slides:
                    p = p + product(R, k.z * x)
                else:
                    K = cross_matrix(k.z)
                    R = R @ (np.eye(3) + np.sin(x)[..., None] * K + (1 - np.cos(x))[..., None] * (K @ K))
            out.append(Pose(R, p + zero, up.R0 @ R, up.p0 + product(up.R0, p)))
        return out

    def unit(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Every state at rest, under every unit acceleration: samples x columns."""
        tiled = np.repeat(q, self.nv, axis=1)
        return tiled, np.zeros((1, tiled.shape[1], self.nv)), np.tile(np.eye(self.nv), (q.shape[1], 1))[None]

    def columns(self, answers: np.ndarray) -> np.ndarray:
        """The matrix whose columns are the answers to unit accelerations, or velocities."""
        return transposed(answers.reshape(len(answers), -1, self.nv, answers.shape[-1]))


def _root(d: Description) -> Link:
    zero = np.zeros((1, 1, 3))
    return Link(0, d.root, -1, np.eye(3)[None, None], zero, zero, False, -1, -1, *_body(d.base))


def _link(part: Part, number: int, parent: int, column: int, place: int) -> Link:
    z = part.unit_axis if column >= 0 else np.zeros(3)
    R, p = part.rotation[None, None], part.position[None, None]
    body = _body(part.body)
    length = 1.0 if part.axis is None else float(np.linalg.norm(part.axis))
    return Link(
        number, part.link, parent, R, p, z[None, None], part.slides, column, place, *body, (), length, part.type
    )


def _body(b: object) -> tuple[float, np.ndarray, np.ndarray]:
    mass, c, I = (b.mass, b.com, b.in_link) if b is not None else (0.0, np.zeros(3), np.zeros((3, 3)))  # type: ignore[attr-defined]
    return float(mass), np.asarray(c)[None, None], np.asarray(I)[None, None]


_TREES: weakref.WeakKeyDictionary[Description, dict[tuple[bool, str], Tree]] = weakref.WeakKeyDictionary()


def tree_of(view: View, fused: bool = False, order: str = "") -> Tree:
    """The tree of what a view sees; made once for each description."""
    made = _TREES.setdefault(view.description, {})
    if (fused, order) not in made:
        made[fused, order] = Tree(view, fused, order)
    return made[fused, order]


def spatial(rows: Sequence[Sequence[np.ndarray]]) -> np.ndarray:
    """A 6x6 matrix of four 3x3 blocks."""
    (a, b), (c, d) = rows
    shape = np.broadcast_shapes(a.shape, b.shape, c.shape, d.shape)[:-2]
    a, b, c, d = (np.broadcast_to(x, (*shape, 3, 3)) for x in (a, b, c, d))
    return np.concatenate([np.concatenate([a, b], -1), np.concatenate([c, d], -1)], -2)


def in_turn(steps: Steps, tree: Tree, k: Link, site: str, *parts: np.ndarray) -> tuple[np.ndarray, ...]:
    """What a joint makes, where a loop over joints may leave the first or last one out."""
    moving = [x.number for x in tree.links if x.moves]
    if k.number not in moving:  # the base
        return parts
    return tuple(steps.part(site, x, moving.index(k.number), len(moving)) for x in parts)


def filled(entries: dict[tuple[int, int], np.ndarray], nv: int, q: np.ndarray) -> np.ndarray:
    """A matrix (runs, samples, nv, nv) of those of its entries that are not zero."""
    lead = np.broadcast_shapes(q.shape[:-1], *(x.shape for x in entries.values()))
    M = np.zeros((*lead, nv, nv), np.result_type(q, *entries.values()))
    for (i, j), x in entries.items():
        M[..., i, j] = x
    return M
