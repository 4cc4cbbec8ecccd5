"""adam: the NumPy backend, its own default gravity, the mixed representation.

The option "clean" passes the gravity that is asked for.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
from _urdf import LINEAR_FIRST, homogeneous, joint_part, moving, rotation

REQUIRES = ("adam-robotics==0.5.0",)
BASE_Q = ("x", "y", "z", "qw", "qx", "qy", "qz")
CALLS = {
    "": "from adam.numpy import KinDynComputations\n"
    "k = KinDynComputations('robot.urdf', names)\n"
    "H, still = np.eye(4), np.zeros(6)",
    "fk": "print(k.forward_kinematics(frame, H, q))",
    "jacobian": "print(k.jacobian(frame, H, q))",
    "jacobian_dot": "print(k.jacobian_dot(frame, H, q, still, v))",
    "gravity": "print(k.gravity_term(H, q))",
    "bias": "print(k.bias_force(H, q, still, v))",
    "crba": "print(k.mass_matrix(H, q))",
    "com": "print(k.CoM_position(H, q))",
    "com_jacobian": "print(k.CoM_jacobian(H, q)[:, 6:])",
    "centroidal_momentum_matrix": "print(k.centroidal_momentum_matrix(H, q)[:, 6:])",
}
"""The same in the library's own words, for reports."""


class Subject:
    """One robot in adam, whose base always floats: on a fixed base the joints' part is answered."""

    name = "adam"
    calls = CALLS

    def __init__(self, urdf: str, floating: bool, gravity: Any, option: str = "") -> None:
        from adam.numpy import KinDynComputations

        self.version, self.floating, names = version("adam-robotics"), floating, moving(urdf)
        more = {"gravity": np.array([*gravity, 0, 0, 0], float)} if option == "clean" else {}
        self.k = KinDynComputations(str(urdf), names, **more)
        base_q, base_v = (BASE_Q, LINEAR_FIRST) if floating else ((), ())
        self.writes = {
            "q": [*base_q, *names], "v": [*base_v, *names], "rows": LINEAR_FIRST, "angular": "world", "linear": "world"
        }  # fmt: skip

    def _at(self, q: np.ndarray, v: np.ndarray | None = None) -> tuple[Any, ...]:
        pose = (homogeneous(rotation(q[3:7]), q[:3]), q[7:]) if self.floating else (np.eye(4), q)
        if v is None:
            return pose
        return (*pose, v[:6], v[6:]) if self.floating else (*pose, np.zeros(6), v)

    def _joints(self, x: Any, *axes: int) -> np.ndarray:
        return joint_part(x, self.floating, *axes)

    def fk(self, q: np.ndarray, frame: str) -> np.ndarray:
        return self.k.forward_kinematics(frame, *self._at(q))

    def jacobian(self, q: np.ndarray, frame: str) -> np.ndarray:
        return self._joints(self.k.jacobian(frame, *self._at(q)), 1)

    def jacobian_dot(self, q: np.ndarray, v: np.ndarray, frame: str) -> np.ndarray:
        return self._joints(self.k.jacobian_dot(frame, *self._at(q, v)), 1)

    def crba(self, q: np.ndarray) -> np.ndarray:
        return self._joints(self.k.mass_matrix(*self._at(q)), 0, 1)

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return self._joints(np.ravel(self.k.bias_force(*self._at(q, v))), 0)

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return self._joints(np.ravel(self.k.gravity_term(*self._at(q))), 0)

    def aba(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        if not self.floating:
            raise NotImplementedError("aba is of a free base only")
        return np.ravel(self.k.aba(*self._at(q, v), tau[6:]))

    def com(self, q: np.ndarray) -> np.ndarray:
        return np.ravel(self.k.CoM_position(*self._at(q)))

    def com_jacobian(self, q: np.ndarray) -> np.ndarray:
        return self._joints(self.k.CoM_jacobian(*self._at(q)), 1)

    def centroidal_momentum_matrix(self, q: np.ndarray) -> np.ndarray:
        return self._joints(self.k.centroidal_momentum_matrix(*self._at(q)), 1)
