"""Other libraries that compute the same on a GPU, each in a process of its own.

    python -m validation.benchmarks.gpu.peers NAME DTYPE

Each is measured as its users run it: compiled for the whole batch, data on the device, calls one after the other
and waited for at the end.  Its results are compared with ours before and after.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from .throughput import BATCHES, BLOCK, per_call

PEERS = ("mjx", "frax", "grid")
ROBOTS = {"mjx": ("panda",), "frax": ("panda", "talos_arm"), "grid": ("talos_arm",)}
AGREEMENT = {"float64": 1e-8, "float32": 2e-3}
"""Scaled; in single precision the peers' own rounding decides, ours is held to the host's bits elsewhere."""
Function = Callable[..., Any]


def run(
    names: tuple[str, ...] = PEERS, grid: str = "", progress: Callable[[dict[str, Any]], None] | None = None
) -> list[dict[str, Any]]:
    """Rows of the peers that are installed; of the others, a row that says why not."""
    rows: list[dict[str, Any]] = []
    for name in names:
        for dtype in ("float32", "float64"):
            environment = os.environ | {
                "DUALPIN_GRID": grid,
                "XLA_PYTHON_CLIENT_PREALLOCATE": "false",
                "MUJOCO_GL": "disable",
            }
            command = [sys.executable, "-m", __name__, name, dtype]
            done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=600, check=False)
            found = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
            if done.returncode:
                last = (done.stderr.strip().splitlines() or ["no output"])[-1]
                found.append({"peer": name, "dtype": dtype, "left_out": last[:300]})
            rows += found
            for row in found:
                if progress:
                    progress(row)
    return rows


def mjx(urdf: str, robot: Any, dtype: str) -> dict[str, Function]:
    """MuJoCo XLA: only the stages that the term needs."""
    import jax
    import mujoco
    from mujoco import mjx as m
    from mujoco.mjx._src import smooth

    model = mujoco.MjModel.from_xml_string(Path(urdf).read_text())
    names = [model.joint(i).name for i in range(model.njnt)]
    if names != robot.joint_names:
        raise ValueError(f"joints in another order: {names}")
    there = m.put_model(model)

    def placed(q: Any, v: Any) -> Any:
        d = m.make_data(there).replace(qpos=q, qvel=v)
        return smooth.com_vel(there, smooth.com_pos(there, smooth.kinematics(there, d)))

    def rnea(q: Any, v: Any, a: Any) -> Any:
        return smooth.rne(there, placed(q, v).replace(qacc=a), flg_acc=True).qfrc_bias

    def aba(q: Any, v: Any, tau: Any) -> Any:
        d = placed(q, v)
        bias = smooth.rne(there, d).qfrc_bias
        d = smooth.factor_m(there, smooth.crb(there, d))
        return smooth.solve_m(there, d, tau - bias)

    return {"rnea": jax.jit(jax.vmap(rnea)), "aba": jax.jit(jax.vmap(aba))}


def frax(urdf: str, robot: Any, dtype: str) -> dict[str, Function]:
    import frax as f
    import jax
    import jax.numpy as jnp

    there = f.Robot(urdf, joint_ordering=list(robot.joint_names))
    up = jnp.array([0.0, 0.0, 9.81, 0.0, 0.0, 0.0])
    return {
        "rnea": jax.jit(jax.vmap(lambda q, v, a: there.rnea(q, v, a, up, None))),
        "aba": jax.jit(jax.vmap(lambda q, v, tau: there.forward_dynamics(q, v, tau, None))),
    }


def with_jax(name: str, dtype: str) -> None:
    import jax

    jax.config.update("jax_enable_x64", dtype == "float64")
    version = metadata.version({"mjx": "mujoco-mjx"}.get(name, name))
    for robot_name in ROBOTS[name]:
        robot, states, urdf = subject(robot_name)
        try:
            functions = {"mjx": mjx, "frax": frax}[name](urdf, robot, dtype)
        except Exception as e:
            show({"peer": name, "robot": robot_name, "dtype": dtype, "left_out": f"{type(e).__name__}: {e}"[:300]})
            continue
        for term, function in functions.items():
            for n in BATCHES:
                row = {"peer": f"{name} {version}", "robot": robot_name, "term": term, "dtype": dtype, "batch": n}
                try:
                    arrays = [np.resize(states[x], (n, states[x].shape[1])).astype(dtype) for x in INPUTS[term]]
                    there = [jax.device_put(x) for x in arrays]
                    result: list[Any] = []

                    def call() -> None:
                        result[:] = [function(*there)]  # noqa: B023

                    call()
                    first = difference(robot, term, arrays, np.asarray(result[0][-1000:]))
                    seconds = per_call(call, lambda: jax.block_until_ready(result))  # noqa: B023
                    last = difference(robot, term, arrays, np.asarray(result[0][-1000:]))
                    row |= {"call_seconds": seconds, "difference": max(first, last)}
                    row["equal"] = row["difference"] < AGREEMENT[dtype]
                except Exception as e:
                    row["left_out"] = f"{type(e).__name__}: {e}"[:200]
                show(row)
                if "left_out" in row:
                    break


def grid(dtype: str) -> None:
    """GRiD: code generated for the robot, compiled by nvcc; DUALPIN_GRID names the folder with ROBOT/grid.cuh."""
    folder = Path(os.environ["DUALPIN_GRID"])
    for robot_name in ROBOTS["grid"]:
        robot, states, _ = subject(robot_name)
        program = Path(tempfile.gettempdir(), f"dualpin_grid_{robot_name}_{dtype}")
        if not program.exists():
            real = "double" if dtype == "float64" else "float"
            command = ["nvcc", "-O3", "-std=c++17", "-arch=sm_90", f"-DREAL={real}", f"-I{folder / robot_name}"]
            subprocess.run([*command, str(Path(__file__).with_name("grid.cu")), "-o", str(program)], check=True)
        for n in BATCHES:
            arrays = [np.resize(states[x], (n, robot.nv)).astype(dtype) for x in INPUTS["rnea"]]
            with tempfile.TemporaryDirectory() as place:
                source, target = Path(place, "in"), Path(place, "out")
                np.concatenate(arrays, axis=1).tofile(source)
                command = [str(program), str(n), str(source), str(target)]
                done = subprocess.run(command, capture_output=True, text=True, check=True)
                threads, seconds = done.stdout.split()
                got = np.fromfile(target, dtype).reshape(n, robot.nv)
            apart = difference(robot, "rnea", arrays, got[-1000:])
            show(
                {
                    "peer": f"GRiD, {threads} threads a sample", "robot": robot_name, "term": "rnea", "dtype": dtype,
                    "batch": n, "call_seconds": float(seconds), "clock": "device_seconds", "difference": apart,
                    "equal": apart < AGREEMENT[dtype],
                }
            )  # fmt: skip


INPUTS = {"rnea": ("q", "v", "a"), "aba": ("q", "v", "tau")}


def subject(name: str) -> tuple[Any, dict[str, np.ndarray], str]:
    """The robot, its states, and a URDF file of it without meshes for the others."""
    import dualpin as dp

    from .correctness import robot_and_states

    robot, states = robot_and_states(name, False, BLOCK)
    path = Path(tempfile.gettempdir(), f"dualpin_{name}.urdf")
    dp.load(name).to_urdf(path)
    return robot, states | {"tau": states["a"]}, str(path)


def difference(robot: Any, term: str, arrays: list[np.ndarray], got: np.ndarray) -> float:
    """Scaled, of the last samples, from our double precision: of torques, also where accelerations were computed.

    Accelerations in single precision are as far from the truth as M's condition number makes them; the
    torques that they need are not.
    """
    *state, last = (np.asarray(x[-len(got) :], np.float64) for x in arrays)
    tau = robot.kernel("rnea")
    one, other = (tau(*state, np.asarray(got, np.float64)), last) if term == "aba" else (got, tau(*state, last))
    return float(np.max(np.abs(one - other)) / max(1.0, np.max(np.abs(other))))


def show(row: dict[str, Any]) -> None:
    print(json.dumps(row), flush=True)


if __name__ == "__main__":
    which, kind = sys.argv[1:3]
    if which == "grid":
        grid(kind)
    else:
        with_jax(which, kind)
