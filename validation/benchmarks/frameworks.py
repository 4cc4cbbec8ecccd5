"""Gradients of a loss with inverse dynamics in it, in PyTorch and JAX, beside what else computes them, in one run:

    python -m validation.benchmarks.frameworks       where torch, jax, adam-robotics and frax are installed, or some

Writes frameworks.json and frameworks.md beside this file.  The loss is the mean square torque of 4096 states of a
robot; what is timed is its gradient by q, v and a.  All give the same gradient, before and after, or are not timed.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import statistics
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import dualpin as dp
from dualpin import bench
from dualpin.algorithms.rnea import rnea as source
from dualpin.files import write_text
from dualpin.machine import package, versions

HERE = Path(__file__).parent
BATCH, AGREEMENT = 4096, 1e-8
Gradient = Callable[[], list[np.ndarray]]


def torch_dualpin(robot: Any, states: list[np.ndarray]) -> Gradient:
    """dualpin.torch"""
    import dualpin.torch as dt

    return _torch(states, lambda q, v, a: dt.rnea(robot, q, v, a))


def torch_autograd(robot: Any, states: list[np.ndarray]) -> Gradient:
    """PyTorch's autograd through the recursion itself, one tensor a scalar"""
    import torch

    from dualpin.scalars import register

    register(torch.Tensor, torch)

    def tau(*given: Any) -> Any:
        return torch.stack(source(robot, *([x[:, i] for i in range(x.shape[1])] for x in given)), -1)

    return _torch(states, tau)


def torch_adam(robot: Any, states: list[np.ndarray]) -> Gradient:
    """adam's PyTorch backend, M a + h"""
    import torch
    from adam.pytorch import KinDynComputationsBatch

    gravity = torch.from_numpy(_six(robot))
    k = KinDynComputationsBatch(str(robot.source), robot.joint_names, gravity=gravity, dtype=torch.float64)
    base, still = torch.eye(4, dtype=torch.float64).repeat(BATCH, 1, 1), torch.zeros(BATCH, 6, dtype=torch.float64)

    def tau(q: Any, v: Any, a: Any) -> Any:
        M = k.mass_matrix(base, q)[:, 6:, 6:]
        return (M @ a[..., None])[..., 0] + k.bias_force(base, q, still, v)[:, 6:].reshape(a.shape)

    return _torch(states, tau)


def _torch(states: list[np.ndarray], tau: Callable[..., Any]) -> Gradient:
    import torch

    torch.set_num_threads(1)
    given = [torch.from_numpy(x).requires_grad_() for x in states]
    return lambda: [x.numpy() for x in torch.autograd.grad(tau(*given).square().mean(), given)]


def jax_dualpin(robot: Any, states: list[np.ndarray]) -> Gradient:
    """dualpin.jax, jit(grad)"""
    import dualpin.jax as dj

    return _jax(states, lambda q, v, a: dj.rnea(robot, q, v, a))


def jax_frax(robot: Any, states: list[np.ndarray]) -> Gradient:
    """frax, jit(grad), vmap over the states"""
    import frax
    import jax

    r, up = frax.Robot(str(robot.source)), -_six(robot)
    return _jax(states, jax.vmap(lambda q, v, a: r.rnea(q, v, a, up, None)))


def jax_adam(robot: Any, states: list[np.ndarray]) -> Gradient:
    """adam's JAX backend, M a + h, jit(grad), vmap over the states"""
    import jax
    import jax.numpy as jnp
    from adam.jax import KinDynComputations

    k = KinDynComputations(str(robot.source), robot.joint_names, gravity=_six(robot))

    def tau(q: Any, v: Any, a: Any) -> Any:
        h = k.bias_force(jnp.eye(4), q, jnp.zeros(6), v)
        return k.mass_matrix(jnp.eye(4), q)[6:, 6:] @ a + h.ravel()[6:]

    return _jax(states, jax.vmap(tau))


def _jax(states: list[np.ndarray], tau: Callable[..., Any]) -> Gradient:
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    f = jax.jit(jax.grad(lambda *x: (tau(*x) ** 2).mean(), (0, 1, 2)))
    given = [jnp.asarray(x) for x in states]
    return lambda: [np.asarray(x) for x in jax.block_until_ready(f(*given))]


def _six(robot: Any) -> np.ndarray:
    return np.array([*(float(x) for x in robot.gravity), 0.0, 0.0, 0.0])


