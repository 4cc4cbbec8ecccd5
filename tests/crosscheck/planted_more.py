"""More mistakes, of kinds that the rules were not made for; each as a subclass of the student, or a wrapper.

They were written from a list of what people get wrong, before the rules were tried on them: what is found of
them says more than `planted.MISTAKES`, from which rules were made.  Only fixed bases.
"""

from __future__ import annotations

import numpy as np

from tests.crosscheck.student import Student
from tests.crosscheck.student_reading import of_quaternion, rx, ry, rz


class Written(Student):
    """The student with whatever `more` names."""

    def __init__(self, text: str, floating: bool, more: str) -> None:
        self.more = more
        super().__init__(text, floating)

    def is_(self, *names: str) -> bool:
        return self.more in names

    # reading

    def _rpy(self, rpy, what):
        r, p, y = rpy
        if self.is_(f"{what}_degrees"):
            r, p, y = np.radians([r, p, y])
        if self.is_(f"{what}_yaw_first"):
            r, p, y = y, p, r
        if self.is_(f"{what}_xzy"):
            return rx(r) @ rz(y) @ ry(p)
        if self.is_("joint_snapped") and what == "joint":
            near = np.round(rpy / (np.pi / 2)) * np.pi / 2
            r, p, y = np.where(np.abs(rpy - near) < 1e-3, near, rpy)
        return rz(y) @ ry(p) @ rx(r)

    def _link(self, e):
        k = super()._link(e)
        if self.is_("com_millimetres"):
            k.com = k.com / 1000
        if self.is_("com_mirrored"):
            k.com = k.com * [1, -1, 1]
        if self.is_("com_xy"):
            k.com = k.com[[1, 0, 2]]
        if self.is_("mass_grams"):
            k.mass = k.mass * 1000
        if self.is_("moments_cycled"):
            d = np.diag(k.I)
            k.I = k.I - np.diag(d) + np.diag(np.roll(d, 1))
        if self.is_("moments_yz"):
            d = np.diag(k.I)
            k.I = k.I - np.diag(d) + np.diag(d[[0, 2, 1]])
        return k

    def _joint(self, e):
        j = super()._joint(e)
        if self.is_("xyz_millimetres"):
            j.p = j.p / 1000
        return j

    def _edit(self):
        moving = [j for j in self.joints if j.kind != "fixed"]
        if self.is_("one_axis_x"):
            moving[1].axis = np.array([1.0, 0, 0])
        if self.is_("inertials_shifted"):
            carried = [self.links[j.child] for j in self.joints if self.links[j.child].mass > 0]
            values = [(k.mass, k.com, k.R, k.I) for k in carried]
            for k, new in zip(carried, values[1:] + values[:1], strict=True):
                k.mass, k.com, k.R, k.I = new
        if self.is_("base_tilted"):
            for j in self.joints:
                if j.parent == self.base:
                    j.p, j.R = rx(0.2) @ j.p, rx(0.2) @ j.R

    # answers

    def _written(self, x):
        x = np.asarray(x, float)
        if self.is_("six_digits"):
            return np.array([float(f"{y:.6g}") for y in x.ravel()]).reshape(x.shape)
        return np.round(x, 4) if self.is_("four_decimals") else x

    def fk(self, q, frame):
        H = super().fk(q, self._chain_parent(frame) if self.is_("parent_frame") else frame)
        if self.is_("quaternion_last"):
            w, x, y, z = np.roll(_quaternion(H[:3, :3]), -1)
            H[:3, :3] = of_quaternion(w, x, y, z)
        return self._written(H)

    def _chain_parent(self, frame):
        return next(j.parent for j in self.joints if j.child == frame)

    def jacobian(self, q, frame):
        J = super().jacobian(q, self._chain_parent(frame) if self.is_("parent_frame") else frame)
        R = self.poses(q)[0][frame][0]
        if self.is_("angular_local"):
            J[:3] = R.T @ J[:3]
        if self.is_("linear_local"):
            J[3:] = R.T @ J[3:]
        if self.is_("one_column_sign"):
            J[:, 1] *= -1
        if self.is_("one_column_empty"):
            J[:, 2] = 0
        return self._written(J)

    def gravity(self, q):
        return self._written(super().gravity(q))

    def crba(self, q):
        return self._written(super().crba(q))

    def bias(self, q, v):
        return self._written(super().bias(q, v))

    def rnea(self, q, v, a):
        return self._written(super().rnea(q, v, a))

    def extra(self, v, a):
        out = super().extra(v, a)
        if self.is_("drag"):
            out = out + 0.3 * v * np.abs(v)
        if self.is_("viscous_and_coulomb"):
            out = out + 0.2 * v + 0.5 * np.sign(v)
        return out

    def inverse_dynamics(self, q, v, a, g):
        tau = super().inverse_dynamics(q, v, a, g)
        if self.is_("spring_with_rest"):
            tau = tau + 0.7 * (np.asarray(q) - 0.4)
        if self.is_("rest_torque"):
            tau = tau + 0.9
        return tau

    def coriolis(self, q, v):
        n, h = self.nv, 1e-30
        if self.is_("coriolis_differences"):
            h = 1e-4
            d = [
                (self.mass_matrix(np.array(q) + h * e) - self.mass_matrix(np.array(q) - h * e)) / (2 * h)
                for e in np.eye(n)
            ]
        else:
            d = [np.imag(self.mass_matrix(np.array(q, complex) + 1j * h * e)) / h for e in np.eye(n)]
        rate, B = sum(x * s for x, s in zip(d, v, strict=True)), np.stack([x @ v for x in d], axis=1)
        if self.is_("coriolis_two_symbols"):
            return self._written(0.5 * (rate + B))
        if self.is_("coriolis_symbol_sign"):
            return self._written(0.5 * (rate - B + B.T))
        return self._written(0.5 * (rate + B - B.T))

    def jacobian_dot(self, q, v, frame):
        if self.is_("jdot_differences", "jdot_differences_small"):
            h = 1e-5 if self.is_("jdot_differences") else 1e-8
            return (self.jacobian(np.array(q) + h * v, frame) - self.jacobian(q, frame)) / h
        if self.is_("parent_frame", "angular_local", "linear_local", "one_column_sign", "one_column_empty"):
            raise NotImplementedError
        return self._written(super().jacobian_dot(q, v, frame))

    def com(self, q):
        return self._written(super().com(q))

    def centroidal_momentum_matrix(self, q):
        return self._written(super().centroidal_momentum_matrix(q))

    def kinetic_energy(self, q, v):
        return self._written(super().kinetic_energy(q, v))

    def aba(self, q, v, tau):
        return self._written(super().aba(q, v, tau))


