"""Every term of dynamics from two algorithms: the forces of a motion, and the mass matrix.

Both may slip; what is made of them is right.  All arrays have the axes (runs, samples, ...).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .pushes import torques, wrenches
from .regressors import Regressor, in_columns
from .steps import Steps, UncoveredError
from .tree import Tree, tree_of

Forces = Callable[[Steps, Tree, np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
Mass = Callable[[Steps, Tree, np.ndarray], np.ndarray]
Matrix = Callable[[Steps, Tree, np.ndarray, np.ndarray], np.ndarray]
MOST_STEPS = 12
"""Degrees of freedom up to which matrices are differentiated."""
OF_FORCES = ("gravity", "bias", "rnea", "rnea_f_ext", "rnea_derivatives")
OF_MOMENTUM = ("centroidal_momentum_matrix", "com_jacobian", "potential_energy")
STEP = 1e-30


def by_columns(forces: Forces) -> Mass:
    """The mass matrix as forces of unit accelerations, at rest and without gravity."""

    def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
        return tree.columns(forces(steps, tree, *tree.unit(q), np.zeros((1, 1, 3))))

    return mass


@cache
def right(algorithm: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
    """Forces, or a mass matrix, without a slip."""
    return lambda steps, *given: algorithm(Steps(), *given)


def symbols(mass: Mass) -> Matrix:
    """C from Christoffel's symbols of a mass matrix that is differentiated, of few joints on a fixed base."""

    return Symbols(mass)


