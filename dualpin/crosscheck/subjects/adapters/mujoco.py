"""MuJoCo: inverse dynamics by mj_inverse, forward dynamics by mj_forward.

As it comes, passive forces and equalities are part of both: the file's damping and dry friction, and the
soft constraint that `<mimic>` becomes.  The option "clean" switches them off, and counts no mass that stands still:
what is left is the model.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from _urdf import LINEAR_FIRST, homogeneous

REQUIRES = ("mujoco==4.0.0", "numpy")
OFF = ("CONTACT", "LIMIT", "FRICTIONLOSS", "EQUALITY", "DAMPER", "SPRING", "ACTUATION")
CALLS = {
    "": "import mujoco as mj\nm = mj.MjModel.from_xml_path('robot.urdf')\nd = mj.MjData(m)",
    "fk": "d.qpos[:] = q; mj.mj_kinematics(m, d); print(d.body(frame).xpos, d.body(frame).xmat)",
    "gravity": "d.qpos[:] = q; mj.mj_forward(m, d); print(d.qfrc_bias)",
    "bias": "d.qpos[:], d.qvel[:] = q, v; mj.mj_forward(m, d); print(d.qfrc_bias)",
    "rnea": "d.qpos[:], d.qvel[:], d.qacc[:] = q, v, a; mj.mj_inverse(m, d); print(d.qfrc_inverse)",
    "aba": "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau; mj.mj_forward(m, d); print(d.qacc)",
    "crba": "d.qpos[:] = q; mj.mj_forward(m, d); M = np.zeros((m.nv, m.nv)); mj.mj_fullM(m, d, M); print(M)",
    "com": "d.qpos[:] = q; mj.mj_forward(m, d); print(d.subtree_com[0])",
    "jacobian": "d.qpos[:] = q; mj.mj_forward(m, d); J = np.zeros((6, m.nv))\n"
    "mj.mj_jacBody(m, d, J[:3], J[3:], m.body(frame).id); print(J)",
    "jacobian_dot": "d.qpos[:], d.qvel[:] = q, v; mj.mj_forward(m, d); J, b = np.zeros((6, m.nv)), m.body(frame).id\n"
    "mj.mj_jacDot(m, d, J[:3], J[3:], d.xpos[b], b); print(J)",
    "com_jacobian": "d.qpos[:] = q; mj.mj_forward(m, d); J = np.zeros((3, m.nv)); mj.mj_jacSubtreeCom(m, d, J, 0)\n"
    "print(J)",
    "centroidal_momentum_matrix": "d.qpos[:] = q; mj.mj_forward(m, d); L, p = np.zeros((2, 3, m.nv))\n"
    "mj.mj_jacSubtreeCom(m, d, p, 0); mj.mj_angmomMat(m, d, L, 0); print(p * m.body_subtreemass[0], L)",
    "rnea_f_ext": "d.qpos[:], d.qvel[:], d.qacc[:] = q, v, a; mj.mj_inverse(m, d)\n"
    "b, t = m.body(frame).id, np.zeros(m.nv); mj.mj_applyFT(m, d, f_ext[:3], f_ext[3:], d.xpos[b], b, t)\n"
    "print(d.qfrc_inverse - t)",
    "aba_f_ext": "d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau; mj.mj_forward(m, d); b = m.body(frame).id\n"
    "mj.mj_applyFT(m, d, f_ext[:3], f_ext[3:], d.xpos[b], b, d.qfrc_applied); mj.mj_forward(m, d); print(d.qacc)",
}
"""The same in the library's own words, for reports."""


