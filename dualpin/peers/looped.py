"""Our kernels in a loop of machine code, as generated C is called in a loop of C: one state a call, without Python."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence

import numpy as np

from ..engine.codegen.c_like import Writer
from ..engine.jit.compiler import loaded, object_code
from ..engine.jit.host import this_host
from ..engine.jit.kernel import build, scratch
from ..locking import Once
from ..model.robot import Robot
from ..terms import TERMS


@Once
def _loop() -> object:
    """void loop(i64 times, i64 n, i64 count, kernel, scratch, arrays, strides, strides in bytes)"""
    c = Writer(
        "void @loop() nounwind", times="i64", n="i64", count="i64", kernel="ptr", scratch="ptr", arrays="ptr",
        strides="ptr", steps="ptr",
    )  # fmt: skip
    times, n, count, kernel, memory, arrays, strides, steps = c.parameters
    pointers = c.room("ptr", count)
    with c.for_(times), c.for_(n) as i:
        with c.for_(count) as k:
            c.store(arrays.item("ptr", k).at("i8", i * steps.item("i64", k)), pointers.at("ptr", k))
        c.call(kernel, c.number(1), memory, pointers, strides)
    c.returns()
    return loaded([object_code(c.text, this_host())], ("loop",), {})


def looped(robot: Robot, term: str, inputs: Sequence[np.ndarray], out: np.ndarray) -> Callable[[int], None]:
    """(times) -> None: so many runs over the rows of the inputs (n, size), each result in its row of out."""
    kernel = build(robot, TERMS[term], {}, np.float64, single=True)
    made = _loop()
    arrays = [np.ascontiguousarray(x) for x in (*inputs, out)]
    assert arrays[-1] is out
    count, n = len(arrays), len(out)
    pointers = (ctypes.c_void_p * count)(*(x.ctypes.data for x in arrays))
    strides, steps = ((ctypes.c_int64 * count)(*(x[0].size * by for x in arrays)) for by in (1, 8))
    f = ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * 3, *[ctypes.c_void_p] * 5)(made["loop"])  # type: ignore[index]
    _, address = kept = scratch(kernel.scratch)

    def run(times: int) -> None:
        f(times, n, count, kernel.address, address, pointers, strides, steps)

    run.kept = (arrays, kernel, made, kept)  # type: ignore[attr-defined]
    return run
