"""Slips of kinematics, of sums over bodies, and of the equations of motion by Jacobians: see the folder `textbook`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from ...subjects.layout import product, transposed
from ..case import Case, View
from ..textbook import turns
from ..textbook.columns import Columns, referred, referred_rate
from ..textbook.poses import PLAIN, Poses, Ways, stacked
from ..textbook.steps import Slip, Steps
from ..textbook.sums import Sums
from .formulation import formulation

RIGHT = Steps(Slip("", "", ""))
"""Steps at which nothing can go wrong, and nothing is noted."""
SEEN = (
    "fk", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration", "com", "com_jacobian",
    "centroidal_momentum_matrix", "kinetic_energy", "potential_energy",
)  # fmt: skip
MOVED = ("gravity", "crba", "minv", "bias", "rnea", "aba")


@dataclass(frozen=True)
class Made:
    """One run, or many: the steps of poses and velocities, and those of all the rest."""

    view: View
    poses: Steps = RIGHT
    rest: Steps = RIGHT
    ways: Ways = PLAIN

    def tree(self, q: np.ndarray) -> Poses:
        v = self.view
        return Poses(v.robot, v.description, q, v.states.get("v"), self.poses, self.ways)

    @cached_property
    def whole(self) -> Poses:
        """Without slips there it is the same for all."""
        v = self.view
        if self.poses is not RIGHT or self.ways is not PLAIN:
            return self.tree(v.states["q"])
        known = TREES.setdefault(v.case, [])
        for of, states, tree in known:
            if of is v.description and states is v.states:
                return tree
        tree = self.tree(v.states["q"])
        del known[: len(known) - MOST + 1]
        known.append((v.description, v.states, tree))
        return tree

    def sums(self, tree: Poses) -> Sums:
        return Sums(tree, Columns(tree, self.rest), self.rest)

    def term(self, term: str) -> np.ndarray:
        """The answer to a question, (runs, n, ...)."""
        s, g = self.view.states, np.array(self.view.description.gravity)
        if term in OF_FRAMES:
            return self.of_frames(term)
        if term == "coriolis":
            return christoffel(lambda q: self.sums(self.tree(q)).mass_matrix, s["q"], s["v"])
        sums = self.sums(self.whole)
        if term in SUMMED:
            return SUMMED[term](sums, g)
        M, add = sums.mass_matrix, self.rest.add
        if term in ("crba", "minv"):
            return M if term == "crba" else np.linalg.inv(M)
        h = add("the bias", **{"what velocities need": sums.velocity_forces(), "gravity": sums.gravity(g)})
        if term == "bias":
            return np.asarray(h)
        if term == "rnea":
            return np.asarray(add("the torques", **{"M a": product(M, s["a"]), "the bias": h}))
        forces = add("the forces that accelerate", **{"tau": s["tau"] + 0 * h, "the bias": -h})
        return np.asarray(np.linalg.solve(M, forces[..., None])[..., 0])

    def of_frames(self, term: str) -> np.ndarray:
        """Poses, Jacobians and motions of frames."""
        tree, steps, s = self.whole, self.rest, self.view.states
        links = [tree.number[f] for f in self.view.frames]
        if term == "fk":
            return stacked([tree.pose(k) for k in links], list(range(len(links))), 2)
        columns, reference = Columns(tree, steps), self.view.layout.how.reference
        R, p = stacked(tree.R, links, 2), stacked(tree.p, links, 1)
        world = columns.reduced(columns.at(p, links))
        J = referred(steps, world, R, p, reference)
        if term == "jacobian":
            return J
        v = s["v"][:, None]
        if term == "frame_velocity":
            return product(J, v)
        frame = R, p, stacked(tree.w, links, 1), stacked(tree.v, links, 1)
        D = referred_rate(steps, columns.reduced(columns.rates(p, frame[3], links)), world, frame, reference)
        if term == "jacobian_dot":
            return D
        parts = {"J a": product(J, s["a"][:, None]), "dJ/dt v": product(D, v)}
        return np.asarray(steps.add("the acceleration of a frame", **parts))


OF_FRAMES = ("fk", "jacobian", "frame_velocity", "jacobian_dot", "frame_acceleration")
TREES: WeakKeyDictionary[Case, list[tuple[object, object, Poses]]] = WeakKeyDictionary()
MOST = 4  # trees of a case that are kept
SUMMED: dict[str, Callable[[Sums, np.ndarray], np.ndarray]] = {
    "com": lambda sums, g: sums.com, "com_jacobian": lambda sums, g: sums.com_jacobian(),
    "centroidal_momentum_matrix": lambda sums, g: sums.momentum(), "kinetic_energy": lambda sums, g: sums.kinetic_energy(),
    "potential_energy": Sums.potential_energy, "gravity": Sums.gravity,
}  # fmt: skip


def christoffel(mass: Callable[[np.ndarray], np.ndarray], q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """C by Christoffel's symbols of M(q), whose derivatives are taken by complex steps."""
    h = 1e-30
    dM = np.stack([mass(q + 1j * h * e).imag / h for e in np.eye(q.shape[1])], -1)
    rate, by_q = np.einsum("rnijk,nk->rnij", dM, v), np.einsum("rnijk,nj->rnik", dM, v)
    return np.asarray(0.5 * (rate + by_q - transposed(by_q)))


