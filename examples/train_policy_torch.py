"""PyTorch: a network learns accelerations that follow a target with less torque; inverse dynamics is in the loss.

The same steps with the recursion itself differentiated by PyTorch show what the analytic derivatives save.
"""

import time

import numpy as np
import torch

import dualpin as dp
import dualpin.torch as dt
from dualpin.algorithms.rnea import rnea as recursion
from dualpin.scalars import register

robot = dp.load("panda")
n, batch, steps = robot.nv, 4096, 30
q, v, wanted = (torch.from_numpy(x).float() for x in robot.sample(batch, seed=0))
q, v, wanted = q, 0.1 * v, 0.2 * wanted
effort = dt.rnea(robot, q, v, wanted).square().mean(0)  # what each joint needs to do just what is wanted


def trained(inverse_dynamics, steps):
    """The losses, and the seconds of the quickest step."""
    torch.manual_seed(0)
    network = torch.nn.Sequential(torch.nn.Linear(3 * n, 64), torch.nn.Tanh(), torch.nn.Linear(64, n))
    optimiser = torch.optim.Adam(network.parameters(), lr=1e-2)
    history, seconds = [], []
    for _ in range(steps):
        start = time.perf_counter()
        optimiser.zero_grad()
        a = wanted + network(torch.cat([q, v, wanted], -1))
        tau = inverse_dynamics(q, v, a)
        loss = (tau.square() / effort).mean() + 0.1 * (a - wanted).square().mean()
        loss.backward()
        optimiser.step()
        history.append(loss.item())
        seconds.append(time.perf_counter() - start)
    return history, min(seconds)


history, ours = trained(lambda *x: dt.rnea(robot, *x), steps)  # by analytic derivatives
print(f"{1e3 * ours:.1f} ms a step of {batch} samples; loss {history[0]:.3f} -> {history[-1]:.3f}")

register(torch.Tensor, torch)  # the algorithm runs on any scalars, also on one tensor a scalar
columns = lambda x: [x[:, i] for i in range(x.shape[1])]  # noqa: E731
same, autograd = trained(lambda *x: torch.stack(recursion(robot, *map(columns, x)), -1), 4)
print(f"{1e3 * autograd:.1f} ms with PyTorch's autograd through the recursion: {autograd / ours:.1f} times as long")

assert history[-1] < history[0] and np.isfinite(history).all()
assert np.allclose(same, history[:4], rtol=1e-3)  # single precision
