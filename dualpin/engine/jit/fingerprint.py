"""The key of a kernel: a hash of the robot, the sources and the machine."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...model.memory import memory
from ...model.robot import Frame, Robot
from ...scalars import Exact
from ...spatial.pose import Pose
from ...terms import Options, Term
from .host import Host, binding

# sources that determine the results or the calling convention of a kernel
_SOURCES = (
    "algorithms", "engine", "model", "spatial", "dual.py", "parts.py", "scalars.py", "terms.py", "ufuncs.py",
)  # fmt: skip
# sources that only call kernels
_CALLERS = {
    f"engine/{name}.py"
    for name in (
        "jit/cache", "jit/fast_call", "jit/threads", "jit/xla", "codegen/c_like", "codegen/fast_call", "codegen/xla",
    )
}  # fmt: skip


@cache
def sources() -> str:
    """A hash of the source files from which kernels are made."""
    root = Path(__file__).parents[2]
    total = hashlib.sha256()
    for name in _SOURCES:
        place = root / name
        for path in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
            if path.relative_to(root).as_posix() in _CALLERS:
                continue
            total.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return total.hexdigest()


def robot_key(robot: Robot) -> str | None:
    """A hash of all constants of the robot; None if it uses classes from outside the package."""
    known: str | None = memory(robot).get("fingerprint")
    if known is None:
        total = hashlib.sha256()
        for text in _description(robot):
            if text is None:
                return None
            total.update(text.encode() + b";")
        known = memory(robot)["fingerprint"] = total.hexdigest()
    return known


def _description(robot: Robot) -> Iterator[str | None]:
    yield _numbers(robot.gravity)
    for j in robot:
        kind = type(j.model)
        # a joint model from outside: its source is not hashed
        yield kind.__qualname__ if kind.__module__.startswith(__package__.partition(".")[0] + ".") else None
        yield f"{-1 if j.parent is None else j.parent.index} {j.q} {j.v} {j.model.kind} {j.mimic}"
        yield _pose(j.placement)
        yield _numbers(j.inertia.parameters) + _numbers(j.armature)
        for name, value in sorted(vars(j.model).items()):
            yield name + _model_part(value)


def _pose(X: Pose) -> str:
    return _numbers(X.position) + "".join(_numbers(row) for row in X.rotation.rows)


def _numbers(values: Any) -> str:
    return ",".join(f"={x.n}" if type(x) is Exact else repr(float(x)) for x in values) + " "


def _model_part(value: Any) -> str:
    """Attributes of joint models: numbers, duals, vectors, and tuples of them, by their repr.

    The repr of an exact constant differs from that of the equal float.
    """
    return "" if hasattr(value, "motion") else repr(value)


def compiler_key(host: Host) -> str:
    """The compiler and its target."""
    return f"LLVM {'.'.join(map(str, binding().llvm_version_info))}|{host.key}"


def key(robot: Robot, term: Term, options: Options, dtype: np.dtype, host: Host, lanes: int) -> str | None:
    """All that a kernel depends on, as text; None for a kernel that must not be cached."""
    from ... import __version__

    mine = robot_key(robot)
    if mine is None:
        return None
    chosen = []
    for name, value in sorted(options.items()):
        if isinstance(value, Frame):
            value = f"{-1 if value.joint is None else value.joint.index} {_pose(value.placement)}"
        chosen.append(f"{name}={value}")
    made_for = [str(np.dtype(dtype)), f"{lanes} lanes"]
    return "|".join([__version__, sources(), compiler_key(host), mine, term.name, *made_for, *chosen])
