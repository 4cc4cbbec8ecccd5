"""adam's formulas as CasADi's C code, gcc -O3 -march=native, in a C loop: M a + h for inverse dynamics."""

from __future__ import annotations

import ctypes
import xml.etree.ElementTree as ET
from importlib.metadata import version
from pathlib import Path
from typing import Any

import _native as native
import numpy as np

REQUIRES = ("adam-robotics[casadi]==0.5.0",)
MODULE = "liecasadi"
LOOP = """
void run(int n, int times, int k, int width, const double* x, double* out, double* spare)
{
  for (int t = 0; t < times; t++)
    for (int i = 0; i < n; i++) {
      const double* in[3] = {x + (long)3 * k * i, x + (long)(3 * i + 1) * k, x + (long)(3 * i + 2) * k};
      double* to[1] = {out ? out + (long)width * i : spare};
      f(in, to, 0, 0, 0);
    }
}
"""


def made(folder: Path) -> dict[str, Any]:
    import casadi as cs
    from adam.casadi import KinDynComputations

    urdf = folder / "robot.urdf"
    names = [j.get("name", "") for j in ET.parse(urdf).getroot().findall("joint") if j.get("type") != "fixed"]
    gravity = np.r_[np.load(folder / "model.npz")["gravity"], 0.0, 0.0, 0.0]
    k, n = KinDynComputations(str(urdf), names, gravity=gravity), len(names)
    q, v, a, base, still = cs.SX.sym("q", n), cs.SX.sym("v", n), cs.SX.sym("a", n), np.eye(4), np.zeros(6)

    def each(term: str) -> tuple[Any, Any]:
        library: list[ctypes.CDLL] = []

        def code() -> ctypes.CDLL:
            if not library:
                M = k.mass_matrix(base, q)[6:, 6:]
                y = M if term == "crba" else M @ a + k.bias_force(base, q, still, v)[6:]
                f = cs.Function("f", [q, v, a], [cs.densify(y)])
                generator = cs.CodeGenerator("f.c", {"with_header": False})
                generator.add(f)
                library.append(native.compiled(generator.dump() + LOOP, [], ".c"))
            return library[0]

        def run(Q: Any, V: Any, A: Any, times: int, out: np.ndarray | None) -> None:
            x = np.ascontiguousarray(np.stack([Q, V, A], 1))
            width = n * n if term == "crba" else n
            spare = np.empty(width)
            code().run(len(Q), times, n, width, *map(native.pointer, (x, out, spare)))

        def stored(Q: Any, V: Any, A: Any) -> np.ndarray:
            out = np.empty((len(Q), n, n) if term == "crba" else Q.shape)
            run(Q, V, A, 1, out)
            return out

        return stored, lambda Q, V, A, times: run(Q, V, A, times, None)

    return {
        "version": f"{version('adam-robotics')}, casadi {cs.__version__}", "joints": names,
        "each": {t: each(t) for t in ("rnea", "crba")}, "how": "generated C in a C loop, results not stored",
    }  # fmt: skip
