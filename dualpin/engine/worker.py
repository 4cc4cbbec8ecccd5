"""LLVM at work.  Imported, or run as a process of its own that needs nothing but llvmlite and so begins at once:

python worker.py     in: a line of JSON, the arguments of `object_code` and sys.path; then IR.  out: object code.
"""

from __future__ import annotations

import json
import sys


def object_code(text: str, triple: str, cpu: str, features: str, quick: bool) -> bytes:
    """IR to an object file; `quick` is a third of the time, for slower code."""
    import llvmlite.binding as llvm

    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=cpu, features=features, opt=0 if quick else 2, reloc="pic", codemodel="jitdefault"
    )
    return machine.emit_object(llvm.parse_assembly(text, llvm.create_context()))


def main() -> None:
    about = json.loads(sys.stdin.buffer.readline())
    sys.path[:] = about.pop("path")
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    sys.stdout.buffer.write(object_code(sys.stdin.buffer.read().decode(), **about))


if __name__ == "__main__":
    main()
