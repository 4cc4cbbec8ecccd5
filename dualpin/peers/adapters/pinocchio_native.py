"""Pinocchio's headers compiled for this machine, -O3 -march=native, in C++ loops."""

from __future__ import annotations

import ctypes
from importlib.metadata import version
from pathlib import Path
from typing import Any

import _native as native
import numpy as np

REQUIRES = ("pin==4.1.0", "cmeel-eigen", "cmeel-boost", "cmeel-cppad", "cmeel-cppadcodegen")
MODULE = ""
TERMS = ("rnea", "aba", "crba", "coriolis", "fk", "minv", "rnea_derivatives", "rnea_second_derivatives")
FLAGS = [
    "-std=c++17", "-DNDEBUG", "-DBOOST_FUSION_INVOKE_MAX_ARITY=10", "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
]  # fmt: skip


def library(*more: str) -> ctypes.CDLL:
    import cmeel

    include = Path(next(iter(cmeel.__path__))).parent / "cmeel.prefix" / "include"
    source = Path(__file__).with_name("pinocchio_loops.cpp").read_text()
    found = native.compiled(source, [*FLAGS, f"-I{include}", f"-I{include}/eigen3", *more, "-ldl"], ".cpp")
    found.make.restype = ctypes.c_void_p
    return found


def robot(found: ctypes.CDLL, model: Any) -> ctypes.c_void_p:
    given = [np.ascontiguousarray(model[k]) for k in ("kinds", "parents", "numbers", "gravity")]
    return ctypes.c_void_p(found.make(len(given[0]), *map(native.pointer, given)))


def shape(term: str, joints: int, nv: int) -> tuple[int, ...]:
    if term == "fk":
        return (joints, 4, 4)
    if term == "rnea_second_derivatives":
        return (4, nv, nv, nv)
    return {"rnea": (nv,), "aba": (nv,), "rnea_derivatives": (3, nv, nv)}.get(term, (nv, nv))


def made(folder: Path) -> dict[str, Any]:
    model = np.load(folder / "model.npz")
    found = library()
    handle, n = robot(found, model), len(model["kinds"])

    def each(term: str) -> tuple[Any, Any]:
        def run(Q: Any, V: Any, A: Any, times: int, out: np.ndarray | None) -> None:
            arrays = map(native.pointer, (Q, V, A, out))
            if found.run(handle, term.encode(), len(Q), times, *arrays):
                raise KeyError(term)

        def stored(Q: Any, V: Any, A: Any) -> np.ndarray:
            out = np.empty((len(Q), *shape(term, n, Q.shape[1])))
            run(Q, V, A, 1, out)
            return np.swapaxes(out, -1, -3) if out.ndim == 5 else out  # tensors come with their first index fastest

        return stored, lambda Q, V, A, times: run(Q, V, A, times, None)

    return {
        "version": f"{version('pin')}, gcc -O3 -march=native", "joints": model["names"].tolist(),
        "each": {t: each(t) for t in TERMS}, "how": "loop in C++, results not stored",
    }  # fmt: skip
