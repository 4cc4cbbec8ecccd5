"""Kernels for another processor: cross-compiled for AArch64 (NEON), linked into a C program, run by qemu.

It needs qemu-user (`qemu-aarch64`) and a cross compiler (`pip install ziglang`).
"""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys

import numpy as np
import pytest

import dualpin as dp
from dualpin.engine.codegen.host import Host
from dualpin.engine.jit.compiler import split
from dualpin.engine.jit.kernel import compiled
from dualpin.terms import TERMS

QEMU = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(QEMU is None or importlib.util.find_spec("ziglang") is None, reason="needs qemu-user and zig"),
]
NEON = Host("aarch64-unknown-linux-gnu", "generic", "+neon", 16, fma=True)
MAIN = r"""
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

double dualpin_sin(double x) { return sin(x); }
double dualpin_cos(double x) { return cos(x); }
int64_t dualpin_stores[2] = {INT64_MAX, 0};
void kernel(int64_t n, void *scratch, void **pointers, int64_t *strides);

int main(void) {
    static const int64_t n = %(n)d, sizes[] = {%(sizes)s, %(width)d};
    void *pointers[%(arrays)d];
    int64_t strides[%(arrays)d];
    for (int i = 0; i < %(arrays)d; ++i) {
        strides[i] = sizes[i];
        pointers[i] = calloc(n * sizes[i] + 1, sizeof(%(c)s));
        if (i < %(arrays)d - 1 && fread(pointers[i], sizeof(%(c)s), n * sizes[i], stdin) != (size_t)(n * sizes[i]))
            return 1;
    }
    void *scratch = aligned_alloc(64, (%(scratch)d / 64 + 2) * 64);
    kernel(n, scratch, pointers, strides);
    fwrite(pointers[%(arrays)d - 1], sizeof(%(c)s), n * %(width)d, stdout);
    return 0;
}
"""


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize(("name", "term"), [
    ("ur5", "rnea"), ("panda", "aba"), ("panda", "crba"), ("talos", "rnea"), ("panda", "fk"), ("panda", "coriolis"),
])  # fmt: skip
def test_a_kernel_for_neon_computes_the_same(name, term, dtype, tmp_path):
    """On 37 samples, of which the last ones do not fill a vector: within a few roundings of this machine's results."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    robot = dp.load(name)
    kind, what = np.dtype(dtype), TERMS[term]
    about, code = compiled(robot, what, {}, kind, NEON, NEON.lanes(kind.itemsize))
    objects = []
    for k, part in enumerate(split(code, about["objects"])):
        objects.append(tmp_path / f"part{k}.o")
        objects[-1].write_bytes(part)
    assert objects[0].read_bytes()[18:20] == b"\xb7\x00"  # EM_AARCH64
    width = int(np.prod(what.shape(robot), dtype=int))
    q, v, a = (x.astype(kind) for x in robot.sample(37, seed=5))
    arrays = [q, v, a][: len(what.arguments)]
    (tmp_path / "main.c").write_text(MAIN % {
        "n": 37, "sizes": ", ".join(map(str, about["sizes"])), "width": width, "arrays": len(arrays) + 1,
        "scratch": about["scratch"], "c": "double" if kind.itemsize == 8 else "float",
    })  # fmt: skip
    program = tmp_path / "main"
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "aarch64-linux-musl", "-static", "-O1"]
    built = [*zig, "main.c", *map(str, objects), "-o", str(program)]
    done = subprocess.run(built, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    ran = subprocess.run([QEMU, program], input=b"".join(x.tobytes() for x in arrays), capture_output=True, timeout=600)
    assert ran.returncode == 0, ran.stderr
    found = np.frombuffer(ran.stdout, kind).reshape(37, *what.shape(robot))
    here = robot.kernel(term, dtype=kind)(*arrays)
    scale = np.abs(here).max()
    # the same operations in the same order; sines are the C library's there, and each may round otherwise
    assert np.abs(found - here).max() <= 64 * np.finfo(kind).eps * scale * max(1.0, _condition(robot, term, q))


def _condition(robot, term, q):
    return float(np.linalg.cond(dp.crba(robot, q.astype(float))).max()) if term == "aba" else 1.0
