"""The resources of a kernel: registers, spills and occupancy, as `ptxas` reports them.

`ptxas` comes with the wheel nvidia-cuda-nvcc; it is needed only for this report.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ...errors import DeviceError
from ..tuning import GPU_THREADS
from .build import Plan
from .layout import WARP

HINT = "pip install 'dualpin[cuda]' brings it"
_REGISTERS, _WARPS, _BLOCKS = 65536, 64, 32  # of a multiprocessor
_UNIT = 256  # registers are allotted to a warp in units of this size
_SHARED = {80: 164, 86: 100, 87: 164, 89: 100, 90: 228}  # KiB of a multiprocessor
_RESERVED = 1024  # bytes of each block's shared memory


@dataclass(frozen=True)
class Resources:
    """The resources of a kernel on an architecture.

    Attributes
    ----------
    registers : int
        Registers of a thread, at most 255.
    stack : int
        Bytes of local memory of a thread: spills, and values passed between parts.
    spill_stores, spill_loads : int
        Bytes that a thread spills to and reloads from local memory.
    shared : int
        Bytes of shared memory of a block.
    blocks : int
        Resident blocks of a multiprocessor.
    occupancy : float
        Resident threads as a share of the maximum.
    """

    architecture: str
    operations: int
    parts: int
    registers: int
    stack: int
    spill_stores: int
    spill_loads: int
    threads: int
    shared: int
    blocks: int
    occupancy: float

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


@cache
def ptxas() -> str | None:
    """The assembler of the wheel, or of a CUDA toolkit on the PATH."""
    for folder in map(Path, sys.path):
        for name in ("cuda_nvcc", "cu13", "cu14"):
            for tool in ("ptxas", "ptxas.exe"):
                found = folder / "nvidia" / name / "bin" / tool
                if found.is_file():
                    return str(found)
    return shutil.which("ptxas")


def assembled(ptx: str, architecture: str) -> tuple[bytes, str]:
    """Machine code, and the report of the assembler.

    Raises
    ------
    DeviceError
        If there is no assembler, or it refuses.
    """
    tool = ptxas()
    if tool is None:
        raise DeviceError(f"registers and spills are reported by ptxas, which is not installed; {HINT}")
    with tempfile.TemporaryDirectory() as place:
        source, target = Path(place, "kernel.ptx"), Path(place, "kernel.cubin")
        source.write_text(ptx)
        done = subprocess.run(
            [tool, "-v", f"-arch={architecture}", str(source), "-o", str(target)],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            raise DeviceError(f"ptxas -arch={architecture}: {(done.stderr or done.stdout).strip()[:1000]}")
        return target.read_bytes(), done.stderr


def resources(plan: Plan, architecture: str = "sm_90") -> Resources:
    """The resources of the kernel of a plan.

    Raises
    ------
    DeviceError
        If there is no assembler, or it refuses.
    """
    said = assembled(plan.ptx(), architecture)[1]
    registers = _sum(r"Used (\d+) registers", said)
    shared = plan.layout.room * plan.number.size * (GPU_THREADS // WARP)
    blocks = resident(registers, shared, int(architecture.removeprefix("sm_").rstrip("af")))
    return Resources(
        architecture, plan.program.operations, len(plan.program.parts), registers,
        _sum(r"(\d+) bytes cumulative stack size", said) or _sum(r"(\d+) bytes stack frame", said),
        _sum(r"(\d+) bytes spill stores", said), _sum(r"(\d+) bytes spill loads", said),
        GPU_THREADS, shared, blocks, blocks * GPU_THREADS / (WARP * _WARPS),
    )  # fmt: skip


def _sum(pattern: str, text: str) -> int:
    return sum(map(int, re.findall(pattern, text)))


def resident(registers: int, shared: int, capability: int) -> int:
    """Resident blocks of a multiprocessor (CUDA C++ Programming Guide, compute capabilities)."""
    warps = GPU_THREADS // WARP
    of_warp = -(-registers * WARP // _UNIT) * _UNIT
    limits = [_BLOCKS, _WARPS // warps, _REGISTERS // max(1, of_warp) // warps]
    if shared:
        known = max((c for c in _SHARED if c <= capability), default=80)
        limits.append(_SHARED[known] * 1024 // (shared + _RESERVED))
    return min(limits)


__all__ = ["Resources", "assembled", "ptxas", "resources"]
