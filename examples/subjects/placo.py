"""placo, whose robot always has a floating base: on a fixed one the joints' part is answered."""

from importlib.metadata import version

import numpy as np

REQUIRES = ("placo==0.10.2",)
BASE_Q, LINEAR_FIRST = ("x", "y", "z", "qx", "qy", "qz", "qw"), ("vx", "vy", "vz", "wx", "wy", "wz")


class Subject:
    name = "placo"

    def __init__(self, urdf, floating, gravity):
        import placo

        self.version, self.floating = version("placo"), floating
        self.r = placo.RobotWrapper(str(urdf), placo.Flags.ignore_collisions)
        self.r.set_gravity(np.asarray(gravity, float))
        names = list(self.r.joint_names())
        self.at = [self.r.get_joint_offset(n) for n in names]
        ends = sorted([*self.at, len(self.r.state.q)])
        self.widths = [ends[ends.index(a) + 1] - a for a in self.at]
        self.columns = [*range(6 * floating), *(self.r.get_joint_v_offset(n) for n in names)]
        self.n = len(self.r.state.qd)
        self.writes = {
            "q": [*(BASE_Q if floating else ()), *names], "v": [*(LINEAR_FIRST if floating else ()), *names],
            "rows": LINEAR_FIRST,
        }  # fmt: skip

    def _at(self, q, v=None):
        state, base = np.zeros(len(self.r.state.q)), 7 * self.floating
        state[:7] = q[:7] if self.floating else (0, 0, 0, 0, 0, 0, 1)
        for at, width, x in zip(self.at, self.widths, q[base:], strict=True):  # a continuous joint: cos and sin
            state[at : at + width] = x if width == 1 else (np.cos(x), np.sin(x))
        self.r.state.q, speeds = state, np.zeros(self.n)
        speeds[self.columns] = 0 if v is None else v
        self.r.state.qd = speeds
        self.r.update_kinematics()
        return self.r

    def fk(self, q, frame):
        return self._at(q).get_T_world_frame(frame)

    def jacobian(self, q, frame):
        return self._at(q).frame_jacobian(frame, "local_world_aligned")[:, self.columns]

    def jacobian_dot(self, q, v, frame):
        r = self._at(q, v)
        r.compute_jacobian_time_variation = True  # else it is zero
        r.update_kinematics()
        return r.frame_jacobian_time_variation(frame, "local_world_aligned")[:, self.columns]

    def crba(self, q):
        return self._at(q).mass_matrix()[np.ix_(self.columns, self.columns)]

    def bias(self, q, v):
        return self._at(q, v).non_linear_effects()[self.columns]

    def gravity(self, q):
        return self._at(q).generalized_gravity()[self.columns]

    def com(self, q):
        return self._at(q).com_world()

    def com_jacobian(self, q):
        return self._at(q).com_jacobian()[:, self.columns]

    def centroidal_momentum_matrix(self, q):
        return self._at(q).centroidal_map()[:, self.columns]