WAYS = (torch_dualpin, torch_autograd, torch_adam, jax_dualpin, jax_frax, jax_adam)
NEEDS = {"torch": "torch", "jax": "jax", "adam": "adam", "frax": "frax"}


def measured(name: str, repetitions: int) -> list[dict[str, Any]]:
    robot = dp.load(name)
    states = [np.ascontiguousarray(x) for x in robot.sample(BATCH, seed=0)]
    tau = dp.rnea(robot, *states)
    right = dp.rnea_vjp(robot, *states, 2 * tau / tau.size)
    found: dict[str, Gradient] = {}
    rows: dict[str, dict[str, Any]] = {}
    for way in WAYS:
        what = way.__name__
        rows[what] = {"robot": name, "way": what, "what": (way.__doc__ or "").strip()}
        try:
            for part in what.split("_"):
                importlib.import_module(NEEDS.get(part, "dualpin"))
            found[what] = way(robot, states)
            rows[what] |= _checked(found[what], right)
        except Exception as e:  # whatever a library raises is why it is left out
            rows[what]["skipped"] = f"{type(e).__name__}: {e}"[:200]
            found.pop(what, None)
        print(name, rows[what], file=sys.stderr, flush=True)
    times: dict[str, list[float]] = {what: [] for what in found}
    for _ in range(repetitions):
        for what, f in found.items():
            runs, start = 0, time.perf_counter()
            while not runs or time.perf_counter() - start < 0.1:
                f()
                runs += 1
            times[what].append((time.perf_counter() - start) / runs)
    for what, f in found.items():
        rows[what] |= _checked(f, right)
        rows[what]["ms"] = round(1e3 * statistics.median(times[what]), 4)
        rows[what]["spread"] = [round(1e3 * min(times[what]), 4), round(1e3 * max(times[what]), 4)]
    for what in found:
        own = rows.get(f"{what.split('_')[0]}_dualpin", {})
        if "ms" in own:
            rows[what]["ratio"] = round(rows[what]["ms"] / own["ms"], 2)
    return list(rows.values())


def _checked(f: Gradient, right: tuple[np.ndarray, ...]) -> dict[str, float]:
    scale = max(float(np.abs(x).max()) for x in right)
    error = max(float(np.abs(x - y).max()) for x, y in zip(f(), right, strict=True)) / scale
    if not error < AGREEMENT:
        raise ValueError(f"its gradient differs by {error:.2g} (scaled)")
    return {"error": error}


def markdown(run: dict[str, Any]) -> str:
    m = run["machine"]
    lines = [
        "# Gradients in PyTorch and JAX\n",
        f"Measured {run['date']} by `python -m validation.benchmarks.frameworks`: {m['processor']}, Python "
        f"{m['python']}, {', '.join(f'{k} {v}' for k, v in run['libraries'].items())}; load {run['load']}.\n",
        f"The gradient by q, v and a of the mean square torque of {BATCH} states, double precision, one thread for\n"
        "PyTorch and dualpin, XLA as it comes; milliseconds, medians of runs in turns. Times: as long as dualpin in\n"
        "the same library.\n",
        "| robot | | ms | spread | times |", "|---|---|---|---|---|",
    ]  # fmt: skip
    for r in run["rows"]:
        if "ms" in r:
            low, high = r["spread"]
            lines.append(
                f"| {r['robot']} | {r['what']} | {r['ms']:.3g} | {low:.3g} to {high:.3g} | {r.get('ratio', '')} |"
            )
        else:
            said = r["skipped"].replace("|", "/").replace("\n", " ")
            lines.append(f"| {r['robot']} | {r['what']} | not measured: {said[:90]} | | |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m validation.benchmarks.frameworks")
    parser.add_argument("--robots", nargs="*", default=["ur5", "panda"])
    parser.add_argument("--repetitions", type=int, default=7)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    dp.set_num_threads(1)
    rows = [row for name in given.robots for row in measured(name, given.repetitions)]
    run = {
        "date": versions()["date"], "machine": bench.machine(), "load": [round(x, 2) for x in os.getloadavg()],
        "libraries": {k: package(k) for k in ("dualpin", "torch", "jax", "adam-robotics", "frax", "numpy")},
        "rows": rows,
    }  # fmt: skip
    write_text(HERE / "frameworks.json", json.dumps(run, indent=1) + "\n")
    write_text(HERE / "frameworks.md", markdown(run))


if __name__ == "__main__":
    main()
