"""Slips of kinematics, of sums over bodies, and of the equations of motion by Jacobians: see the folder `textbook`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ...subjects.layout import product
from ..case import Case, View
from ..textbook import gradient
from ..textbook.assembly import of_symbols, solved
from ..textbook.attitudes import PLAIN, Ways
from ..textbook.columns import Columns, referred, referred_rate
from ..textbook.poses import Poses, position_rates, stacked
from ..textbook.second import SecondDerivatives
from ..textbook.slipped import Run
from ..textbook.steps import Steps
from ..textbook.ways import WAYS
from ..textbook.weighted import RIGHT, Sums
from .formulation import COST, FUSING, Terms, formulation

SYMBOLIC = "Christoffel's symbols of derivatives by Jacobians"
RATED = "Christoffel's symbols of derivatives by rates"
LINKS, JACOBIANS, DIFFERENTIATED = "", "with velocities by Jacobians", "differentiated"
SECOND, PROJECTED = "by second derivatives", "with right motions of bodies"
SEEN = (
    "fk", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration", "com", "com_jacobian",
    "centroidal_momentum_matrix", "kinetic_energy", "potential_energy",
)  # fmt: skip
MOVING = ("frame_velocity", "jacobian_dot", "frame_acceleration", "kinetic_energy", "bias", "rnea", "aba")
TURNED = ("kinetic_energy", "crba", "minv", "rnea", "aba")
"""Terms in which the inertia of rotors counts."""
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
        Velocities are found "from link to link" or "by Jacobians"; Jacobians, and M, are "differentiated", or their
        rates are made "by second derivatives"; or Jacobians bring forces of "right motions" to the joints.
    early : bool
        Whether axes are turned into the world before their own joint turns.
    """

    view: View
    poses: Steps = RIGHT
    rest: Steps = RIGHT
    ways: Ways = PLAIN
    reading: Steps = RIGHT
    fused: bool = False
    how: str = LINKS
    early: bool = False

    def tree(self, q: np.ndarray, moving: bool = True) -> Poses:
        v = self.view
        qd = v.states.get("v") if moving else None
        return Poses(v.robot, v.description, q, qd, self.poses, self.ways, self.fused, self.early)

    @cached_property
    def whole(self) -> Poses:
        """Without slips there it is the same for all."""
        v = self.view
        if self.poses is not RIGHT or self.ways is not PLAIN or self.early:
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
        return bool(np.nanmax(np.abs(np.linalg.det(R) - 1), initial=0.0) < 1e-4)

    def columns(self, tree: Poses) -> Columns:
        how = self.view.layout.how
        world = how.angular == how.linear == "world"
        columns = (SecondDerivatives if self.how == SECOND else Columns)(tree, self.rest, world)
        return columns.by_jacobians() if self.how in (JACOBIANS, SECOND) and tree.qd is not None else columns

    def sums(self, tree: Poses) -> Sums:
        sums = Sums(tree, self.columns(tree), self.rest, self.reading)
        if self.how == PROJECTED:
            sums.motion = Sums(tree, Columns(tree, RIGHT), RIGHT)
        return sums

    def term(self, term: str) -> np.ndarray:
        """The answer to a question, (runs, n, ...)."""
        s, g = self.view.states, np.array(self.view.description.gravity)
        if term in OF_FRAMES:
            return self.of_frames(term)
        if term == "coriolis" and self.how == DIFFERENTIATED:
            return christoffel(lambda q: self.sums(self.tree(q, moving=False)).mass_matrix, s["q"], s["v"])
        if term in TURNED and any(any(p.armature) for p in self.view.description.parts):
            raise ValueError("a robot without rotors only")
        sums = self.sums(self.whole)
        if term == "coriolis":
            symbolic = self.how in (SYMBOLIC, RATED)
            return gradient.coriolis(sums, self.how == RATED) if symbolic else sums.coriolis()
        if term in SUMMED:
            return SUMMED[term](sums, g)
        if term == "kinetic_energy":
            if self.how == LINKS:
                return sums.kinetic_energy()
            return np.asarray((product(sums.mass_matrix, s["v"]) * s["v"]).sum(-1) / 2)
        add = self.rest.add
        if term in ("crba", "minv"):
            M = sums.mass_matrix
            return M if term == "crba" else solved(M, np.broadcast_to(np.eye(M.shape[-1]), M.shape))
        h = add("the bias", **{"what velocities need": sums.velocity_forces(), "gravity": sums.gravity(g)})
        if term == "bias":
            return np.asarray(h)
        if term == "rnea":
            return np.asarray(add("the torques", **{"M a": product(sums.mass_matrix, s["a"]), "the bias": h}))
        forces = add("the forces that accelerate", **{"tau": s["tau"] + 0 * h, "the bias": -h})
        return np.asarray(solved(sums.mass_matrix, forces[..., None])[..., 0])

    def of_frames(self, term: str) -> np.ndarray:
        """Poses, Jacobians and motions of frames."""
        tree, v, a = self.whole, self.view.states["v"][:, None], self.view.states.get("a")
        links = [tree.number[f] for f in self.view.frames]
        if term == "fk":
            return stacked([tree.pose(k, self.rigid) for k in links], list(range(len(links))), 2)
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

    def _of_bodies(self, tree: Poses, links: list[int]) -> np.ndarray:
        """dJ/dt v of the bodies that carry frames on fixed joints."""
        moving = [self._carrier(tree, k) for k in links]
        return product(self._rate(tree, moving), self.view.states["v"][:, None])

    def _carrier(self, tree: Poses, link: int) -> int:
        while link > 0 and not tree.of_link[link]:
            link = tree.parent[link]
        return link

    def _jacobian(self, tree: Poses, links: list[int]) -> np.ndarray:
        columns, R, p = self.columns(tree), stacked(tree.R, links, 2), stacked(tree.p, links, 1)
        J = columns.reduced(columns.at(p, links))
        return referred(self.rest, J, R, p, self.view.layout.how.reference)

    def _rate(self, tree: Poses, links: list[int]) -> np.ndarray:
        s, reference = self.view.states, self.view.layout.how.reference
        if self.how == DIFFERENTIATED:  # by a complex step along the motion
            h = 1e-30
            at = s["q"] + 1j * h * position_rates(self.view.robot, s["q"], s["v"])
            return self._jacobian(self.tree(at, moving=False), links).imag / h
        columns = self.columns(tree)
        R, p, w, u = (stacked(x, links, k) for x, k in ((tree.R, 2), (tree.p, 1), (columns.w, 1), (columns.v, 1)))
        J = columns.reduced(columns.at(p, links))
        D = columns.reduced(columns.rates(p, u, links))
        return referred_rate(self.rest, D, J, (R, p, w, u), reference)