def off(*terms: str) -> Callable[[Case], bool]:
    """Whether one of these is wrong, or was not asked."""
    return lambda case: any(t not in case.observed or not case.score(t).right for t in terms)


def few(case: Case) -> bool:
    return not case.floating and case.robot.nv <= 12


def _poses(view: View, term: str, steps: Steps) -> np.ndarray:
    return Made(view, poses=steps).term(term)


def _rest(view: View, term: str, steps: Steps) -> np.ndarray:
    return Made(view, rest=steps).term(term)


formulation("forward kinematics", SEEN, batched=True)(_poses)
formulation("forward kinematics", MOVED, when=off("fk"), batched=True)(_poses)
formulation("geometric Jacobians", (*SEEN, *MOVED), batched=True)(_rest)
formulation("geometric Jacobians", ("coriolis",), when=lambda case: few(case) and off("crba")(case), batched=True)(_rest)


@formulation("velocities from link to link", ("frame_velocity",), batched=True)
def velocities(view: View, term: str, steps: Steps) -> np.ndarray:
    tree = Made(view, poses=steps).whole
    links = [tree.number[f] for f in view.frames]
    R, p, w, v = (stacked(x, links, k) for x, k in ((tree.R, 2), (tree.p, 1), (tree.w, 1), (tree.v, 1)))
    twist = np.concatenate(np.broadcast_arrays(w, v), -1)[..., None]
    return referred(steps, twist, R, p, view.layout.how.reference, "the twist")[..., 0]


@formulation("composite bodies", ("com_jacobian", "gravity"), batched=True)
def subtrees(view: View, term: str, steps: Steps) -> np.ndarray:
    """Of what each joint carries together."""
    sums = Made(view, rest=steps).sums(Made(view).whole)
    J = sums.com_jacobian_by_subtrees()
    if term == "com_jacobian":
        return J
    torques = -(J * np.array(view.description.gravity)[:, None]).sum(-2) * sums.masses.sum()
    return np.asarray(steps.add("gravity's torques", **{"-M J_G^T g": torques}))


def _with(made: Callable[..., np.ndarray], steps: Steps) -> Callable[..., np.ndarray]:
    """A way to make rotations, by these steps alone."""
    return lambda _, *given: made(steps, *given)


WAYS: dict[str, Callable[[Steps], Ways]] = {
    "rotations by axis and angle": lambda steps: Ways(turn=_with(turns.by_outer_product, steps)),
    "rotations by quaternions": lambda steps: Ways(turn=_with(turns.by_quaternion, steps)),
    "quaternions to matrices": lambda steps: Ways(quaternion=_with(turns.entry_by_entry, steps)),
    "roll, pitch and yaw as a product": lambda steps: Ways(rpy=_with(turns.of_rpy, steps)),
    "roll, pitch and yaw, entry by entry": lambda steps: Ways(rpy=_with(turns.rpy_entries, steps)),
}
"""Other ways to make rotations, with slips there alone."""


def _by(ways: Callable[[Steps], Ways]) -> Callable[[View, str, Steps], np.ndarray]:
    return lambda view, term, steps: Made(view, ways=ways(steps)).term(term)


for _name, _ways in WAYS.items():
    _run = _by(_ways)
    formulation(_name, SEEN, batched=True)(_run)
    formulation(_name, MOVED, when=off("fk"), batched=True)(_run)
