"""Brax 0.14.2: the axes of sliding joints are not turned into world axes in the generalized pipeline.

A body of 2 kg slides along x of a frame that is turned by 90 degrees about y, so along the world's vertical: to hold it
takes 2 * 9.81 N, whichever way.  `brax.generalized.dynamics.inverse` answers 0; `transform_com` turns the angular part
of each axis by the link's rotation and leaves the linear part as it is in the joint's own frame.  With the frame not
turned, it agrees.  (The model is MuJoCo's, whose own `qfrc_bias` is printed beside.)
"""

import sys

import jax
import mujoco as mj
from brax import kinematics
from brax.generalized import base, dynamics
from brax.io import mjcf

jax.config.update("jax_enable_x64", True)
worst = 0.0
for euler, force in (("0 0 0", 0.0), ("0 90 0", 19.62)):
    host = mj.MjModel.from_xml_string(f"""<mujoco><worldbody><body euler="{euler}"><joint type="slide" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body></worldbody></mujoco>""")
    s, d = mjcf.load_model(host), mj.MjData(host)
    mj.mj_forward(host, d)
    q = v = jax.numpy.zeros(1)
    state = dynamics.transform_com(s, base.State.init(q, v, *kinematics.forward(s, q, v)))
    got = abs(float(dynamics.inverse(s, state)[0]))
    worst = max(worst, abs(got - force))
    print(f"frame turned by ({euler}) deg: expected {force}, got {got:.6g}; MuJoCo {abs(d.qfrc_bias[0]):.6g}")
sys.exit(worst > 1e-6)
