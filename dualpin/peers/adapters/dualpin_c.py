"""The C that dualpin exports, gcc -O3 -march=native, in a C loop: beside other generated C."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import _native as native
import numpy as np

REQUIRES = ("dualpin",)
MODULE = "dualpin"
TERMS = ("rnea", "aba", "crba", "coriolis", "fk", "minv", "rnea_derivatives")
LOOP = """
void run(int n, int times, const double* q, const double* v, const double* a, int nq, int nv, double* out, int width)
{
  for (int t = 0; t < times; t++)
    for (int i = 0; i < n; i++) {
      const double *Q = q + (long)nq * i, *V = v + (long)nv * i, *A = a + (long)nv * i;
      double* result = out + (long)width * i;
      (void)Q; (void)V; (void)A;
      CALL;
    }
}
"""


def made(folder: Path) -> dict[str, Any]:
    import dualpin as dp
    from dualpin.terms import TERMS as KNOWN

    robot = dp.load(folder / "robot.urdf").with_gravity(np.load(folder / "model.npz")["gravity"].tolist())
    letters = {"q": "Q", "v": "V", "a": "A", "tau": "A"}
    libraries: dict[str, ctypes.CDLL] = {}

    def each(term: str) -> tuple[Any, Any]:
        shape = KNOWN[term].shape(robot)
        width = int(np.prod(shape, dtype=int))
        spare: dict[int, np.ndarray] = {}

        def run(Q: Any, V: Any, A: Any, times: int) -> np.ndarray:
            if term not in libraries:
                code = dp.export_c(robot, term, name=f"f_{term}")
                call = f"f_{term}({', '.join(letters[x] for x in KNOWN[term].inputs)}, result)"
                source = code.source.replace(f'#include "f_{term}.h"', "") + LOOP.replace("CALL", call)
                libraries[term] = native.compiled(source, ["-lm"], ".c")
            out = spare.setdefault(len(Q), np.empty((len(Q), width)))
            given = [*map(native.pointer, (Q, V, A)), robot.nq, robot.nv, native.pointer(out), width]
            libraries[term].run(len(Q), times, *given)
            return out

        return lambda Q, V, A: run(Q, V, A, 1).reshape(-1, *shape).copy(), run

    return {
        "version": dp.__version__, "joints": np.load(folder / "model.npz")["names"].tolist(),
        "each": {t: each(t) for t in TERMS}, "how": "exported C in a C loop, results stored",
    }  # fmt: skip
