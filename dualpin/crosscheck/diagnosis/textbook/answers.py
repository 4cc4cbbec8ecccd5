"""Answers to all questions from poses, Jacobians and sums over bodies, in the ways in which codes combine them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ...subjects.layout import product, transposed
from ..case import Case, View
from . import gradient, regressors, subtrees
from .assembly import MOST_STEPS, accelerated, by_coordinates, of_symbols, solved
from .attitudes import PLAIN, Ways
from .columns import Columns
from .equations import Equations
from .poses import Poses, stacked
from .positions import position_rates
from .references import referred, referred_rate
from .second import Gradients, Products, SecondDerivatives
from .steps import Steps, UncoveredError
from .velocities import carried
from .weighted import RIGHT

LINKS, JACOBIANS, DIFFERENTIATED = "", "with velocities by Jacobians", "differentiated"
SECOND, PROJECTED = "by second derivatives", "with right motions of bodies"
POINTS = "with velocities of frames by Jacobians, those of joints from link to link"
PRODUCTS, GRADIENTS = "by products of columns", "by derivatives of columns by each joint"
SYMBOLIC = "Christoffel's symbols of derivatives by Jacobians"
TRANSPOSED = "Christoffel's symbols of derivatives of the second Jacobian, transposed"
BOTH = "Christoffel's symbols of derivatives of both Jacobians"
MIRRORED = "Christoffel's symbols of derivatives that are halves and their transposes"
MIRRORED_SECOND = f"{MIRRORED}, of the second Jacobian"
TURNED_LAST = "Christoffel's symbols with dM_kj for dM_jk"
TURNED_SECOND = f"{TURNED_LAST}, of the second Jacobian"
BY_AXES = "Christoffel's symbols of derivatives by joints' own axes"
CARRIED = "Christoffel's symbols of derivatives by joints that carry a body"
RATED = "Christoffel's symbols of derivatives by rates"
RATED_APART = "Christoffel's symbols of derivatives by axes and arms"
OF_SYMBOLS: dict[str, dict[str, Any]] = {
    SYMBOLIC: {}, TRANSPOSED: {"tensors": gradient.SECOND}, BOTH: {"tensors": gradient.EACH},
    MIRRORED: {"mirrored": True}, MIRRORED_SECOND: {"tensors": gradient.SECOND, "mirrored": True},
    CARRIED: {"carried": True}, BY_AXES: {"apart": True},
    TURNED_LAST: {"turned": True}, TURNED_SECOND: {"tensors": gradient.SECOND, "turned": True},
    RATED: {"by_rates": True}, RATED_APART: {"by_rates": True, "apart": True},
}  # fmt: skip
"""How `gradient` makes Christoffel's symbols."""
SPUN = "with angular velocities of bodies by Jacobians, rates from link to link"
SPUN_INSIDE = "with the momenta I w of bodies by Jacobians, w from link to link"
BY_ORIGINS = "with velocities of joints' origins by those of the links on which they are"
INSIDE_BY_PARENTS = f"{SPUN_INSIDE}, with axes that turn by the parent's angular velocity"
BY_PARENTS = "with axes that turn by the parent's angular velocity"
SPUN_BY_PARENTS = f"{SPUN}, {BY_PARENTS}"
OF_MOMENTA = (SPUN, SPUN_BY_PARENTS, SPUN_INSIDE, INSIDE_BY_PARENTS)
ABOUT = "about the right centre of mass"
FROM_LINKS = "twists of frames from link to link"
CARRIED_TOGETHER = "by what each joint carries together"
LAGRANGE = "Lagrange's equations, with Christoffel's symbols of M"
IN_LINKS = "with a regressor in the links' axes"
MASS = "M in itself and in forward dynamics"
SEEN = (
    "fk", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration", "com", "com_jacobian",
    "centroidal_momentum_matrix", "kinetic_energy", "potential_energy",
)  # fmt: skip
MOVING = ("frame_velocity", "jacobian_dot", "frame_acceleration", "kinetic_energy", "bias", "rnea", "aba")
PUSHED = {"rnea_f_ext": "rnea", "aba_f_ext": "aba"}
"""Terms with wrenches from outside, and those without."""
MOVED = ("gravity", "crba", "minv", "bias", "rnea", "aba", "coriolis")


