"""Compilation by LLVM.  Imported, or run as a separate process that needs only llvmlite and so starts quickly:

    python worker.py     in: the arguments of `object_code` and sys.path, as JSON; then IR.  out: object code.
                         again, until the input ends

Messages are sent with their lengths, since other processes may hold ends of the pipe, so that it is never closed.
"""

from __future__ import annotations

import json
import sys
from typing import IO

LENGTH = 8  # bytes of a length


def object_code(text: str, triple: str, cpu: str, features: str, quick: bool) -> bytes:
    """IR to an object file; `quick` takes a third of the time and gives slower code."""
    import llvmlite.binding as llvm

    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=cpu, features=features, opt=0 if quick else 2, reloc="pic", codemodel="jitdefault"
    )
    return machine.emit_object(llvm.parse_assembly(text, llvm.create_context()))


def send(pipe: IO[bytes], data: bytes) -> None:
    pipe.write(len(data).to_bytes(LENGTH, "little") + data)
    pipe.flush()


def receive(pipe: IO[bytes]) -> bytes:
    """A message; empty if it is incomplete."""
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
