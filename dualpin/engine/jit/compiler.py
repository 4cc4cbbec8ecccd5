"""From LLVM's IR to machine code that can be called.

llvmlite lets LLVM work for one thread at a time, so large programs are compiled by several processes.
"""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import json
import os
import queue
import subprocess
import sys
import weakref
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
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


def _about(host: Host, quick: bool) -> bytes:
    """What a process that compiles is told before the text."""
    path = [p for p in sys.path if isinstance(p, str)]
    about = {"path": path, "triple": host.triple, "cpu": host.cpu, "features": host.features, "quick": quick}
    return json.dumps(about).encode()


def helpers() -> list[subprocess.Popen[bytes]]:
    """Processes that compile, as many as may help this one."""
    found: list[subprocess.Popen[bytes]] = []
    # in a program that Python is only a part of, `sys.executable` is something else
    python = Path(sys.executable or "").name.startswith("python")
    with contextlib.suppress(OSError):  # no more processes
        for _ in range(min(get_num_threads(), tuning.PROCESSES) - 1 if python else 0):
            found.append(
                subprocess.Popen(
                    [sys.executable, "-I", worker.__file__],
                    stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                )
            )  # fmt: skip
    return found


class Workbench:
    """Places where many programs are compiled, one at a time each: this process and others.  Set up at first use."""

    def __init__(self) -> None:
        self._places: queue.SimpleQueue[subprocess.Popen[bytes] | None] = queue.SimpleQueue()
        self._others: list[subprocess.Popen[bytes]] = []
        self._threads: ThreadPoolExecutor | None = None
        self._closed = False

    def submit(self, texts: Sequence[str], host: Host, quick: bool) -> Future[list[bytes]]:
        if self._threads is None:
            self._others = helpers()
            for place in (None, *self._others):
                self._places.put(place)
            self._threads = ThreadPoolExecutor(1 + len(self._others), thread_name_prefix="dualpin-llvm")
        return self._threads.submit(lambda: [self._object_code(text, host, quick) for text in texts])

    def _object_code(self, text: str, host: Host, quick: bool) -> bytes:
        place, code = self._places.get(), b""
        try:
            if place is not None:
                with contextlib.suppress(OSError):
                    pipe = cast(IO[bytes], place.stdin)
                    worker.send(pipe, _about(host, quick))
                    worker.send(pipe, text.encode())
                    code = worker.receive(cast(IO[bytes], place.stdout))
            if not code and self._closed:
                raise CompilerError("nobody waits for it any more")
            return code or object_code(text, host, quick)
        finally:
            self._places.put(place)

    def close(self) -> None:
        """What is not begun is given up; what this process compiles is finished first."""
        self._closed = True
        if self._threads is not None:
            self._threads.shutdown(wait=False, cancel_futures=True)
            for process in self._others:
                process.kill()
            self._threads.shutdown(wait=True)
            for process in self._others:
                with contextlib.suppress(OSError), process:  # which closes its pipes and waits for its end
                    pass


class Compilers:
    """This process and others that help it with a large program: begun early, ended in any case."""

    def __init__(self, host: Host, nodes: int) -> None:
        binding()
        self.host = host
        self.others = helpers() if nodes >= tuning.PROCESSES_FROM else []

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
        host, about = self.host, _about(self.host, quick)
        asked = list(zip(self.others, texts[1:], strict=False))
        for process, text in asked:
            with contextlib.suppress(OSError), cast(IO[bytes], process.stdin) as pipe:
                worker.send(pipe, about)
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
