"""The sections of `python -m validation.benchmarks`: each has units that are measured, and kept, one by one."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import dualpin as dp
from dualpin import bench
from dualpin.call import find
from dualpin.model import Builder, Robot, revolute
from dualpin.spatial import AXES, Inertia, Matrix3, Pose, Vector3
from dualpin.terms import TERMS

Rows = list[dict[str, Any]]
ROBOTS = [("ur5", False), ("panda", False), ("talos", False), ("g1", False), ("tiago_dual", False),
          ("talos", True), ("g1", True)]  # fmt: skip
FEW = ("rnea", "aba", "crba", "coriolis", "fk", "jacobian")  # of tiago_dual
ONE_TO_MILLION = (1, 10, 100, 1_000, 10_000, 100_000, 1_000_000)
DOFS = (4, 8, 16, 32, 64, 128, 256)


def terms_of(name: str) -> tuple[str, ...]:
    return FEW if name == "tiago_dual" else bench.TERMS_MEASURED


def label(row: dict[str, Any]) -> str:
    """The robot of a row of the main table, with its base."""
    return f"{row['robot']}{' + floating' if row['floating'] else ''}"


def main_table(name: str, floating: bool, repetitions: int) -> Rows:
    return bench.run([name], terms_of(name), (4096, 1), floating=floating, progress=shown, repetitions=repetitions)


def functions() -> Rows:
    """One configuration through the public function and through `robot.kernel`, and Pinocchio's."""
    rows = []
    for name in ("ur5", "panda"):
        robot = dp.load(name)
        for term in ("rnea", "aba", "crba", "coriolis", "gravity", "fk", "jacobian"):
            pair = bench.Pair(robot, term, 1, 1)
            pair.check()
            kernel, function = pair.ours()[0], pair.function()
            mine, public, theirs = (1e6 * min(t) for t in bench.alternating([kernel, function, pair.theirs()[0]]))
            rows.append({"robot": name, "term": term, "kernel_us": mine, "function_us": public, "pinocchio_us": theirs})
            shown(rows[-1])
    return rows


def by_batch() -> Rows:
    rows = []
    for term in ("rnea", "crba"):
        for n in ONE_TO_MILLION if term == "rnea" else ONE_TO_MILLION[:-1]:
            rows += bench.run(["panda"], [term], (n,), progress=shown, repetitions=7)
    return rows


def by_threads() -> Rows:
    rows: Rows = []
    for name in ("panda", "talos"):
        for term in ("rnea", "aba"):
            robot = dp.load(name)
            calls = []
            pair = bench.Pair(robot, term, 65536, 1)
            f, _ = pair.ours()

            def on(n: int, times: int, f: Any = f) -> None:
                dp.set_num_threads(n)
                f(times)

            calls = [partial(on, 1), partial(on, 2)]
            one, two = map(min, bench.alternating(calls))
            dp.set_num_threads(None)
            rows.append({"robot": name, "term": term, "batch": 65536, "one_us": one / 65536 * 1e6,
                         "two_us": two / 65536 * 1e6, "speedup": one / two})  # fmt: skip
            shown(rows[-1])
    return rows


def chain(n: int) -> Robot:
    """A serial chain of n revolute joints, axes in turn, links of 0.1 m."""
    b = Builder(f"chain{n}")
    J = Matrix3(Vector3(2e-3, 0.0, 0.0), Vector3(0.0, 2e-3, 0.0), Vector3(0.0, 0.0, 1e-3))
    for i in range(n):
        place = Pose(position=Vector3(0.02, 0.0, 0.1))
        b.joint(f"joint{i}", revolute(AXES[i % 3]), f"link{i - 1}" if i else None, place,
                Inertia(1.0, Vector3(0.0, 0.0, 0.05), J), link=f"link{i}")  # fmt: skip
    return b.robot()


def by_dof() -> Rows:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for n in DOFS:
            path = Path(folder) / f"chain{n}.urdf"
            chain(n).to_urdf(path)
            robot = dp.load(path)
            for term in ("rnea", "aba", "crba") if n <= 64 else ("rnea", "aba"):
                kernel = find(robot, TERMS[term], {})
                (row,) = bench.run([robot], [term], (1024,), repetitions=7)
                rows.append({"dof": n, "operations": kernel.operations, **row})
                shown(rows[-1])
    return rows


def memory() -> Rows:
    """Bytes a sample moves (inputs and result), and the scratch of a tile, whatever the batch."""
    rows = []
    for name in ("ur5", "panda", "talos", "tiago_dual"):
        robot = dp.load(name)
        for term in ("rnea", "crba", "coriolis"):
            k = find(robot, TERMS[term], {})
            rows.append({"robot": name, "term": term, "bytes_per_sample": 8 * (sum(k.sizes) + k.width),
                         "scratch_bytes": k.scratch, "operations": k.operations})  # fmt: skip
    return rows


def cold_start() -> Rows:
    """A new process to its first torques: with an empty cache, and with the kernel in it; and compilations."""
    rows = []
    for name in ("ur5", "panda", "talos", "tiago_dual"):
        code = f"import dualpin as dp; r = dp.load({name!r}); dp.rnea(r, *r.sample(8, seed=0))"
        with tempfile.TemporaryDirectory() as folder:
            env = {**os.environ, "DUALPIN_CACHE_DIR": folder, "PYTHONWARNINGS": "ignore"}
            times = []
            for _ in range(3):
                start = time.perf_counter()
                subprocess.run([sys.executable, "-c", code], env=env, check=True)
                times.append(time.perf_counter() - start)
            rows.append({"robot": name, "cold_s": times[0], "warm_s": min(times[1:])})
            shown(rows[-1])
    return rows


def compile_times() -> Rows:
    from dualpin.engine.jit import kernel as kernels
    from dualpin.engine.jit.host import this_host

    rows = []
    for name in ("panda", "talos", "tiago_dual"):
        robot, host = dp.load(name), this_host()
        for term in ("rnea", "aba", "crba", "coriolis", "fk", "minv"):
            start = time.perf_counter()
            about, code = kernels.compiled(robot, TERMS[term], {}, np.dtype(float), host, host.lanes(8))
            seconds = time.perf_counter() - start
            rows.append({"robot": name, "term": term, "operations": about["operations"], "seconds": seconds,
                         "kilobytes": len(code) / 1024})  # fmt: skip
            shown(rows[-1])
    return rows


WHOLE: dict[str, Callable[[], Rows]] = {
    "single": functions, "batch": by_batch, "threads": by_threads, "dof": by_dof, "memory": memory,
    "compile": compile_times, "cold_start": cold_start,
}  # fmt: skip
SECTIONS = ("main", *WHOLE)


def units(section: str, repetitions: int = bench.REPETITIONS) -> dict[str, Callable[[], Rows]]:
    """What a section measures, by the names of its parts: the main table robot by robot, all others at once."""
    if section != "main":
        return {"": WHOLE[section]}
    return {
        label({"robot": name, "floating": floating}): partial(main_table, name, floating, repetitions)
        for name, floating in ROBOTS
    }


def shown(row: dict[str, Any]) -> None:
    print(*(f"{x:.4g}" if isinstance(x, float) else x for x in row.values()), file=sys.stderr, flush=True)


def prepare() -> None:
    for name, floating in ROBOTS:
        robot = dp.load(name, floating=floating)
        for term in terms_of(name):
            pair = bench.Pair(robot, term, 1, 1)
            pair.ours()
            find(robot, pair.term, pair.options)
            print(name, term, file=sys.stderr, flush=True)
