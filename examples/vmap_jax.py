"""JAX: the gradient and the curvature of a torque cost, of thousands of states in one compiled call."""

import time

import jax
import jax.numpy as jnp
import numpy as np

import dualpin as dp
import dualpin.jax as dj

robot = dp.load("panda")
states = [jnp.asarray(x) for x in robot.sample(4096, seed=0)]


def cost(q, v, a):
    return dj.rnea(robot, q, v, a) @ jnp.ones(robot.nv)


gradient = jax.jit(jax.vmap(jax.grad(cost, argnums=(0, 1, 2))))
by_q, by_v, by_a = jax.block_until_ready(gradient(*states))
start = time.perf_counter()
jax.block_until_ready(gradient(*states))
print(f"{1e3 * (time.perf_counter() - start):.2f} ms for {len(by_q)} gradients by q, v and a: {by_q.shape}")

q, v, a = (np.asarray(x[0], dtype=float) for x in states)
hessian = jax.jacrev(jax.grad(cost))(states[0][0], states[1][0], states[2][0])
expected = dp.rnea_hessian(robot, q, v, a, np.ones(robot.nv))[0]
print(f"the curvature by q, {hessian.shape}, is {np.abs(hessian - expected).max():.1e} from the analytic one")
assert np.abs(hessian - expected).max() < 1e-4 * np.abs(expected).max()  # single precision, as JAX is by itself
