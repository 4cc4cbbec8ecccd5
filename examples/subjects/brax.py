"""Brax, its generalized pipeline on JAX with 64 bits; the model is the one that MuJoCo makes of the file.

Kinematics, the mass matrix and the bias forces: what the generalized pipeline computes before it integrates.
"""

import os
from importlib.metadata import version
from pathlib import Path

import numpy as np

REQUIRES = ("brax==0.14.2", "mujoco==4.0.0", "jax==0.10.2")
LINEAR_FIRST = ("vx", "vy", "vz", "wx", "wy", "wz")


class Subject:
    name = "brax"

    def __init__(self, urdf, floating, gravity):
        os.environ |= {"JAX_ENABLE_X64": "1", "JAX_PLATFORMS": "cpu"}
        import jax
        import jax.numpy as jnp
        import mujoco as mj
        from brax import kinematics
        from brax.generalized import base, dynamics, mass
        from brax.io import mjcf

        self.version = version("brax")
        text = Path(urdf).read_text(encoding="utf-8")
        at = text.index(">", text.index("<robot")) + 1
        compiler = '<mujoco><compiler fusestatic="true" balanceinertia="false"/></mujoco>'
        spec = mj.MjSpec.from_string(text[:at] + compiler + text[at:])
        if floating:
            next(iter(spec.worldbody.bodies)).add_freejoint()
        host = spec.compile()
        host.opt.gravity[:] = gravity
        host.dof_damping[:] = host.dof_frictionloss[:] = 0
        s = mjcf.load_model(host)
        names = [host.joint(i).name for i in range(host.njnt) if host.joint(i).type[0] != mj.mjtJoint.mjJNT_FREE]
        base_q = ("x", "y", "z", "qw", "qx", "qy", "qz") if floating else ()
        self.writes = {
            "q": [*base_q, *names], "v": [*(LINEAR_FIRST if floating else ()), *names], "linear": "world",
            "rows": LINEAR_FIRST,
        }  # fmt: skip
        self.links, still = list(s.link_names), jnp.zeros(s.qd_size())

        def state(q, v):
            x, xd = kinematics.forward(s, q, v)
            made = base.State.init(q, v, x, xd)
            return dynamics.transform_com(s, made)

        self._poses = jax.jit(lambda q: (lambda x: (x.pos, x.rot))(kinematics.forward(s, q, still)[0]))
        self.crba = jax.jit(lambda q: mass.matrix(s, state(q, still)))
        self.bias = jax.jit(lambda q, v: dynamics.inverse(s, state(q, v)))
        self.gravity = jax.jit(lambda q: dynamics.inverse(s, state(q, still)))

    def fk(self, q, frame):
        (p, rot), i = self._poses(q), self.links.index(frame)
        return np.concatenate([p[i], rot[i]])
