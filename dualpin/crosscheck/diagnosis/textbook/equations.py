"""The equations of motion by sums over bodies, of their Jacobians.

    M = sum m J_c^T J_c + J_w^T I J_w                            g = -sum m J_c^T gravity
    C = sum m J_c^T J_c' + J_w^T (I J_w' + B J_w)        B = ([w] I - I [w] - [I w]) / 2
    h = sum J_c^T m (J_c' v - gravity) + J_w^T (I J_w' v + w x I w)

References: Siciliano et al., Robotics (2009), section 7.1.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...subjects.layout import product, transposed
from .columns import CENTRE
from .products import rows_of, skew, wedge
from .weighted import Sums


class Equations(Sums):
    """Of the bodies of `Sums`.

    Attributes
    ----------
    spun : (bool, bool)
        Whether the first and the second w of w x I w are made of Jacobians, although rates of Jacobians take
        velocities from link to link.
    motion : Equations, optional
        Where velocities and accelerations of bodies are taken from, if not from these Jacobians.
    """

    motion: Equations | None = None
    spun = (False, False)

    @cached_property
    def mass_matrix(self) -> np.ndarray:
        return self.of_bodies + np.diag(self.rotors)

    @cached_property
    def of_bodies(self) -> np.ndarray:
        """The mass matrix without rotors."""
        J, m = self.jacobians, self.masses("the mass in m Jv^T Jv") * self.every("the mass matrices: m Jv^T Jv")
        J = rows_of(self.steps, "M", J)
        Jw, Jv = J[..., :3, :], J[..., 3:, :]
        spin = self.every("the mass matrices: Jw^T I Jw")[..., None, None] * self.inertia
        terms = {
            "m Jv^T Jv": _summed(Jv, m[..., None, None] * Jv), "Jw^T I Jw": _summed(Jw, spin @ Jw),
        }  # fmt: skip
        return np.asarray(self.steps.add("the mass matrix", **terms))

    def gravity(self, g: np.ndarray) -> np.ndarray:
        m = self.masses("the mass in gravity's torques") * self.every("the torques of gravity")
        wrong = {
            "turned into the link's axes": lambda: product(transposed(self.R), g + 0 * self.c),
            "turned by the link's matrix": lambda: product(self.R, g + 0 * self.c),
            "along y, for z": lambda: g[[0, 2, 1]] + 0 * self.c, "along x, for z": lambda: g[[2, 1, 0]] + 0 * self.c,
        }  # fmt: skip
        weight = m[..., None] * self.steps.pick("gravity, in the weight of a body", g + 0 * self.c, **wrong)
        J = rows_of(self.steps, "J^T f: of weights", self.jacobians)
        torques = -(J[..., 3:, :] * weight[..., None]).sum((-3, -2))
        return np.asarray(self.steps.add("gravity's torques", **{"-m Jv^T g": torques}))

    @cached_property
    def rates(self) -> np.ndarray:
        """(runs, n, bodies, 6, nv): d/dt of `jacobians`, without the turning of the base's columns."""
        _, v = self.centre_velocities()
        return self.columns.reduced(self.columns.rates(self.c, v, self.links, CENTRE))

    @cached_property
    def spins(self) -> np.ndarray:
        """w of the bodies, in w x I w."""
        return self._spin(self.spun[0])

    def _spin(self, by_jacobians: bool) -> np.ndarray:
        if by_jacobians:
            assert self.poses.qd is not None
            w = product(self.jacobians[..., :3, :], self.poses.qd[..., None, :])
        else:
            w, _ = self.centre_velocities()
        wrong = {
            "turned into the body's axes": lambda: product(transposed(self.R), w),
            "turned by the body's matrix": lambda: product(self.R, w),
        }
        return np.asarray(self.steps.pick("the angular velocity in w x I w", w, **wrong))

    def coriolis(self) -> np.ndarray:
        """C = sum m Jv^T Jv' + Jw^T (I Jw' + B Jw), with B w = w x I w."""
        steps, J, D, I = self.steps, self.jacobians, self.rates, self.inertia
        w = self.spins
        W, H = skew(steps, w), skew(steps, product(I, w))
        terms = {
            "[w] I": steps.pick("[w] I in B", W @ I, **other_products(W, I)) / 2,
            "-I [w]": -steps.pick("I [w] in B", I @ W, **other_products(I, W)) / 2, "-[I w]": -H / 2,
        }  # fmt: skip
        B = steps.add("B, ([w] I - I [w] - [I w]) / 2,", **terms)
        others = {"[w] I": W @ I, "-[I w]": -H + 0 * B, "not halved": 2 * B}
        B = steps.pick("B, ([w] I - I [w] - [I w]) / 2,", B, **others)
        site = "the Coriolis matrices"
        m = self.masses("the mass in m Jv^T Jv'") * self.every(f"{site}: m Jv^T Jv'")
        spin, own = (self.every(f"{site}: {of}")[..., None, None] for of in ("Jw^T I Jw'", "Jw^T B Jw"))
        Jw, Jv = J[..., :3, :], J[..., 3:, :]
        terms = {
            "m Jv^T Jv'": _summed(Jv, m[..., None, None] * D[..., 3:, :]),
            "Jw^T I Jw'": _summed(Jw, spin * I @ D[..., :3, :]), "Jw^T B Jw": _summed(Jw, own * B @ Jw),
        }  # fmt: skip
        terms = {k: steps.pick(f"the matrix {k}", x, transposed=transposed(x)) for k, x in terms.items()}
        C = steps.add("the Coriolis matrix", **terms)
        return np.asarray(C + self.mass_matrix @ self.columns.turning if any(self.columns.world) else C)

    def velocity_forces(self) -> np.ndarray:
        """C v: what velocities need."""
        steps, qd = self.steps, self.poses.qd
        assert qd is not None
        moving = self.motion or self
        w, inside = moving.spins, moving.spins if moving.spun[0] == moving.spun[1] else moving._spin(moving.spun[1])
        rest = product(moving.rates, qd[..., None, :])
        I, J = self.inertia, transposed(rows_of(steps, "J^T f: of motions", self.jacobians))
        parts = {"I Jw' v": product(I, rest[..., :3]), "w x I w": wedge(steps, w, product(I, inside))}
        n, f = (
            steps.add("the moment of a body", **parts),
            self.masses("the mass in m Jv' v")[..., None] * rest[..., 3:],
        )
        linear, angular = (product(A, x).sum(-2) for A, x in ((J[..., 3:], f), (J[..., :3], n)))
        forces = {"Jv^T m Jv' v": linear, "Jw^T (I Jw' v + w x I w)": angular}
        h = steps.add("the forces that velocities need", **forces)
        turned = product(self.columns.turning, qd)
        return np.asarray(h + product(self.mass_matrix, turned) if any(self.columns.world) else h)


def other_products(A: np.ndarray, B: np.ndarray) -> dict[str, np.ndarray]:
    """What may stand in the place of A B."""
    return {
        "multiplied entry by entry": A * B, "that with the factors in the other order": B @ A,
        "that with the first factor transposed": transposed(A) @ B,
    }  # fmt: skip


def _summed(A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """The sum over bodies of A^T B."""
    a, b = (np.moveaxis(x, -3, -2).reshape(*x.shape[:-3], -1, x.shape[-1]) for x in (A, B))
    return transposed(a) @ b
