"""The machine of this process, as LLVM describes it."""

from __future__ import annotations

from typing import Any

from ... import locking
from ...errors import DualpinError
from ...locking import Once
from ..codegen.host import Host


class CompilerError(DualpinError):
    """There is no working compiler on this machine."""


def binding() -> Any:
    """llvmlite's binding, ready to compile for this machine.

    Raises
    ------
    CompilerError
        If llvmlite is missing or does not know this machine, or this process must not use it any more.
    """
    if locking.lost:
        raise CompilerError(locking.lost)
    return _initialised()


@Once
def _initialised() -> Any:
    try:
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        llvm.Target.from_default_triple()
    except ModuleNotFoundError as e:
        raise CompilerError(f"llvmlite: {e} (pip install llvmlite)") from e
    except Exception as e:  # an incomplete installation raises various errors
        raise CompilerError(f"llvmlite: {type(e).__name__}: {e}") from e
    return llvm


@Once
def this_host() -> Host:
    """The machine we run on."""
    llvm = binding()
    triple = llvm.get_process_triple()
    try:
        available = dict(llvm.get_host_cpu_features())
    except Exception:  # not known for every processor
        available = {}
    features = ",".join(f"{'+' if on else '-'}{name}" for name, on in sorted(available.items()))
    machine = triple.split("-")[0]
    has = {name for name, on in available.items() if on}
    if machine in ("x86_64", "amd64"):
        width = 64 if {"avx512f", "avx512vl", "avx512dq"} <= has else 32 if "avx2" in has else 16
        return Host(triple, llvm.get_host_cpu_name(), features, width, "fma" in has)
    if machine in ("aarch64", "arm64"):
        return Host(triple, llvm.get_host_cpu_name(), features, 16, True)
    return Host(triple, llvm.get_host_cpu_name(), features, 8, False)
