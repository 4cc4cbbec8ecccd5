"""LLVM at work.  Imported, or run as a process of its own that needs nothing but llvmlite and so begins at once:

    python worker.py     in: the arguments of `object_code` and sys.path, as JSON; then IR.  out: object code.
                         again, until the input ends

All are sent with their lengths: a pipe may have other ends in processes that know nothing of it.
"""

from __future__ import annotations

import json
import sys
from typing import IO

LENGTH = 8  # bytes that say how many follow


def object_code(text: str, triple: str, cpu: str, features: str, quick: bool) -> bytes:
    """IR to an object file; `quick` is a third of the time, for slower code."""
    import llvmlite.binding as llvm

    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=cpu, features=features, opt=0 if quick else 2, reloc="pic", codemodel="jitdefault"
    )
    return machine.emit_object(llvm.parse_assembly(text, llvm.create_context()))


def send(pipe: IO[bytes], data: bytes) -> None:
    pipe.write(len(data).to_bytes(LENGTH, "little") + data)
    pipe.flush()


def receive(pipe: IO[bytes]) -> bytes:
    """What was sent, or nothing if it did not come whole."""
    head = pipe.read(LENGTH)
    size = int.from_bytes(head, "little")
    data = pipe.read(size) if len(head) == LENGTH and size < 1 << 40 else b""
    return data if len(data) == size else b""


def main() -> None:
    while head := receive(sys.stdin.buffer):
        about = json.loads(head)
        text = receive(sys.stdin.buffer).decode()
        sys.path[:] = about.pop("path")
        import llvmlite.binding as llvm

        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        send(sys.stdout.buffer, object_code(text, **about))


if __name__ == "__main__":
    main()
