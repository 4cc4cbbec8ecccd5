"""JaxSim, in its mixed representation; on a fixed base the joints' part of its floating model is answered.

JaxSim reads URDF through Gazebo's `gz`, which no package of PyPI brings; here the file is written as SDF first.
"""

import os
import xml.etree.ElementTree as ET
from importlib.metadata import version

REQUIRES = ("jaxsim==0.9.0", "jax==0.10.2")
BASE_Q, LINEAR_FIRST = ("x", "y", "z", "qw", "qx", "qy", "qz"), ("vx", "vy", "vz", "wx", "wy", "wz")
LEAST = 1e-13  # kg, and kg m^2: JaxSim leaves links without mass out, and what hangs on them
TYPES = {"continuous": "revolute", "revolute": "revolute", "prismatic": "prismatic", "fixed": "fixed"}


def sdf(urdf):
    """The same links and joints as SDF 1.7, where every pose names the frame that it is relative to."""
    robot = ET.parse(urdf).getroot()
    root = ET.Element("sdf", version="1.7")
    model = ET.SubElement(root, "model", name="robot")
    above = {j.find("child").get("link"): j for j in robot.findall("joint")}

    def pose(of, at, relative=None):
        e = of.find("origin") if of is not None else None
        text = " ".join([e.get("xyz", "0 0 0"), e.get("rpy", "0 0 0")]) if e is not None else "0 0 0 0 0 0"
        ET.SubElement(at, "pose", {"relative_to": relative} if relative else {}).text = text

    for link in robot.findall("link"):
        new, inertial = ET.SubElement(model, "link", name=link.get("name")), link.find("inertial")
        if link.get("name") in above:
            pose(None, new, above[link.get("name")].get("name"))
        body = ET.SubElement(new, "inertial")
        pose(inertial, body)
        mass, tensor = (None, None) if inertial is None else (inertial.find("mass"), inertial.find("inertia"))
        kilograms = 0.0 if mass is None else float(mass.get("value"))
        ET.SubElement(body, "mass").text = repr(kilograms or LEAST)
        moments = ET.SubElement(body, "inertia")
        for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
            least = LEAST if key[1] == key[2] and not kilograms else 0.0
            ET.SubElement(moments, key).text = repr(float(tensor.get(key, 0)) if kilograms else least)
    for joint in robot.findall("joint"):
        new = ET.SubElement(model, "joint", name=joint.get("name"), type=TYPES[joint.get("type")])
        parent = joint.find("parent").get("link")
        pose(joint, new, parent)
        ET.SubElement(new, "parent").text, ET.SubElement(new, "child").text = parent, joint.find("child").get("link")
        axis, told = ET.SubElement(new, "axis"), joint.find("axis")  # of fixed joints too: JaxSim asks for it
        ET.SubElement(axis, "xyz").text = "1 0 0" if told is None else told.get("xyz", "1 0 0")
        limit = ET.SubElement(axis, "limit")
        ET.SubElement(limit, "lower").text, ET.SubElement(limit, "upper").text = "-1e16", "1e16"
    return ET.tostring(root, encoding="unicode")


class Subject:
    name = "jaxsim"

    def __init__(self, urdf, floating, gravity):
        os.environ |= {"JAX_ENABLE_X64": "1", "JAX_PLATFORMS": "cpu"}
        import jax
        import jax.numpy as jnp
        import jaxsim.api as js

        self.version = version("jaxsim")
        m = js.model.JaxSimModel.build_from_model_description(sdf(urdf), is_urdf=False, gravity=-gravity[2])
        names = list(m.joint_names())
        base_q, base_v = (BASE_Q, LINEAR_FIRST) if floating else ((), ())
        self.writes = {
            "q": [*base_q, *names], "v": [*base_v, *names], "rows": LINEAR_FIRST, "angular": "world", "linear": "world"
        }  # fmt: skip
        still = jnp.zeros(len(names) + 6 * floating)
        mixed = js.common.VelRepr.Mixed

        def data(q, v=still):
            base = {}
            if floating:
                base = {
                    "base_position": q[:3], "base_quaternion": q[3:7], "base_linear_velocity": v[:3],
                    "base_angular_velocity": v[3:6],
                }  # fmt: skip
                q, v = q[7:], v[6:]
            return js.data.JaxSimModelData.build(
                model=m, joint_positions=q, joint_velocities=v, velocity_representation=mixed, **base
            )

        def part(x):
            return x if floating else x[(slice(6, None),) * x.ndim]

        def torque(q, v, a):
            base, joints = (a[:6], a[6:]) if floating else (jnp.zeros(6), a)
            d = data(q, v)
            f, tau = js.model.inverse_dynamics(m, d, joint_accelerations=joints, base_acceleration=base)
            return jnp.concatenate([f, tau]) if floating else tau

        self.crba = jax.jit(lambda q: part(js.model.free_floating_mass_matrix(m, data(q))))
        self.coriolis = jax.jit(lambda q, v: part(js.model.free_floating_coriolis_matrix(m, data(q, v))))
        self.bias = jax.jit(lambda q, v: part(js.model.free_floating_bias_forces(m, data(q, v))))
        self.gravity = jax.jit(lambda q: part(js.model.free_floating_gravity_forces(m, data(q))))
        self.rnea = jax.jit(torque)
        self.com = jax.jit(lambda q: js.com.com_position(m, data(q)))
        links = {name: k for k, name in enumerate(m.link_names())}
        poses = jax.jit(lambda q: js.model.forward_kinematics(m, data(q)))
        jacobian = jax.jit(
            lambda q, k: js.link.jacobian(m, data(q), link_index=k, output_vel_repr=mixed)[:, 0 if floating else 6 :]
        )
        self.fk = lambda q, frame: poses(q)[links[frame]]
        self.jacobian = lambda q, frame: jacobian(q, links[frame])