OF_FRAMES = ("fk", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration")
TREES: WeakKeyDictionary[Case, list[tuple[object, object, bool, Poses]]] = WeakKeyDictionary()
LARGE = 60  # degrees of freedom beyond which equations of motion by Jacobians take too long
MOST = 4  # trees of a case that are kept
SUMMED: dict[str, Callable[[Sums, np.ndarray], np.ndarray]] = {
    "com": lambda sums, g: sums.com, "com_jacobian": lambda sums, g: sums.com_jacobian(),
    "centroidal_momentum_matrix": lambda sums, g: sums.momentum(),
    "potential_energy": Sums.potential_energy, "gravity": Sums.gravity,
}  # fmt: skip


def christoffel(mass: Callable[[np.ndarray], np.ndarray], q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """C by Christoffel's symbols of M(q), whose derivatives are taken by complex steps."""
    h = 1e-30
    dM = np.stack([mass(q + 1j * h * e).imag / h for e in np.eye(q.shape[1])], -1)
    return of_symbols(RIGHT, dM, v)


def off(*terms: str) -> Callable[[Case], bool]:
    """Whether one of these is wrong, or was not asked."""
    return lambda case: any(t not in case.observed or not case.score(t).right for t in terms)


def few(case: Case) -> bool:
    return not case.floating and case.robot.nv <= 12


def poses(view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
    """With slips in poses and velocities."""
    return Made(view, poses=steps, **how).term(term)


def jacobians(view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
    """With slips in Jacobians, sums over bodies, and what is made of them."""
    return Made(view, rest=steps, **how).term(term)


def velocities(view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
    """Twists of frames, from link to link."""
    tree = Made(view, poses=steps, **how).whole
    links = [tree.number[f] for f in view.frames]
    R, p, w, v = (stacked(x, links, k) for x, k in ((tree.R, 2), (tree.p, 1), (tree.w, 1), (tree.v, 1)))
    twist = np.concatenate(np.broadcast_arrays(w, v), -1)[..., None]
    return referred(steps, twist, R, p, view.layout.how.reference, "the twist")[..., 0]


def subtrees(view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
    """Of what each joint carries together."""
    made = Made(view, rest=steps, **how)
    sums = made.sums(made.whole)
    J = sums.com_jacobian_by_subtrees()
    if term == "com_jacobian":
        return J
    torques = -(J * np.array(view.description.gravity)[:, None]).sum(-2) * sums.total
    return np.asarray(steps.add("gravity's torques", **{"-M J_G^T g": torques}))


def rotations(view: View, term: str, steps: Steps, way: str = "", **how: Any) -> np.ndarray:
    """With slips in one of these ways."""
    return Made(view, ways=WAYS[way](steps), **how).term(term)


def reading(view: View, term: str, steps: Steps, **how: Any) -> np.ndarray:
    """With slips in reading tensors, which then may not be symmetric."""
    return Made(view, reading=steps, **how).term(term)


def fuses(case: Case) -> bool:
    """Whether bodies or joints hang on fixed links."""
    return any(not p.moves for p in case.description.parts)


KNOWN = {
    ("the arm r in w x r", "without the travel of a sliding joint", "step_other"): "slide_radius",
    ("the linear part of a turning column", "", "step_swapped"): "jacobian_linear_sign",
    ("the moment of a body", "w x I w", "step_left_out"): "gyroscopic",
    ("the moment of a body", "w x I w", "step_sign"): "gyroscopic_sign",
    ("the moment of a body", "w x I w", "step_half"): "gyroscopic_half",
    ("the moment of a body", "I Jw' v", "step_left_out"): "no_angular_acceleration",
    ("the angular momentum of a body", "I w", "step_left_out"): "spin",
    ("the angular momentum of a body", "r x m v", "step_left_out"): "orbit",
    ("the angular momentum of a body", "r x m v", "step_sign"): "orbit_sign",
    ("the centre of mass of a body", "", "step_unturned"): "com_frame",
    ("the weight of a body's centre", "1", "step_other"): "com_unweighted",
    ("the axis of a column", "", "step_unturned"): "axis_frame",
    ("xyz", "by its own rpy too", "step_other_turn"): "xyz_after_rpy",
    **{
        (site, "by its own rpy too", "step_other_turn"): "xyz_after_rpy"
        for site in ("xyz: of a moving joint", "xyz on a body", "xyz on a body: of a moving joint")
    },
    ("the inertia of a body", "", "step_unturned"): "inertia_frame",
    ("the inertia of a body", "", "step_turned_back"): "inertia_frame_transposed",
    ("the inertia of a body", "", "step_from_left"): "inertia_frame_half",
}  # fmt: skip
"""Slips that have keys of their own."""
SAYS = {
    "spin": "the spin I w of bodies is left out of the momentum",
    "orbit": "m r x v of bodies is left out of the angular momentum",
    "orbit_sign": "m r x v of bodies has the other sign in the angular momentum",
    "com_frame": "centres of mass are not turned into world axes",
    "xyz_after_rpy": "xyz of joints is turned by their rpy",
    "com_unweighted": "the centre of mass is the mean of the bodies' centres, without their masses",
}


def _register(name: str, run: Run, terms: Terms, after: str = "", **how: Any) -> None:
    """A formulation, of the links as they are and of bodies merged from fixed links.

    `after` is a term in which its slips show first, if that is answered; they are looked for there.
    """
    variant = ", ".join(x for x in (how.get("how", ""), "with axes kept early" * how.get("early", False)) if x)
    cost, like = COST + 0.05 * bool(variant) + 0.02 * name.startswith("quaternions"), LIKE.get(run, _itself)
    slow = partial(_answers, after)
    alike = name if run is rotations else ""
    formulation(name, terms, KNOWN, variant, _always, cost, SAYS, True, like, slow, alike)(_of(run, **how))
    both = ", ".join(x for x in ("of bodies merged from fixed links", variant) if x)
    formulation(name, terms, KNOWN, both, fuses, cost + FUSING, None, True, like, slow, alike)(
        _of(run, fused=True, **how)
    )


def _answers(after: str, case: Case) -> bool:
    return after in case.observed


def _always(case: Case) -> bool:
    return True


LIKE: dict[Run, Callable[[str], str]] = {
    poses: lambda term: "frame_velocity" if term in MOVING else "fk",
    rotations: lambda term: "fk" if term in OF_FRAMES else "com", reading: lambda term: "crba",
}  # fmt: skip
"""Where all slips show."""


def _itself(term: str) -> str:
    return term


@cache
def _of(run: Run, **how: Any) -> Run:
    """The same object for the same formulation: slips of one are made together."""
    return partial(run, **how)


def _terms(*always: str, **sometimes: Callable[[Case], bool]) -> Callable[[Case], list[str]]:
    """Terms, and groups of terms that are predicted where something holds."""
    return lambda case: [
        *dict.fromkeys([*always, *(t for group, holds in sometimes.items() if holds(case) for t in GROUPS[group])])
    ]


def not_large(case: Case) -> bool:
    return case.robot.nv <= LARGE


def symbols(case: Case) -> bool:
    """Whether Christoffel's symbols may explain C: of a wrong M."""
    return few(case) and off("crba")(case)


def fixed(case: Case) -> bool:
    return not case.floating and not_large(case)


RATES = ("jacobian_dot", "frame_acceleration")
TENSORS = ("centroidal_momentum_matrix", "kinetic_energy", "crba", "minv", "bias", "rnea", "aba", "coriolis")
GROUPS = {
    "moved": MOVED, "of_velocity": ("bias", "rnea", "aba", "coriolis"), "matrix": ("coriolis",),
    "second": (*RATES, "bias", "rnea", "aba", "coriolis"), "posed": ("fk",), "turned": (*SEEN[1:], *MOVED),
    "rate": ("jacobian_dot",), "projected": ("bias", "rnea", "aba"), "tensors": TENSORS,
}  # fmt: skip
_register("forward kinematics", poses, _terms(*SEEN, moved=off("fk"), matrix=off("frame_velocity")))
_register("forward kinematics", poses, _terms(posed=off("fk")), early=True)
_register("forward kinematics", poses, _terms(*SEEN[1:], moved=off("fk")), after="fk", early=True)
_register("forward kinematics", poses, _terms(*RATES, "kinetic_energy", of_velocity=not_large), how=JACOBIANS)
_register("forward kinematics", poses, RATES, how=DIFFERENTIATED)
_register("geometric Jacobians", jacobians, _terms(*SEEN, moved=not_large))
_register("geometric Jacobians", jacobians, _terms(*RATES, "kinetic_energy", of_velocity=not_large), how=JACOBIANS)
_register("geometric Jacobians", jacobians, RATES, how=DIFFERENTIATED)
_register("geometric Jacobians", jacobians, _terms(second=fixed), how=SECOND)
_register("geometric Jacobians", jacobians, _terms(projected=not_large), how=PROJECTED)
for _name, _run in (("forward kinematics", poses), ("geometric Jacobians", jacobians), ("bodies", reading)):
    _register(_name, _run, _terms(matrix=symbols), after="coriolis", how=DIFFERENTIATED)
for _name, _run in (("geometric Jacobians", jacobians), ("bodies", reading)):
    _register(_name, _run, _terms(matrix=few), how=SYMBOLIC)
_register("geometric Jacobians", jacobians, _terms(matrix=few), how=RATED)
_register("bodies", reading, _terms(tensors=not_large))
_register("velocities from link to link", velocities, ("frame_velocity",))
_register("composite bodies", subtrees, ("com_jacobian", "gravity"))
for _name in WAYS:
    _register(_name, rotations, _terms(posed=off("fk")), way=_name)
    _register(_name, rotations, _terms(turned=off("fk")), after="fk", way=_name)
    _register(_name, rotations, _terms(turned=off("fk")), after="fk", way=_name, early=True)
    _register(_name, rotations, _terms(rate=off("fk"), matrix=symbols), after="fk", way=_name, how=DIFFERENTIATED)
