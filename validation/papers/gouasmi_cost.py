"""The PUMA 560 of Gouasmi et al. by dual quaternions, dual matrices and homogeneous ones: what each costs."""

from __future__ import annotations

import runpy
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from dualpin import Dual
from dualpin.spatial import UX, UZ, ZERO_VECTOR, Pose, Quaternion, Rotation, Vector3, motor

from .counting import Counted, count

# one set of lengths, of Armstrong, Khatib & Burdick (1986), for the URDF and for this page
_MODEL = runpy.run_path(str(Path(__file__).parents[2] / "urdf" / "puma560" / "generate.py"))
A2, A3, D2, D3, D4 = (_MODEL[name] for name in ("A2", "A3", "D2", "D3", "D4"))
ALPHA = np.radians([-90.0, 0, 90, -90, 90, 0])
LENGTH, OFFSET = (0.0, A2, A3, 0, 0, 0), (0.0, D2, D3, D4, 0, 0)


# --- the same chain three ways, over any scalar ------------------------------------------------------


def _links(kind: Any) -> list[Any]:
    """The constant link transforms X(alpha + eps a)."""
    found = []
    for a, alpha in zip(LENGTH, ALPHA, strict=True):
        angle = Dual(float(alpha), float(a))
        if kind is Quaternion:
            found.append(Quaternion.about(displacement_axis(UX), angle))
        elif kind is Rotation:
            found.append(Rotation.about(UX, angle))
        else:
            found.append(Pose.about(UX, angle))
    return found


def displacement_axis(axis: Vector3) -> Vector3:
    return motor(axis, ZERO_VECTOR)


def by_quaternions(q: list[Any]) -> Quaternion:
    """Product of Z(theta + eps d) X(alpha + eps a) as dual quaternions."""
    total = None
    for t, d, X in zip(q, OFFSET, _QUATERNIONS, strict=False):
        step = Quaternion.about(displacement_axis(UZ), Dual(t, d)) * X
        total = step if total is None else total * step
    return total


def by_dual_matrices(q: list[Any]) -> Rotation:
    """The same as dual 3 x 3 matrices."""
    total = None
    for t, d, X in zip(q, OFFSET, _ROTATIONS, strict=False):
        step = Rotation.about(UZ, Dual(t, d)) @ X
        total = step if total is None else total @ step
    return total


def by_homogeneous(q: list[Any]) -> Pose:
    """The same as homogeneous matrices [R p; 0 1]."""
    total = None
    for t, d, X in zip(q, OFFSET, _POSES, strict=False):
        step = Pose.about(UZ, Dual(t, d)) @ X
        total = step if total is None else total @ step
    return total


_QUATERNIONS, _ROTATIONS, _POSES = (_links(kind) for kind in (Quaternion, Rotation, Pose))
WAYS: dict[str, Callable[[list[Any]], Any]] = {
    "dual quaternions (8 numbers)": by_quaternions,
    "dual 3 x 3 matrices (18 numbers)": by_dual_matrices,
    "homogeneous DH matrices (12 numbers)": by_homogeneous,
}


def costs() -> str:
    """Operations counted by running; times of batches of 10,000 and of one call, as ratios."""
    rng = np.random.default_rng(0)
    one, many = list(map(float, rng.standard_normal(6))), list(rng.standard_normal((6, 10_000)))
    lines = [
        "## Cost of the forward kinematics of the PUMA 560",
        "",
        "Counted by running the product of Z(theta + eps d) X(alpha + eps a) on a scalar that counts; products with "
        "known zeros and ones are free, constants of the links are prepared. Time relative to homogeneous matrices, "
        "best of 7, plain Python (one call) and NumPy columns (10,000 calls).",
        "",
        "| representation | products | sums | sines, cosines | time, one call | time, 10,000 calls |",
        "|---|---|---|---|---|---|",
    ]
    base = [_seconds(lambda x=x: by_homogeneous(x)) for x in (one, many)]
    for name, f in WAYS.items():
        n = count(f, [Counted() for _ in range(6)])
        ratios = [_seconds(lambda x=x, f=f: f(x)) / b for x, b in zip((one, many), base, strict=True)]
        lines.append(f"| {name} | {n[0]} | {n[1]} | {n[2]} | {ratios[0]:.2f} | {ratios[1]:.2f} |")
    return "\n".join(lines)


def _seconds(f: Callable[[], Any]) -> float:
    best = np.inf
    for _ in range(7):
        start = time.perf_counter()
        f()
        best = min(best, time.perf_counter() - start)
    return best
