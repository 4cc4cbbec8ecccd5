"""From IR to PTX, the portable assembly of Nvidia GPUs, by LLVM's back end."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

from ..jit.host import CompilerError, binding
from .scalar import DEVICE


@cache
def target() -> Any:
    """LLVM's back end for PTX.

    Raises
    ------
    CompilerError
        If this llvmlite was built without it.
    """
    llvm = binding()
    try:
        llvm.initialize_all_targets()
        llvm.initialize_all_asmprinters()
        return llvm.Target.from_triple(DEVICE.triple)
    except Exception as e:  # an incomplete installation raises various errors
        raise CompilerError(f"llvmlite has no back end for Nvidia's GPUs: {type(e).__name__}: {e}") from e


def assembly(text: str) -> str:
    """PTX of a module, with small functions inlined and without further optimisation."""
    llvm = binding()
    machine = target().create_target_machine(cpu=DEVICE.cpu, features=DEVICE.features, opt=2)
    try:
        module = llvm.parse_assembly(inlinable(text, machine), llvm.create_context())
        inlined(module, machine)
        return machine.emit_assembly(module)
    except RuntimeError as e:
        raise CompilerError(f"LLVM: {e}") from e


def inlinable(text: str, machine: Any) -> str:
    return f'target triple = "{machine.triple}"\ntarget datalayout = "{machine.target_data}"\n{text}'


def inlined(module: Any, machine: Any) -> None:
    """Inline the functions with the attribute alwaysinline; run no other pass."""
    llvm = binding()
    options = llvm.create_pipeline_tuning_options(speed_level=0)
    builder = llvm.create_pass_builder(machine, options)
    passes = llvm.create_new_module_pass_manager()
    passes.add_always_inliner_pass()
    passes.run(module, builder)


def bounded(ptx: str, threads: int, blocks: int) -> str:
    """Add the launch bounds, threads of a block and resident blocks, from which the assembler allots registers."""
    return re.sub(r"(\.entry kernel\([^)]*\)\s*)\{", rf"\1.maxntid {threads}\n.minnctapersm {blocks}\n{{", ptx, count=1)