@dataclass(frozen=True)
class Made:
    """One run, or many.

    Attributes
    ----------
    poses, rest, reading : Steps
        Those of poses and velocities, those of all that is made of them, and those of reading tensors.
    ways : Ways
        How rotations are made.
    fused : bool
        Whether fixed links are merged into the bodies that carry them.
    how : str
        Velocities are found "from link to link" or "by Jacobians"; Jacobians, M and the potential energy are
        "differentiated", or rates of Jacobians are made "by second derivatives"; or Jacobians bring forces of
        "right motions" to the joints; or M alone is made of them, or C of its Christoffel's symbols.
    early : bool
        Whether axes are turned into the world before their own joint turns.
    rooted : bool
        Whether the root link counts as a body, although nothing moves it.
    bare : bool
        Whether links without mass count as bodies.
    by_level : bool
        Whether links are listed level by level, not branch by branch.
    factored : bool
        Whether M is inverted by its Cholesky factor: a code then reads its lower triangle alone.
    """

    view: View
    poses: Steps = RIGHT
    rest: Steps = RIGHT
    ways: Ways = PLAIN
    reading: Steps = RIGHT
    fused: bool = False
    how: str = LINKS
    early: bool = False
    by_level: bool = False
    rooted: bool = False
    bare: bool = False
    factored: bool = False

    def tree(self, q: np.ndarray, moving: bool = True) -> Poses:
        v = self.view
        qd = v.states.get("v") if moving else None
        ways = replace(self.ways, in_world=self.in_world) if any(self.in_world) else self.ways
        tree = Poses(v.jointed, v.description, q, qd, self.poses, ways, self.fused, self.early, self.by_level)
        return carried(tree) if moving and qd is not None else tree

    @cached_property
    def whole(self) -> Poses:
        """Without slips there it is the same for all."""
        v = self.view
        if self.poses is not RIGHT or self.ways is not PLAIN or self.early or self.by_level:
            return self.tree(v.states["q"])
        known = TREES.setdefault(v.case, [])
        for of, states, fused, tree in known:
            if of is v.description and states is v.states and fused == self.fused:
                return tree
        tree = self.tree(v.states["q"])
        del known[: len(known) - MOST + 1]
        known.append((v.description, v.states, self.fused, tree))
        return tree

    @property
    def rigid(self) -> bool:
        """Whether the rotations that the subject returns are some: those of quaternions of another length are not."""
        R = self.view.case.observed.get("fk", np.eye(3))[..., :3, :3]
        with np.errstate(invalid="ignore"):  # of poses that were not answered
            return bool(np.nanmax(np.abs(np.linalg.det(R) - 1), initial=0.0) < 1e-4)

    @cached_property
    def in_world(self) -> tuple[bool, bool]:
        """Whether the subject writes the base's angular and linear velocity in world axes."""
        how = self.view.layout.how
        return how.angular == "world", how.linear == "world"

    def columns(self, tree: Poses) -> Columns:
        columns = KINDS.get(self.how, Columns)(tree, self.rest, self.in_world)
        columns.by_origins = self.how == BY_ORIGINS
        columns.by_parents = self.how in (BY_PARENTS, SPUN_BY_PARENTS, INSIDE_BY_PARENTS)
        return columns.by_jacobians() if self.how in (JACOBIANS, *KINDS) and tree.qd is not None else columns

    def sums(self, tree: Poses) -> Equations:
        sums = Equations(tree, self.columns(tree), self.rest, self.reading, self.rooted, self.bare)
        sums.spun = (self.how in (SPUN, SPUN_BY_PARENTS), self.how in OF_MOMENTA)
        sums.about = self.view.compute("com")[None] if self.how == ABOUT else None
        if self.how == PROJECTED:
            sums.motion = Equations(tree, Columns(tree, RIGHT), RIGHT, rooted=self.rooted)
        return sums

    def term(self, term: str) -> np.ndarray:
        """The answer to a question, (runs, n, ...)."""
        s, g = self.view.states, np.array(self.view.description.gravity)
        if term in OF_FRAMES:
            return self.of_frames(term)
        if term == "gravity" and self.how == DIFFERENTIATED:
            return by_coordinates(lambda q: self._at(q).potential_energy(g), s["q"][None])
        if term == "coriolis" and self.how in (DIFFERENTIATED, LAGRANGE):
            return self._of_symbols()
        if term == "joint_torque_regressor":
            return self._regressor()
        sums = self.sums(self.whole)
        if self.how == CARRIED_TOGETHER:
            return subtrees.com_jacobian(sums) if term == "com_jacobian" else subtrees.gravity(sums, g)
        if term == "coriolis":
            if self.how not in OF_SYMBOLS:
                return sums.coriolis()
            return gradient.coriolis(sums, **OF_SYMBOLS[self.how])
        if term in SUMMED:
            return SUMMED[term](sums, g)
        if term == "kinetic_energy":
            if self.how == LINKS:
                return sums.kinetic_energy()
            return np.asarray((product(sums.mass_matrix, s["v"]) * s["v"]).sum(-1) / 2)
        return self._of_motion(term, sums)

    def _regressor(self) -> np.ndarray:
        """By Jacobians of the links' origins, of right motions."""
        tree, v, a = self.whole, self.view.states["v"][:, None], self.view.states["a"][:, None]
        links = list(dict.fromkeys(x.body if self.fused else k for k, x in enumerate(tree.placed)))
        R, p, w, u = (stacked(x, links, k) for x, k in ((tree.R, 2), (tree.p, 1), (tree.w, 1), (tree.v, 1)))
        right = Columns(tree, RIGHT, self.in_world)
        J = right.reduced(right.at(p, links))
        D = right.reduced(right.rates(p, u, links)) + J @ right.turning[:, :, None]
        second = product(J, a) + product(D, v)
        moving = regressors.Moving(R, w, second[..., :3], second[..., 3:])
        g = np.array(self.view.description.gravity)
        made = regressors.in_links if self.how == IN_LINKS else regressors.wrenches
        forces, moments = made(RIGHT, moving, g, 0 * p)
        name = {n: link for link, n in tree.number.items()}
        names = [name[k] for k in links]
        Y = regressors.torques(RIGHT, self.link_jacobians(names), forces, moments)
        return regressors.in_columns(self.view, Y, names)

    def link_jacobians(self, names: Sequence[str]) -> np.ndarray:
        """(runs, n, links, 6, nv), of the links' origins."""
        tree, columns = self.whole, self.columns(self.whole)
        links = [tree.number[name] for name in names]
        return columns.reduced(columns.at(stacked(tree.p, links, 1), links))

    def _at(self, q: np.ndarray) -> Equations:
        """Elsewhere, at rest."""
        return self.sums(self.tree(q[0], moving=False))

    def _of_symbols(self) -> np.ndarray:
        """C from Christoffel's symbols, of few joints whose velocities are the rates of their positions."""
        s, robot = self.view.states, self.view.robot
        if robot.nv > MOST_STEPS or not all(j.model.additive for j in robot):
            raise UncoveredError("few joints with coordinates that add up only")
        dM = by_coordinates(lambda q: self._at(q).mass_matrix, s["q"][None])
        listed = list(dict.fromkeys(a.column for a in self.whole.axes))
        return of_symbols(self.rest if self.how == LAGRANGE else RIGHT, dM, s["v"], listed)

    def _of_motion(self, term: str, sums: Equations) -> np.ndarray:
        """M and its inverse, forces, and the accelerations that they cause."""
        s, pushed = self.view.states, self._pushed() if term in PUSHED else None
        if term == "crba":
            return sums.mass_matrix
        if PUSHED.get(term, term) == "rnea":
            terms = {"M a": product(sums.mass_matrix, s["a"]), "the bias": self._bias(sums)}
            tau = np.asarray(self.rest.add("the torques", **terms))
            return tau if pushed is None else tau[:, :, None] - pushed
        if term == "bias":
            return self._bias(sums)
        M = sums.mass_matrix
        if self.factored:
            M = np.tril(M) + transposed(np.tril(M, -1))
        if term == "minv":
            return solved(M, np.broadcast_to(np.eye(M.shape[-1]), M.shape))
        h = self._bias(sums)
        forces = self.rest.add("the forces that accelerate", **{"tau": s["tau"] + 0 * h, "the bias": -h})
        return accelerated(M, forces if pushed is None else forces[:, :, None] + pushed)

    def _pushed(self) -> np.ndarray:
        """J^T f of each frame's wrench."""
        J = self._jacobian(self.whole, [self.whole.number[f] for f in self.view.frames])
        return product(transposed(J), self.view.states["f_ext"][None, :, None])

    def _bias(self, sums: Equations) -> np.ndarray:
        view, g = self.view, np.array(self.view.description.gravity)
        if self.how == MASS:
            return view.compute("bias")[None]
        if self.how == LAGRANGE:
            forces = product(self.term("coriolis"), view.states["v"])
        else:
            forces = sums.velocity_forces()
        return np.asarray(self.rest.add("the bias", **{"what velocities need": forces, "gravity": sums.gravity(g)}))

    def of_frames(self, term: str) -> np.ndarray:
        """Poses, Jacobians and motions of frames."""
        tree, v, a = self.whole, self.view.states["v"][:, None], self.view.states.get("a")
        links = [tree.number[f] for f in self.view.frames]
        if term == "fk":
            H = stacked([tree.pose(k, self.rigid) for k in links], list(range(len(links))), 2)
            return self._returned(self._on_bodies(tree, links, H) if self.fused else H)
        if term == "frame_velocity" and self.how == FROM_LINKS:
            R, p, w, u = (stacked(x, links, k) for x, k in ((tree.R, 2), (tree.p, 1), (tree.w, 1), (tree.v, 1)))
            twist = np.concatenate(np.broadcast_arrays(w, u), -1)[..., None]
            return referred(self.rest, twist, R, p, self.view.layout.how.reference, "the twist")[..., 0]
        J = self._jacobian(tree, links)
        if term == "jacobian":
            return J
        if term == "frame_velocity":
            return product(J, v)
        D = self._rate(tree, links)
        if term == "jacobian_dot" or a is None:
            return D
        moving = product(D, v)
        wrong = {"that of the origin of the body that carries the frame": lambda: self._of_bodies(tree, links)}
        moving = self.rest.pick("what velocities add to a frame's acceleration", moving, **wrong)
        parts = {"J a": product(J, a[:, None]), "dJ/dt v": moving}
        halves = [
            self.rest.add(f"the acceleration of a frame: {which} part", **{k: x[..., at] for k, x in parts.items()})
            for which, at in (("its angular", slice(0, 3)), ("its linear", slice(3, 6)))
        ]
        return np.concatenate(np.broadcast_arrays(*halves), -1)

    def _returned(self, H: np.ndarray) -> np.ndarray:
        """Poses as they are written."""
        R, p = H[..., :3, :3], H[..., :3, 3]
        wrong = {"that of the inverse pose, -R^T p": lambda: -product(transposed(R), p), "of the other sign": -p}
        H = H + np.zeros((self.rest.rows, 1, 1, 1, 1))
        H[..., :3, 3] = self.rest.pick("the position that is written in a pose", p, **wrong)
        low = H.copy()
        low[..., :3, 3], low[..., 3, :3] = 0.0, H[..., :3, 3]
        return np.asarray(self.rest.pick("the place of a position in a pose", H, **{"the last row": low}))

    def _of_bodies(self, tree: Poses, links: list[int]) -> np.ndarray:
        """dJ/dt v of the bodies that carry frames on fixed joints."""
        moving = [tree.carrier(k) for k in links]
        return product(self._rate(tree, moving), self.view.states["v"][:, None])

    def _on_bodies(self, tree: Poses, links: list[int], H: np.ndarray) -> np.ndarray:
        """Poses of frames, where these are made of those of bodies and of places on them."""
        bodies, way = stacked(tree.R, [tree.placed[k].body for k in links], 2), tree.ways.placing
        own = stacked([way.matrix(x.A) for x in tree.placed], links, 2)
        wrong = {
            "that of its body, transposed, times its own there": lambda: transposed(bodies) @ own,
            "its own there times that of its body": lambda: own @ bodies, "its own there alone": own + 0 * bodies,
            "that of its body alone": bodies,
        }  # fmt: skip
        R, p = self.rest.pick("the orientation of a frame", H[..., :3, :3], **wrong), self._places(tree, links)
        out = np.zeros((*np.broadcast_shapes(R.shape[:-2], p.shape[:-1]), 4, 4), H.dtype)
        out[..., :3, :3], out[..., :3, 3], out[..., 3, 3] = R, p, 1.0
        return out

    def _places(self, tree: Poses, links: list[int]) -> np.ndarray:
        """Where frames are (runs, n, frames, 3)."""
        p = stacked(tree.p, links, 1)
        if not self.fused:
            return p
        on = [tree.placed[k].body for k in links]
        R, b, r = stacked(tree.R, on, 2), stacked(tree.p, on, 1), stacked([x.p for x in tree.placed], links, 1)
        wrong = {
            "not turned into world axes": lambda: r + 0 * b,
            "turned by the transposed matrix": lambda: product(transposed(R), r + 0 * b),
        }  # fmt: skip
        there = self.rest.pick("the place of a frame on its body", p - b, **wrong)
        return np.asarray(self.rest.add("the position of a frame", **{"that of its body": b, "its place there": there}))

    def _jacobian(self, tree: Poses, links: list[int]) -> np.ndarray:
        columns, R, p = self.columns(tree), stacked(tree.R, links, 2), self._places(tree, links)
        J = columns.reduced(columns.at(p, links))
        return referred(self.rest, J, R, p, self.view.layout.how.reference)

    def _rate(self, tree: Poses, links: list[int]) -> np.ndarray:
        s, reference = self.view.states, self.view.layout.how.reference
        if self.how == DIFFERENTIATED:  # by a complex step along the motion
            h = 1e-30
            at = s["q"] + 1j * h * position_rates(self.view.robot, s["q"], s["v"])
            return self._jacobian(self.tree(at, moving=False), links).imag / h
        columns = self.columns(tree)
        R, w, u = (stacked(x, links, k) for x, k in ((tree.R, 2), (columns.w, 1), (columns.v, 1)))
        p = self._places(tree, links)
        J = columns.reduced(columns.at(p, links))
        if self.how == POINTS:
            u = product(J, s["v"][:, None])[..., 3:]
        D = columns.reduced(columns.rates(p, u, links)) + J @ columns.turning[:, :, None]
        return referred_rate(self.rest, D, J, (R, p, w, u), reference)


KINDS = {SECOND: SecondDerivatives, PRODUCTS: Products, GRADIENTS: Gradients}
"""How rates of columns are made; by default by velocities."""
OF_FRAMES = ("fk", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration")
TREES: WeakKeyDictionary[Case, list[tuple[object, object, bool, Poses]]] = WeakKeyDictionary()
LARGE = 60  # degrees of freedom beyond which equations of motion by Jacobians take too long
MOST = 4  # trees of a case that are kept
SUMMED: dict[str, Callable[[Equations, np.ndarray], np.ndarray]] = {
    "com": lambda sums, g: sums.com, "com_jacobian": lambda sums, g: sums.com_jacobian(),
    "centroidal_momentum_matrix": lambda sums, g: sums.momentum(),
    "potential_energy": Equations.potential_energy, "gravity": Equations.gravity,
}  # fmt: skip
