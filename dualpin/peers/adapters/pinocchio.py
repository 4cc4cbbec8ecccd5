"""Pinocchio as its wheel comes: its parallel loops in C++ on one thread where there are, else Python's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

REQUIRES = ("pin==4.1.0",)
MODULE = "pinocchio"


def made(folder: Path) -> dict[str, Any]:
    import pinocchio as pin

    m = pin.buildModelFromUrdf(str(folder / "robot.urdf"))
    d = m.createData()

    def stacked(q: np.ndarray) -> np.ndarray:
        pin.forwardKinematics(m, d, q)
        return np.array([x.homogeneous for x in list(d.oMi)[1:]])

    def full(M: np.ndarray) -> np.ndarray:
        return np.triu(M) + np.triu(M, 1).T

    def derivatives(q: Any, v: Any, a: Any) -> np.ndarray:
        dq, dv, M = pin.computeRNEADerivatives(m, d, q, v, a)
        return np.array([dq, dv, full(M)])

    pool = pin.ModelPool(m, 1)
    out = {}

    def parallel(name: str) -> Any:
        f = getattr(pin, name)

        def call(Q: np.ndarray, V: np.ndarray, A: np.ndarray) -> np.ndarray:
            key = (name, Q.ctypes.data)
            if key not in out:
                out[key] = [np.asfortranarray(x.T) for x in (Q, V, A)], np.empty((m.nv, len(Q)), order="F")
            arrays, result = out[key]
            f(1, pool, *arrays, result)
            return result.T

        return call

    return {
        "version": pin.__version__,
        "joints": list(m.names)[1:],
        "single": {
            "rnea": lambda q, v, a: pin.rnea(m, d, q, v, a), "aba": lambda q, v, a: pin.aba(m, d, q, v, a),
            "crba": lambda q, v, a: pin.crba(m, d, q),
            "coriolis": lambda q, v, a: pin.computeCoriolisMatrix(m, d, q, v),
            "fk": lambda q, v, a: pin.forwardKinematics(m, d, q),
            "rnea_derivatives": lambda q, v, a: pin.computeRNEADerivatives(m, d, q, v, a),
        },
        "checked": {
            "crba": lambda q, v, a: full(pin.crba(m, d, q)), "fk": lambda q, v, a: stacked(q),
            "rnea_derivatives": derivatives,
        },
        "batch": {"rnea": parallel("rneaInParallel"), "aba": parallel("abaInParallel")},
        "how": "its loop in C++, one thread",
    }  # fmt: skip
