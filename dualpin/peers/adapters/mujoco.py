"""MuJoCo without damping, friction and constraints, in a loop in C over its functions."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import _native as native
import numpy as np

REQUIRES = ("mujoco==4.0.0", "numpy")
MODULE = "mujoco"
OFF = ("CONTACT", "LIMIT", "FRICTIONLOSS", "EQUALITY", "DAMPER", "SPRING")
LOOP = """
#include <mujoco/mujoco.h>
#include <string.h>
void run(const mjModel* m, mjData* d, const char* term, int n, int times, const double* q, const double* v,
         const double* a, double* out)
{
  const int k = m->nv, matrix = !strcmp(term, "crba"), inverse = !strcmp(term, "rnea");
  for (int t = 0; t < times; t++)
    for (int i = 0; i < n; i++) {
      memcpy(d->qpos, q + i * k, k * sizeof(double));
      memcpy(d->qvel, v + i * k, k * sizeof(double));
      if (matrix) {
        mj_kinematics(m, d); mj_comPos(m, d); mj_crb(m, d);
        if (out) mj_fullM(m, d, out + (long)i * k * k);
      } else if (inverse) {
        memcpy(d->qacc, a + i * k, k * sizeof(double));
        mj_inverse(m, d);
        if (out) memcpy(out + i * k, d->qfrc_inverse, k * sizeof(double));
      } else {
        memcpy(d->qfrc_applied, a + i * k, k * sizeof(double));
        mj_forward(m, d);
        if (out) memcpy(out + i * k, d->qacc, k * sizeof(double));
      }
    }
}
"""


def made(folder: Path) -> dict[str, Any]:
    import mujoco as mj

    text = (folder / "robot.urdf").read_text(encoding="utf-8")
    at = text.index(">", text.index("<robot")) + 1
    flags = 'discardvisual="false" fusestatic="false" balanceinertia="false"'
    m = mj.MjModel.from_xml_string(f"{text[:at]}<mujoco><compiler {flags}/></mujoco>{text[at:]}")
    d = mj.MjData(m)
    m.opt.gravity[:] = np.load(folder / "model.npz")["gravity"]
    for bit in OFF:
        m.opt.disableflags |= getattr(mj.mjtDisableBit, f"mjDSBL_{bit}", 0)
    place = Path(mj.__file__).parent
    (so,) = place.glob("libmujoco.so*")
    include = place / "include"
    found = native.compiled(LOOP, ["-std=c11", f"-I{include}", str(so), f"-Wl,-rpath,{place}"], ".c")

    def each(term: str) -> tuple[Any, Any]:
        def run(Q: Any, V: Any, A: Any, times: int, out: np.ndarray | None) -> None:
            handles = ctypes.c_void_p(m._address), ctypes.c_void_p(d._address)
            found.run(*handles, term.encode(), len(Q), times, *map(native.pointer, (Q, V, A, out)))

        def stored(Q: Any, V: Any, A: Any) -> np.ndarray:
            out = np.zeros((len(Q), m.nv, m.nv) if term == "crba" else Q.shape)
            run(Q, V, A, 1, out)
            return out

        return stored, lambda Q, V, A, times: run(Q, V, A, times, None)

    return {
        "version": mj.__version__, "joints": [m.joint(i).name for i in range(m.njnt)],
        "each": {t: each(t) for t in ("rnea", "aba", "crba")}, "how": "loop in C, results not stored",
    }  # fmt: skip
