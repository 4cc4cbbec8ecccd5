"""MJX, MuJoCo on JAX with 64 bits.

Passive forces, equalities and contacts are off, so that what is left is the model.
"""

import os
from importlib.metadata import version
from pathlib import Path

import numpy as np

REQUIRES = ("mujoco==4.0.0", "mujoco-mjx==3.17.0", "jax==0.10.2")
LINEAR_FIRST = ("vx", "vy", "vz", "wx", "wy", "wz")
OFF = ("CONTACT", "LIMIT", "FRICTIONLOSS", "EQUALITY", "DAMPER", "SPRING")


class Subject:
    name = "mjx"

    def __init__(self, urdf, floating, gravity):
        os.environ |= {"JAX_ENABLE_X64": "1", "JAX_PLATFORMS": "cpu"}
        import jax
        import jax.numpy as jnp
        import mujoco as mj
        from mujoco import mjx

        self.version = version("mujoco-mjx")
        text = Path(urdf).read_text(encoding="utf-8")
        at = text.index(">", text.index("<robot")) + 1
        compiler = '<mujoco><compiler fusestatic="false" balanceinertia="false"/></mujoco>'
        spec = mj.MjSpec.from_string(text[:at] + compiler + text[at:])
        if floating:
            next(iter(spec.worldbody.bodies)).add_freejoint()
        host = spec.compile()
        host.opt.gravity[:] = gravity
        for bit in OFF:
            host.opt.disableflags |= getattr(mj.mjtDisableBit, f"mjDSBL_{bit}", 0)
        m = mjx.put_model(host)
        start = mjx.make_data(m)
        names = [host.joint(i).name for i in range(host.njnt) if host.joint(i).type[0] != mj.mjtJoint.mjJNT_FREE]
        base_q = ("x", "y", "z", "qw", "qx", "qy", "qz") if floating else ()
        self.writes = {
            "q": [*base_q, *names], "v": [*(LINEAR_FIRST if floating else ()), *names], "rows": LINEAR_FIRST,
            "linear": "world",
        }  # fmt: skip
        self.bodies = {host.body(i).name: i for i in range(host.nbody)}

        def moved(q, v, **more):
            return mjx.fwd_velocity(m, mjx.fwd_position(m, start.replace(qpos=q, qvel=v, **more)))

        still = jnp.zeros(host.nv)
        self._poses = jax.jit(lambda q: (lambda d: (d.xmat, d.xpos))(mjx.fwd_position(m, start.replace(qpos=q))))
        self._jacobians = jax.jit(lambda q, i: (lambda d: mjx.jac(m, d, d.xpos[i], i))(moved(q, still)))
        self.crba = jax.jit(lambda q: mjx.full_m(m, moved(q, still)))
        self.bias = jax.jit(lambda q, v: moved(q, v).qfrc_bias)
        self.gravity = jax.jit(lambda q: moved(q, still).qfrc_bias)
        self.rnea = jax.jit(lambda q, v, a: mjx.inverse(m, moved(q, v, qacc=a)).qfrc_inverse)
        self.aba = jax.jit(lambda q, v, tau: mjx.forward(m, start.replace(qpos=q, qvel=v, qfrc_applied=tau)).qacc)
        self.com = jax.jit(lambda q: moved(q, still).subtree_com[0])

    def fk(self, q, frame):
        (R, p), H, i = self._poses(q), np.eye(4), self.bodies[frame]
        H[:3, :3], H[:3, 3] = R[i], p[i]
        return H

    def jacobian(self, q, frame):
        linear, angular = self._jacobians(q, self.bodies[frame])
        return np.vstack([np.asarray(linear).T, np.asarray(angular).T])
