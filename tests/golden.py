"""The golden values: 25 digits, generated with mpmath at 140."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from dualpin import Dual

REFERENCE: dict[str, Any] = json.loads((Path(__file__).parent / "data" / "reference.json").read_text())


def numbers(x: Any) -> Any:
    """Decimal strings as floats, in nested lists."""
    return [numbers(i) for i in x] if isinstance(x, list) else float(x)


def array(x: Any) -> np.ndarray:
    return np.array(numbers(x))


def dual(x: Any) -> Dual:
    """{"real": ..., "dual": ...}, or a list of such."""
    if isinstance(x, list):
        return np.stack([dual(i) for i in x])
    return Dual(np.array(numbers(x["real"]))[()], np.array(numbers(x["dual"]))[()])


def close(got: Any, want: Any, tol: float = 1e-12) -> None:
    """max |got - want| <= tol max(1, max |want|), both parts."""
    got, want = (x if hasattr(x, "dual") else Dual(np.asarray(x)) for x in (got, want))
    for part in ("real", "dual"):
        a, b = np.asarray(getattr(got, part)), np.asarray(getattr(want, part))
        assert a.shape == b.shape, (part, a.shape, b.shape)
        error = np.abs(a - b).max(initial=0.0) / max(1.0, np.abs(b).max(initial=0.0))
        assert error <= tol, f"{part} part: scaled error {error:.3g} > {tol:.3g}\n got {a}\nwant {b}"


def aligned(V: Any, W: Any, axis: int = -2) -> Any:
    """V with the sign of each column that makes it agree with W."""
    sign = np.sign((np.asarray(V.real) * np.conj(W.real)).sum(axis=axis, keepdims=True).real)
    return V * sign
