"""JaxSim, in its mixed representation; on a fixed base the joints' part of its floating model is answered."""

import os
from importlib.metadata import version

REQUIRES = ("jaxsim==0.9.0",)
BASE_Q, LINEAR_FIRST = ("x", "y", "z", "qw", "qx", "qy", "qz"), ("vx", "vy", "vz", "wx", "wy", "wz")


class Subject:
    name = "jaxsim"

    def __init__(self, urdf, floating, gravity):
        os.environ |= {"JAX_ENABLE_X64": "1", "JAX_PLATFORMS": "cpu"}
        import jax
        import jax.numpy as jnp
        import jaxsim.api as js

        self.version = version("jaxsim")
        m = js.model.JaxSimModel.build_from_model_description(str(urdf), gravity=gravity[2])
        names = list(m.joint_names())
        base_q, base_v = (BASE_Q, LINEAR_FIRST) if floating else ((), ())
        self.writes = {
            "q": [*base_q, *names], "v": [*base_v, *names], "rows": LINEAR_FIRST, "angular": "world", "linear": "world"
        }  # fmt: skip
        still = jnp.zeros(len(names) + 6 * floating)

        def data(q, v=still):
            base = {}
            if floating:
                base = {
                    "base_position": q[:3], "base_quaternion": q[3:7], "base_linear_velocity": v[:3],
                    "base_angular_velocity": v[3:6],
                }  # fmt: skip
                q, v = q[7:], v[6:]
            return js.data.JaxSimModelData.build(
                model=m, joint_positions=q, joint_velocities=v, velocity_representation=js.common.VelRepr.Mixed, **base
            )

        def part(x):
            return x if floating else x[(slice(6, None),) * x.ndim]

        self.crba = jax.jit(lambda q: part(js.model.free_floating_mass_matrix(m, data(q))))
        self.coriolis = jax.jit(lambda q, v: part(js.model.free_floating_coriolis_matrix(m, data(q, v))))
        self.bias = jax.jit(lambda q, v: part(js.model.free_floating_bias_forces(m, data(q, v))))
        self.gravity = jax.jit(lambda q: part(js.model.free_floating_gravity_forces(m, data(q))))
        self.com = jax.jit(lambda q: js.com.com_position(m, data(q)))