class Subject:
    """One robot in MuJoCo: linear first, the base's linear velocity in world axes, its angular in its own.

    The option "mjcf=PATH" reads that file, an MJCF, in the URDF's place; "clean,mjcf=PATH" does both.
    """

    name = "mujoco"
    calls = CALLS

    def __init__(self, urdf: str, floating: bool, gravity: Any, option: str = "") -> None:
        import mujoco as mj

        self.mj, self.version = mj, mj.__version__
        words, _, path = option.partition("mjcf=")
        clean = "clean" in words
        if path:
            self.m = m = mj.MjModel.from_xml_path(path)
        else:
            self.m = m = self._of_urdf(Path(urdf).read_text(encoding="utf-8"), floating, clean)
        self.d = mj.MjData(m)
        m.opt.gravity[:] = gravity
        if clean:
            for bit in OFF:
                m.opt.disableflags |= getattr(mj.mjtDisableBit, f"mjDSBL_{bit}", 0)
            m.opt.density = m.opt.viscosity = 0
            m.body_gravcomp[:] = 0
            m.body_mass[m.body_weldid == 0] = 0
            mj.mj_setConst(m, self.d)
        q, v = [], []
        for i in range(m.njnt):
            name, kind = m.joint(i).name or f"joint{i}", mj.mjtJoint(m.jnt_type[i])
            base = kind == mj.mjtJoint.mjJNT_FREE and i == 0
            at = "" if base else f"{name}."
            if kind == mj.mjtJoint.mjJNT_FREE:
                q += [f"{at}{x}" for x in ("x", "y", "z", "qw", "qx", "qy", "qz")]
                v += [f"{at}{x}" for x in LINEAR_FIRST]
            elif kind == mj.mjtJoint.mjJNT_BALL:
                q += [f"{at}{x}" for x in ("qw", "qx", "qy", "qz")]
                v += [f"{at}{x}" for x in ("wx", "wy", "wz")]
            else:
                q.append(name)
                v.append(name)
        self.writes = {"q": q, "v": v, "rows": LINEAR_FIRST, "linear": "world"}
        self.bodies = {m.body(i).name or f"body{i}": i for i in range(m.nbody)}

    def _of_urdf(self, text: str, floating: bool, clean: bool) -> Any:
        at = text.index(">", text.index("<robot")) + 1
        flags = 'discardvisual="false"' + (' fusestatic="false" balanceinertia="false"' if clean else "")
        spec = self.mj.MjSpec.from_string(f"{text[:at]}<mujoco><compiler {flags}/></mujoco>{text[at:]}")
        if floating:
            next(iter(spec.worldbody.bodies)).add_freejoint()
        return spec.compile()

    def _at(self, q: Any, v: Any = None) -> Any:
        self.mj.mj_resetData(self.m, self.d)
        self.d.qpos[:] = q
        self.d.qvel[:] = 0 if v is None else v
        self.mj.mj_fwdPosition(self.m, self.d)
        self.mj.mj_fwdVelocity(self.m, self.d)
        return self.d

    def fk(self, q: np.ndarray, frame: str) -> np.ndarray:
        d, i = self._at(q), self.bodies[frame]
        return homogeneous(d.xmat[i].reshape(3, 3), d.xpos[i])

    def jacobian(self, q: np.ndarray, frame: str) -> np.ndarray:
        J = np.zeros((6, self.m.nv))
        self.mj.mj_jacBody(self.m, self._at(q), J[:3], J[3:], self.bodies[frame])
        return J

    def jacobian_dot(self, q: np.ndarray, v: np.ndarray, frame: str) -> np.ndarray:
        i, J, d = self.bodies[frame], np.zeros((6, self.m.nv)), self._at(q, v)
        self.mj.mj_jacDot(self.m, d, J[:3], J[3:], d.xpos[i], i)
        return J

    def rnea(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        d = self._at(q, v)
        d.qacc[:] = a
        self.mj.mj_inverse(self.m, d)
        return d.qfrc_inverse.copy()

    def rnea_f_ext(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, f_ext: np.ndarray, frame: str) -> np.ndarray:
        tau, pushed, i = self.rnea(q, v, a), np.zeros(self.m.nv), self.bodies[frame]
        self.mj.mj_applyFT(self.m, self.d, f_ext[:3], f_ext[3:], self.d.xpos[i], i, pushed)
        return tau - pushed

    def crba(self, q: np.ndarray) -> np.ndarray:
        M, d = np.zeros((self.m.nv, self.m.nv)), self._at(q)
        try:
            self.mj.mj_fullM(self.m, d, M)
        except TypeError:  # its signature until 3.x
            self.mj.mj_fullM(self.m, M, d.qM)
        return M

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return self._at(q, v).qfrc_bias.copy()

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return self._at(q).qfrc_bias.copy()

    def aba(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        d = self._at(q, v)
        d.qfrc_applied[:] = tau
        self.mj.mj_forward(self.m, d)
        return d.qacc.copy()

    def aba_f_ext(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray, f_ext: np.ndarray, frame: str) -> np.ndarray:
        d, i = self._at(q, v), self.bodies[frame]
        d.qfrc_applied[:] = tau
        d.xfrc_applied[i] = np.r_[f_ext[:3], f_ext[3:] + np.cross(d.xpos[i] - d.xipos[i], f_ext[:3])]
        self.mj.mj_forward(self.m, d)
        return d.qacc.copy()

    def com(self, q: np.ndarray) -> np.ndarray:
        return self._at(q).subtree_com[0].copy()

    def com_jacobian(self, q: np.ndarray) -> np.ndarray:
        J = np.zeros((3, self.m.nv))
        self.mj.mj_jacSubtreeCom(self.m, self._at(q), J, 0)
        return J

    def centroidal_momentum_matrix(self, q: np.ndarray) -> np.ndarray:
        A, d = np.zeros((6, self.m.nv)), self._at(q)
        self.mj.mj_jacSubtreeCom(self.m, d, A[:3], 0)
        A[:3] *= self.m.body_subtreemass[0]
        self.mj.mj_angmomMat(self.m, d, A[3:], 0)
        return A
