"""frax on JAX with 64 bits: compiled, and mapped over a batch."""

from __future__ import annotations

import os
import warnings
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("frax==0.1.0",)
MODULE = "frax"


def made(folder: Path) -> dict[str, Any]:
    os.environ |= {"JAX_ENABLE_X64": "1", "JAX_PLATFORMS": "cpu"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import frax
    import jax

    r = frax.Robot(str(folder / "robot.urdf"))
    up = np.r_[-np.load(folder / "model.npz")["gravity"], 0.0, 0.0, 0.0]
    terms = {
        "rnea": lambda q, v, a: r.rnea(q, v, a, up, None), "aba": lambda q, v, tau: r.forward_dynamics(q, v, tau, None),
        "crba": lambda q, v, a: r.mass_matrix(q),
    }  # fmt: skip

    def ready(f: Any) -> Any:
        return lambda *x: jax.block_until_ready(f(*x))

    return {
        "version": f"{version('frax')}, jax {jax.__version__}", "joints": list(r.joint_names),
        "single": {t: ready(jax.jit(f)) for t, f in terms.items()},
        "batch": {t: ready(jax.jit(jax.vmap(f))) for t, f in terms.items()}, "how": "jit(vmap)",
    }  # fmt: skip
