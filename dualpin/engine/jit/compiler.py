"""From LLVM's IR to machine code that can be called.

llvmlite lets LLVM work for one thread at a time, so large programs are compiled by several processes.
"""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import json
import os
import subprocess
import sys
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, Any, cast

from ...locking import LOCK, Once, when_lost
from .. import tuning
from . import worker
from .host import CompilerError, Host, binding
from .threads import get_num_threads

_numbers = itertools.count()  # of what is linked: names must differ
_linkers: list[Any] = []  # the one in use
_in_memory: weakref.WeakSet[Any] = weakref.WeakSet()  # what was linked and is still used


def object_code(text: str, host: Host, quick: bool = False) -> bytes:
    """IR to machine code.  No optimisation passes: folding was done on the graph."""
    binding()
    try:
        return worker.object_code(text, host.triple, host.cpu, host.features, quick)
    except RuntimeError as e:
        raise CompilerError(f"LLVM: {e}") from e


class Compilers:
    """This process and others that help it with a large program: begun early, ended in any case."""

    def __init__(self, host: Host, nodes: int) -> None:
        binding()
        self.host = host
        self.others: list[subprocess.Popen[bytes]] = []
        if nodes < tuning.PROCESSES_FROM or not Path(sys.executable or "").name.startswith("python"):
            return  # too small, or a program that Python is only a part of
        for _ in range(min(get_num_threads(), tuning.PROCESSES) - 1):
            with contextlib.suppress(OSError):  # no more processes
                self.others.append(
                    subprocess.Popen(
                        [sys.executable, "-I", worker.__file__],
                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                    )
                )  # fmt: skip

    @property
    def count(self) -> int:
        return 1 + len(self.others)

    def __enter__(self) -> Compilers:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self.others:
            with process:  # which closes its pipes and waits for its end
                process.kill()

    def object_codes(self, texts: Sequence[str], quick: bool) -> list[bytes]:
        """The first is compiled here, each of the others by a process, and here where that fails."""
        host, path = self.host, [p for p in sys.path if isinstance(p, str)]
        about = {"path": path, "triple": host.triple, "cpu": host.cpu, "features": host.features, "quick": quick}
        asked = list(zip(self.others, texts[1:], strict=False))
        for process, text in asked:
            with contextlib.suppress(OSError), cast(IO[bytes], process.stdin) as pipe:
                worker.send(pipe, json.dumps(about).encode())
                worker.send(pipe, text.encode())
        objects = [object_code(texts[0], host, quick)]
        for process, text in asked:
            objects.append(worker.receive(cast(IO[bytes], process.stdout)) or object_code(text, host, quick))
        return objects


def loaded(
    objects: Sequence[bytes], exports: Sequence[str] = ("kernel",), imports: Mapping[str, int] | None = None
) -> Any:
    """Object code in executable memory: addresses by name, as long as it is kept."""
    library = binding().JITLibraryBuilder()
    for code in objects:
        library.add_object_img(code)
    for name in exports:
        library.export_symbol(name)
    for name, address in (kernel_imports() if imports is None else imports).items():
        library.import_symbol(name, address)
    with LOCK:
        number = next(_numbers)
        try:
            tracker = library.link(linker(number), f"dualpin{number}")
        except RuntimeError as e:
            raise CompilerError(f"LLVM: {e}") from e
        _in_memory.add(tracker)
    return tracker


def _leave_in_memory() -> None:
    """Nothing that is linked is given back any more: that would ask LLVM, which this process must not."""
    for tracker in list(_in_memory):
        tracker.detach()


when_lost(_leave_in_memory)

stores = (ctypes.c_int64 * 2)(tuning.STREAM_FROM, 0)
"""What machine code reads: bytes from which results go past the caches, and whether `jit.stores` measured that."""


def split(code: bytes, sizes: Sequence[int]) -> list[bytes]:
    """Objects of these sizes that follow each other."""
    ends = list(itertools.accumulate(sizes))
    if not ends or ends[-1] != len(code):
        raise CompilerError(f"objects of {sizes} bytes expected, got {len(code)}")
    return [code[end - size : end] for size, end in zip(sizes, ends, strict=True)]


def linker(number: int) -> Any:
    """One for many kernels: an execution engine for each would take four times as long.

    Not one for all: a linker remembers the names of what was linked, and ends with the last kernel it linked.
    """
    if number % tuning.KERNELS_PER_LINKER == 0 or not _linkers:
        llvm = binding()
        target = llvm.Target.from_default_triple().create_target_machine(codemodel="jitdefault", jit=True)
        _linkers[:] = [llvm.create_lljit_compiler(target)]
    return _linkers[0]


@Once
def kernel_imports() -> dict[str, int]:
    """What kernels need: the C library's sine and cosine, and how to store, under names of our own."""
    library = ctypes.CDLL("msvcrt" if os.name == "nt" else None)
    if not hasattr(library, "sin"):
        library = ctypes.CDLL("libm.so.6" if sys.platform.startswith("linux") else "libm.dylib")
    found = {
        f"dualpin_{name}": ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0 for name in ("sin", "cos")
    }
    return found | {"dualpin_stores": ctypes.addressof(stores)}