def _quaternion(R):
    from dualpin.crosscheck.subjects.layout import quaternions

    return quaternions(R)


MORE = {
    "joint_degrees": ("rpy_degrees",), "inertial_degrees": ("inertial_rpy_degrees",), "joint_yaw_first": ("rpy_order",),
    "joint_xzy": ("rpy_order",), "inertial_yaw_first": ("inertial_rpy_order",), "inertial_xzy": ("inertial_rpy_order",),
    "joint_snapped": ("rpy_snapped",), "com_millimetres": ("inertial_xyz_units",),
    "com_mirrored": ("inertial_xyz_order",), "com_xy": ("inertial_xyz_order",), "mass_grams": ("mass_units",),
    "moments_cycled": ("moments_swapped",), "moments_yz": ("moments_swapped",), "xyz_millimetres": ("xyz_units",),
    "one_axis_x": ("axis_other", "axis_always_x"), "inertials_shifted": ("inertial_shifted",),
    "base_tilted": ("base_offset",),
    "six_digits": ("few_digits",), "four_decimals": ("few_digits",), "parent_frame": ("parent_frame",),
    "quaternion_last": ("pose_quaternion",), "angular_local": ("mixed_axes",), "linear_local": ("mixed_axes",),
    "one_column_sign": ("column_scale",), "one_column_empty": ("column_scale", "zeros"), "drag": ("drag_fit",),
    "viscous_and_coulomb": ("damping_fit", "friction_fit"), "spring_with_rest": ("stiffness_fit", "constant_fit"),
    "rest_torque": ("constant_fit",), "coriolis_differences": ("finite_differences",),
    "coriolis_two_symbols": ("coriolis_symbols",), "coriolis_symbol_sign": ("coriolis_symbols", "transposed"),
    "jdot_differences": ("finite_differences",), "jdot_differences_small": ("finite_differences",),
}  # fmt: skip
"""Each with the keys that name it rightly."""
