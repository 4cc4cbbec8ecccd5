"""The C that CppADCodeGen generates of Pinocchio, gcc -Ofast -march=native, in a C++ loop."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import Any

import _native as native
import numpy as np
import pinocchio_native as plain

REQUIRES = plain.REQUIRES = ("pin==4.1.0", "cmeel-eigen", "cmeel-boost", "cmeel-cppad", "cmeel-cppadcodegen")
MODULE = ""
ENVIRONMENT = "pinocchio_native"


def made(folder: Path) -> dict[str, Any]:
    model = np.load(folder / "model.npz")
    found = plain.library("-DCODEGEN", "-O1")
    handle = plain.robot(found, model)
    compiler = folder / "gcc-native"
    compiler.write_text('#!/bin/sh\nexec gcc -march=native "$@"\n')
    compiler.chmod(0o755)
    rows: dict[int, np.ndarray] = {}

    def each(term: str) -> tuple[Any, Any]:
        def run(Q: Any, V: Any, A: Any, times: int, out: np.ndarray | None) -> None:
            x = rows.setdefault(Q.ctypes.data, np.ascontiguousarray(np.concatenate([Q, V, A], 1)))
            given = native.pointer(x), native.pointer(out), str(compiler).encode()
            if found.run(handle, term.encode(), len(Q), times, *given):
                raise KeyError(term)

        def stored(Q: Any, V: Any, A: Any) -> np.ndarray:
            out = np.empty_like(V)
            run(Q, V, A, 1, out)
            return out

        return stored, lambda Q, V, A, times: run(Q, V, A, times, None)

    return {
        "version": f"{version('pin')}, cppadcodegen {version('cmeel-cppadcodegen')}", "joints": model["names"].tolist(),
        "each": {t: each(t) for t in ("rnea", "aba")}, "how": "generated C in a C++ loop, results not stored",
    }  # fmt: skip
