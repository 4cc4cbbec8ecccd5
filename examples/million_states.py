"""A million inverse dynamics: how long, and what threads and a given array for the result save."""

import time

import numpy as np

import dualpin as dp

robot = dp.load("panda")
n = 1_000_000
q, v, a = (np.resize(x, (n, x.shape[1])) for x in robot.sample(10_000, seed=0))
tau = np.empty((n, robot.nv))
dp.rnea(robot, q[:1000], v[:1000], a[:1000])  # compiled at the first call, kept on disk for the next process
for threads in (1, dp.get_num_threads()):
    dp.set_num_threads(threads)
    start = time.perf_counter()
    dp.rnea(robot, q, v, a, out=tau)
    seconds = time.perf_counter() - start
    print(f"{threads} thread(s): {seconds:.3f} s, {n / seconds / 1e6:.1f} million a second")
assert np.isfinite(tau).all()
