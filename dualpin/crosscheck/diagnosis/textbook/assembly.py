"""Every term of dynamics from two algorithms: the forces of a motion, and the mass matrix.

Both may slip; what is made of them is right.  All arrays have the axes (runs, samples, ...).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...subjects.layout import product, transposed
from ..case import View
from .steps import Steps
from .tree import Tree, tree_of

Forces = Callable[[Steps, Tree, np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
Mass = Callable[[Steps, Tree, np.ndarray], np.ndarray]
MOST_STEPS = 12
"""Degrees of freedom up to which matrices are differentiated."""
OF_FORCES = ("gravity", "bias", "rnea", "rnea_f_ext", "rnea_derivatives")
STEP = 1e-30
UNCHANGED = 1e-10
"""Relative: a slip that changes something by less has nothing to do with it."""


def by_columns(forces: Forces) -> Mass:
    """The mass matrix as forces of unit accelerations, at rest and without gravity."""

    def mass(steps: Steps, tree: Tree, q: np.ndarray) -> np.ndarray:
        return tree.columns(forces(steps, tree, *tree.unit(q), np.zeros((1, 1, 3))))

    return mass


def right(algorithm: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
    """Forces, or a mass matrix, without a slip."""
    return lambda steps, *given: algorithm(Steps(), *given)


@dataclass(frozen=True)
class Dynamics:
    """Answers to all terms, from two algorithms; `fused` as of `Tree`."""

    forces: Forces
    mass: Mass
    fused: bool = False

    def __call__(self, view: View, term: str, steps: Steps) -> np.ndarray | None:
        tree = tree_of(view, self.fused)
        s = {k: x[None] for k, x in view.states.items()}
        answer = getattr(self, f"_{term}", None)
        return None if answer is None else answer(steps, tree, s, view)

    def made_of(self, term: str) -> Any:
        """Variants with the same forces answer alike to what is made of forces alone."""
        return (self.forces, self.fused) if type(self) is Dynamics and term in OF_FORCES else self

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
        return self._rnea(steps, tree, s, view)[:, :, None] - torques(view)

    # the mass matrix

    def _crba(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self.M(steps, tree, s["q"])

    def _minv(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        M = self.M(steps, tree, s["q"])
        return solved(M, np.broadcast_to(np.eye(tree.nv), M.shape))

    def _kinetic_energy(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return np.asarray(0.5 * (s["v"] * product(self.M(steps, tree, s["q"]), s["v"])).sum(-1))

    # both

    def _forward(self, steps: Steps, tree: Tree, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        return solved(self.M(steps, tree, q), (tau - self._h(steps, tree, q, v))[..., None])[..., 0]

    def _aba(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        return self._forward(steps, tree, s["q"], s["v"], s["tau"])

    def _aba_f_ext(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray:
        M, left = self.M(steps, tree, s["q"]), s["tau"] - self._h(steps, tree, s["q"], s["v"])
        needed = left[:, :, None] + torques(view)
        return transposed(solved(M, transposed(needed)))

    def _coriolis(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray | None:
        """Christoffel's symbols of a wrong mass matrix; of a right one, nothing is known but C v."""
        q, v = s["q"], s["v"]
        M, exact = self.M(steps, tree, q), self.M(Steps(), tree, q)
        C_v = self.tau(steps, tree, q, v, 0 * v, 0 * tree.gravity)
        known = self.tau(Steps(), tree, q, v, 0 * v, 0 * tree.gravity)
        C = C_v[..., :, None] * v[..., None, :] / (v**2).sum(-1)[..., None, None]
        rows = max(len(M), len(C_v))
        wrong = np.array(np.broadcast_to(~same(M, exact), rows))
        C = np.where(same(C_v, known)[:, None, None, None], np.nan, C)
        C = np.array(np.broadcast_to(C, (rows, *C.shape[1:])))
        C[wrong] = np.nan
        if wrong.any() and not tree.floating and tree.nv <= MOST_STEPS:
            chosen = steps.only(wrong.tolist()) if rows > 1 else steps
            C[wrong] = christoffel(lambda x: self.M(chosen, tree, x), q, v)
        return C

    # derivatives

    def _rnea_derivatives(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray | None:
        def f(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
            return self.tau(steps, tree, q, v, a, tree.gravity)

        return None if tree.floating else derivatives(f, s["q"], s["v"], s["a"])

    def _aba_derivatives(self, steps: Steps, tree: Tree, s: dict[str, np.ndarray], view: View) -> np.ndarray | None:
        def f(q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
            return self._forward(steps, tree, q, v, tau)

        return None if tree.floating or tree.nv > MOST_STEPS else derivatives(f, s["q"], s["v"], s["tau"])


def same(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Of each run: whether it is that of y."""
    axes = tuple(range(1, x.ndim))
    return np.asarray(np.abs(x - y).max(axes) < UNCHANGED * np.maximum(1.0, np.abs(y).max()))


def torques(view: View) -> np.ndarray:
    """J^T f of each frame's wrench."""
    pushed = view.compute("rnea_f_ext", view.layout.how.reference)
    return np.asarray(view.compute("rnea")[:, None] - pushed)[None]


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
    """C from Christoffel's symbols of a mass matrix.

    References: Siciliano et al., Robotics (2009), equation 7.45.
    """
    dM = by_coordinates(mass, q)
    rate, by_q = np.einsum("rnijk,nk->rnij", dM, v[0]), np.einsum("rnijk,nj->rnik", dM, v[0])
    return np.asarray(0.5 * (rate + by_q - transposed(by_q)))


def by_coordinates(f: Callable[[np.ndarray], np.ndarray], q: np.ndarray) -> np.ndarray:
    """(runs, samples, ..., nq): the derivative of an array by each coordinate, by complex steps."""
    size, n = q.shape[1:]
    moved = np.repeat(q, n, axis=1) + 1j * STEP * np.tile(np.eye(n), (size, 1))[None]
    y = f(moved).imag / STEP
    return np.moveaxis(y.reshape(len(y), size, n, *y.shape[2:]), 2, -1)