@dataclass(frozen=True)
class Symbols:
    """Makes C of a mass matrix."""

    mass: Mass

    def __call__(self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        if tree.floating or tree.nv > MOST_STEPS:
            raise UncoveredError("few joints on a fixed base only")
        return christoffel(lambda x: self.mass(steps, tree, x), q, v)


@dataclass(frozen=True)
class Dynamics:
    """Answers to all terms, from two algorithms; `fused` as of `Tree`.

    Attributes
    ----------
    matrix : callable, optional
        Makes C; by default it is made of the forces of unit velocities.
    """

    forces: Forces
    mass: Mass
    matrix: Matrix | None = None
    fused: bool = False
    momentum: Matrix | None = None
    """Makes the centroidal momentum matrix, of positions and centres of mass."""
    potential: Callable[..., np.ndarray] | None = None
    """Makes the potential energy, of positions and gravity."""
    pushed: Callable[..., np.ndarray] | None = None
    """Takes external wrenches among the forces of links; without it J^T f is subtracted at the end."""
    regressor: Regressor | None = None
    """Makes torques of unit parameters, of positions, velocities and accelerations."""

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        return self.answer(view, term, steps, tree_of(view, self.fused))

    def answer(self, view: View, term: str, steps: Steps, tree: Tree) -> np.ndarray | None:
        """The term, of this tree."""
        s = {k: x[None] for k, x in view.states.items()}
        answer = getattr(self, f"_{term}", None)
        return None if answer is None else answer(steps, tree, s, view)

    def beside(self, other: object) -> Dynamics | None:
        """With slips in wrenches that the same recursion takes, or in a regressor of its motions."""
        if not isinstance(other, Dynamics) or (other.pushed, other.fused) != (self.pushed, self.fused):
            return None
        if self.regressor and other.regressor:
            regressor = self.regressor.beside(other.regressor)
            return replace(self, regressor=regressor) if regressor else None
        return self if self.pushed and other.forces == right(self.forces) else None

    def made_of(self, term: str) -> Any:
        """Variants with the same forces answer alike to what is made of forces alone."""
        if type(self) is not Dynamics or term not in (*OF_FORCES, "coriolis"):
            return self
        how = (self.forces, self.pushed) if term == "rnea_f_ext" else self.forces
        return self.matrix or self.forces if term == "coriolis" else how, self.fused

    def steps_of(self, term: str) -> dict[Any, str]:
        """The algorithms of a term, each with the term in which its steps are seen most quickly."""
        if type(self) is not Dynamics or term in OF_MOMENTUM:
            return {(self, term): term}
        forces, mass = {(self.forces, self.fused): "rnea"}, {(self.mass, self.fused): "crba"}
        if term == "coriolis" and self.matrix is not None:
            of = self.matrix
            return {(of.mass, self.fused): "crba"} if isinstance(of, Symbols) else {(of, self.fused): term}
        if term == "joint_torque_regressor":
            return {(self.regressor, self.fused): term}
        if self.pushed is not None and term in ("rnea_f_ext", "aba_f_ext"):
            forces[self.pushed, self.fused] = "rnea_f_ext"
        if term in (*OF_FORCES, "coriolis"):
            return forces
        return mass if term in ("crba", "minv", "kinetic_energy") else forces | mass

    def tau(self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, a: np.ndarray, g: np.ndarray) -> np.ndarray:
        """The forces, with those that turn the rotors."""
        return self.forces(steps, tree, q, v, a, g) + tree.rotors * a

    def M(self, steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
        return self.mass(steps, tree, q) + np.diag(tree.rotors)

    # forces

    def _h(self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return self.tau(steps, tree, q, v, np.zeros_like(v), tree.gravity)

    def _gravity(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self._h(steps, tree, s["q"], 0 * s["v"])

    def _bias(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self._h(steps, tree, s["q"], s["v"])

    def _rnea(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self.tau(steps, tree, s["q"], s["v"], s["a"], tree.gravity)

    def _rnea_f_ext(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self._rnea(steps, tree, s, view)[:, :, None] - self._torques(steps, tree, view)

    def _torques(self, steps: Steps, tree: Tree, view: View) -> np.ndarray:
        """What the wrench on each frame adds to tau."""
        if self.pushed is None:
            return torques(tree, view)
        x = self.pushed(steps, tree, *wrenches(steps, tree, view))
        return -x.reshape(len(x), -1, len(view.frames), tree.nv)

    # the mass matrix

    def _crba(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self.M(steps, tree, s["q"])

    def _minv(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        M = self.M(steps, tree, s["q"])
        return solved(M, np.broadcast_to(np.eye(tree.nv), M.shape))

    def _kinetic_energy(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return np.asarray(0.5 * (s["v"] * product(self.M(steps, tree, s["q"]), s["v"])).sum(-1))

    # both

    def _centroidal_momentum_matrix(
        self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View
    ) -> np.ndarray | None:
        return None if self.momentum is None else self.momentum(steps, tree, s["q"], view.compute("com")[None])

    def _com_jacobian(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray | None:
        """The linear momentum, divided by the mass."""
        A = self._centroidal_momentum_matrix(steps, tree, s, view)
        return None if A is None else A[..., 3:, :] / sum(k.mass for k in tree.carried)

    def _potential_energy(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray | None:
        return None if self.potential is None else self.potential(steps, tree, s["q"], tree.gravity)

    def _joint_torque_regressor(
        self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View
    ) -> np.ndarray | None:
        if self.regressor is None:
            return None
        return in_columns(view, self.regressor(steps, tree, s["q"], s["v"], s["a"]), [k.name for k in tree.links])

    def _forward(self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        return accelerated(self.M(steps, tree, q), tau - self._h(steps, tree, q, v))

    def _aba(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self._forward(steps, tree, s["q"], s["v"], s["tau"])

    def _aba_f_ext(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        left = s["tau"] - self._h(steps, tree, s["q"], s["v"])
        return accelerated(self.M(steps, tree, s["q"]), left[:, :, None] + self._torques(steps, tree, view))

    def _coriolis(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        """By default by the forces of unit velocities: C = (1/2) d(C v)/dv.

        On a floating base that is no C of Christoffel's symbols, so what a slip changes is added to the right one.
        """
        if self.matrix is not None:
            return self.matrix(steps, tree, s["q"], s["v"])

        q = np.repeat(s["q"], tree.nv, axis=1)

        def by_v(steps: Steps) -> np.ndarray:
            return 0.5 * by_coordinates(
                lambda v: self.tau(steps, tree, q, v, np.zeros((1, 1, tree.nv)), 0 * tree.gravity), s["v"]
            )

        return view.compute("coriolis")[None] + by_v(steps) - by_v(Steps())

    # derivatives

    def _rnea_derivatives(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray | None:
        def f(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
            return self.tau(steps, tree, q, v, a, tree.gravity)

        return None if tree.floating else derivatives(f, s["q"], s["v"], s["a"])

    def _aba_derivatives(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray | None:
        def f(q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
            return self._forward(steps, tree, q, v, tau)

        return None if tree.floating or tree.nv > MOST_STEPS else derivatives(f, s["q"], s["v"], s["tau"])


@dataclass(frozen=True)
class Seen:
    """Motions of frames in world axes; `fused` as of `Tree`."""

    by: Callable[..., np.ndarray]
    fused: bool = False
    both: bool = False
    """Whether it knows velocities as well as accelerations."""

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        return self.answer(view, term, steps, tree_of(view, self.fused))

    def answer(self, view: View, term: str, steps: Steps, tree: Tree) -> np.ndarray | None:
        """The term, of this tree."""
        s = {k: x[None] for k, x in view.states.items()}
        if view.layout.how.reference != "local_world_aligned":
            return None
        return self.by(
            steps, tree, s["q"], s["v"], s.get("a", 0 * s["v"]), view.frames, *((term,) if self.both else ())
        )


@dataclass(frozen=True)
class InOrder:
    """The same where links are listed in another order, one of `lists.ORDERS`."""

    of: Any
    """`Dynamics`, `Seen` or `Articulated`."""
    order: str

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        return self.of.answer(view, term, steps, tree_of(view, self.of.fused, self.order))

    def steps_of(self, term: str) -> dict[Any, str]:
        """Those of the algorithm itself, which is proposed before: they are found once."""
        of = getattr(self.of, "steps_of", None)
        return dict(of(term)) if of else {(self.of, term): term}


def solved(M: np.ndarray, b: np.ndarray) -> np.ndarray:
    """M^-1 b; not-a-number in the runs in which there is none."""
    lead = np.broadcast_shapes(M.shape[:-2], b.shape[:-2])
    M, b = np.broadcast_to(M, (*lead, *M.shape[-2:])), np.broadcast_to(b, (*lead, *b.shape[-2:]))
    try:
        return np.linalg.solve(M, b)
    except np.linalg.LinAlgError:
        rows = [
            solved(A[None], x[None])[0] if len(M) > 1 else np.full(x.shape, np.nan) for A, x in zip(M, b, strict=True)
        ]
        return np.stack(rows)


def accelerated(M: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """M^-1 of forces (..., nv), or of several at each state (..., k, nv)."""
    if forces.ndim < M.ndim:
        return solved(M, forces[..., None])[..., 0]
    return transposed(solved(M, transposed(forces)))


def derivatives(f: Callable[..., np.ndarray], *inputs: np.ndarray) -> np.ndarray:
    """(runs, samples, inputs, row, column) of a function of vectors, by complex steps.

    References: Squire and Trapp, SIAM Review 40 (1998).
    """
    out = []
    for k, x in enumerate(inputs):
        n, size = x.shape[-1], x.shape[1]
        moved = [np.repeat(y, n, axis=1) for y in inputs]
        moved[k] = moved[k] + 1j * STEP * np.tile(np.eye(n), (size, 1))[None]
        y = f(*moved).imag / STEP
        out.append(transposed(y.reshape(len(y), size, n, -1)))
    rows = max(map(len, out))
    return np.stack([np.broadcast_to(x, (rows, *x.shape[1:])) for x in out], axis=2)


def christoffel(mass: Callable[[np.ndarray], np.ndarray], q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """C from Christoffel's symbols of a mass matrix."""
    return of_symbols(Steps(), by_coordinates(mass, q), v[0])


SYMBOLS = {"dM_ij/dq_k": "ijk", "dM_ik/dq_j": "ikj", "-dM_jk/dq_i": "jki"}
"""The terms of Christoffel's sum: the indices of dM."""


def of_symbols(
    steps: Steps, dM: np.ndarray, v: np.ndarray, columns: Sequence[int] = (), turned: bool = False
) -> np.ndarray:
    """C of dM_ij/dq_k (runs, samples, i, j, k) and v (samples, k); `columns` says in which order they are summed.

    `turned` says that the last term is written -dM_kj/dq_i, which is another one where M is not symmetric.

    References: Siciliano et al., Robotics (2009), equation 7.45.
    """
    at = dict(zip("ijk", np.indices(dM.shape[-3:]), strict=True))

    def part(indices: str, sign: float) -> np.ndarray:
        i, j, k = (at[x] for x in indices)
        return np.asarray(sign * steps.few(dM)[:, :, i, j, k])

    v_k, v_j, v_i = v[:, None, None, :], v[:, None, :, None], v[:, :, None, None]
    terms = {}
    for name, indices in SYMBOLS.items():
        minus = "-" * name.startswith("-")
        sign = -1.0 if minus else 1.0
        slips = {
            f"{minus}dM_{x[:2]}/dq_{x[2]}": partial(part, x, sign)
            for n, own in enumerate(indices) for x in (indices[:n] + y + indices[n + 1 :] for y in "ijk" if y != own)
        } | {
            f"{minus}dM_{x[:2]}/dq_{x[2]}": partial(part, x, sign) for x in SYMBOLS.values() if x != indices
        }  # fmt: skip
        right = part("kji" if turned and minus else indices, sign)
        x = steps.pick(f"{name} in Christoffel's sum", right, **slips)
        wrong = {
            "v_j": lambda x=x: steps.few(x) * v_j, "v_i": lambda x=x: steps.few(x) * v_i,
            "left out": lambda x=x: steps.few(x) + 0 * v_k,
        }  # fmt: skip
        terms[name] = steps.pick(f"the velocity in Christoffel's sum: that of {name}", x * v_k, **wrong)
    c = steps.add("Christoffel's symbols", **terms)
    count = v.shape[-1]
    listed = columns or range(count)
    parts = [steps.part("k in Christoffel's sum", c[..., k], i, count, alone=True) for i, k in enumerate(listed)]
    total = np.asarray(sum(parts[1:], parts[0]))
    rate, by_q = terms["dM_ij/dq_k"].sum(-1), terms["dM_ik/dq_j"].sum(-1)
    others = {
        "1": total, "1, and only of the last (dM/dt - d(M v)/dq^T / 2)": rate - 0.5 * transposed(by_q),
    }  # fmt: skip
    C = steps.pick("the factor 1/2 of Christoffel's symbols", 0.5 * total, **others)
    alone = {f"half of that of {name} alone": 0.5 * x.sum(-1) for name, x in terms.items()}
    return np.asarray(steps.pick("Christoffel's sum, as a whole,", C, **alone))


def by_coordinates(f: Callable[[np.ndarray], np.ndarray], q: np.ndarray) -> np.ndarray:
    """(runs, samples, ..., nq): the derivative of an array by each coordinate, by complex steps."""
    size, n = q.shape[1:]
    moved = np.repeat(q, n, axis=1) + 1j * STEP * np.tile(np.eye(n), (size, 1))[None]
    y = f(moved).imag / STEP
    return np.moveaxis(y.reshape(len(y), size, n, *y.shape[2:]), 2, -1)
