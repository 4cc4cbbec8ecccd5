"""JAX: the gradient and the curvature of a torque cost, of thousands of states in one compiled call.

Where frax is installed (pip install frax), its gradients of the same cost stand beside them.
"""

import importlib.util
import time

import jax
import jax.numpy as jnp
import numpy as np

import dualpin as dp
import dualpin.jax as dj

robot = dp.load("panda")
states = [jnp.asarray(x) for x in robot.sample(4096, seed=0)]


def gradients(inverse_dynamics):
    """Those by q, v and a of the sum of the torques, and the seconds of the quickest of five calls."""
    f = jax.jit(jax.vmap(jax.grad(lambda q, v, a: inverse_dynamics(q, v, a).sum(), argnums=(0, 1, 2))))
    found, seconds = jax.block_until_ready(f(*states)), []
    for _ in range(5):
        start = time.perf_counter()
        jax.block_until_ready(f(*states))
        seconds.append(time.perf_counter() - start)
    return found, min(seconds)


(by_q, by_v, by_a), ours = gradients(lambda q, v, a: dj.rnea(robot, q, v, a))
print(f"{1e3 * ours:.2f} ms for {len(by_q)} gradients by q, v and a: {by_q.shape}")

if importlib.util.find_spec("frax"):
    import frax

    other, up = frax.Robot(str(robot.source)), -np.array([*map(float, robot.gravity), 0.0, 0.0, 0.0])
    theirs, seconds = gradients(lambda q, v, a: other.rnea(q, v, a, up, None))
    print(f"{1e3 * seconds:.1f} ms by frax: {seconds / ours:.0f} times as long")
    for x, y in zip((by_q, by_v, by_a), theirs, strict=True):
        assert np.abs(x - y).max() < 1e-3 * np.abs(x).max()  # single precision, as JAX is by itself

q, v, a = (np.asarray(x[0], dtype=float) for x in states)
cost = lambda q, v, a: dj.rnea(robot, q, v, a).sum()  # noqa: E731
hessian = jax.jacrev(jax.grad(cost))(*(x[0] for x in states))
expected = dp.rnea_hessian(robot, q, v, a, np.ones(robot.nv))[0]
print(f"the curvature by q, {hessian.shape}, is {np.abs(hessian - expected).max():.1e} from the analytic one")
assert np.abs(hessian - expected).max() < 1e-4 * np.abs(expected).max()
