"""PyTorch: a network learns accelerations that follow a target with less torque; inverse dynamics is in the loss."""

import time

import numpy as np
import torch

import dualpin as dp
import dualpin.torch as dt

torch.manual_seed(0)
robot = dp.load("panda")
n, batch, steps = robot.nv, 4096, 30
q, v, wanted = (torch.from_numpy(x).float() for x in robot.sample(batch, seed=0))
q, v, wanted = q, 0.1 * v, 0.2 * wanted

network = torch.nn.Sequential(torch.nn.Linear(3 * n, 64), torch.nn.Tanh(), torch.nn.Linear(64, n))
optimiser = torch.optim.Adam(network.parameters(), lr=1e-2)
effort = dt.rnea(robot, q, v, wanted).square().mean(0)  # what each joint needs to do just what is wanted


def loss():
    a = wanted + network(torch.cat([q, v, wanted], -1))
    tau = dt.rnea(robot, q, v, a)
    return (tau.square() / effort).mean() + 0.1 * (a - wanted).square().mean()


history, start = [], time.perf_counter()
for _ in range(steps):
    optimiser.zero_grad()
    value = loss()
    value.backward()  # through the dynamics, by their analytic derivatives
    optimiser.step()
    history.append(float(value))
seconds = (time.perf_counter() - start) / steps
print(f"{1e3 * seconds:.1f} ms a step of {batch} samples; loss {history[0]:.3f} -> {history[-1]:.3f}")
assert history[-1] < history[0] and np.isfinite(history).all()
