"""frax, on JAX with 64 bits."""

import os
import warnings
import xml.etree.ElementTree as ET
from importlib.metadata import version

import numpy as np

REQUIRES = ("frax==0.1.0",)
BASE_Q, LINEAR_FIRST = ("x", "y", "z", "qw", "qx", "qy", "qz"), ("vx", "vy", "vz", "wx", "wy", "wz")


class Subject:
    name = "frax"

    def __init__(self, urdf, floating, gravity):
        os.environ |= {"JAX_ENABLE_X64": "1", "JAX_PLATFORMS": "cpu"}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import frax
        import jax

        self.version = version("frax")
        r = frax.Robot(str(urdf), floating_base="quaternion" if floating else None)
        names = list(r.joint_names)[6 * floating :]
        up = np.array([-x for x in gravity] + [0.0, 0.0, 0.0])
        child = {j.get("name"): j.find("child").get("link") for j in ET.parse(urdf).getroot().findall("joint")}
        self.index = {child[n]: i + 6 * floating for i, n in enumerate(names)}
        base_q, base_v = (BASE_Q, LINEAR_FIRST) if floating else ((), ())
        self.writes = {"q": [*base_q, *names], "v": [*base_v, *names], "rows": LINEAR_FIRST, "linear": "world"}
        self._poses = jax.jit(r.joint_to_world_transforms)
        self.rnea = jax.jit(lambda q, v, a: r.rnea(q, v, a, up, None))
        self.crba, self.bias, self.gravity = map(jax.jit, (r.mass_matrix, r.nonlinear_bias, r.gravity_vector))
        self.aba = jax.jit(lambda q, v, tau: r.forward_dynamics(q, v, tau, None))
        self.com, self.com_jacobian = jax.jit(r.center_of_mass), jax.jit(r.center_of_mass_jacobian)

    def fk(self, q, frame):
        return self._poses(q)[self.index[frame]]
