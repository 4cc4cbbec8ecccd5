"""From LLVM's IR to machine code that can be called.

llvmlite runs LLVM in one thread at a time, so large programs are compiled by several processes.
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

_numbers = itertools.count()  # makes the names of linked objects unique
_linkers: list[Any] = []  # the current one
_in_memory: weakref.WeakSet[Any] = weakref.WeakSet()  # linked code that is still in use


def object_code(text: str, host: Host, quick: bool = False) -> bytes:
    """IR to machine code, without optimisation passes, since constants were folded on the graph."""
    binding()
    try:
        return worker.object_code(text, host.triple, host.cpu, host.features, quick)
    except RuntimeError as e:
        raise CompilerError(f"LLVM: {e}") from e


def _about(host: Host, quick: bool) -> bytes:
    """The header that a compiling process receives before the text."""
    path = [p for p in sys.path if isinstance(p, str)]
    about = {"path": path, "triple": host.triple, "cpu": host.cpu, "features": host.features, "quick": quick}
    return json.dumps(about).encode()


def helpers() -> list[subprocess.Popen[bytes]]:
    """Processes that compile, as many as this process may use."""
    found: list[subprocess.Popen[bytes]] = []
    # if Python is embedded, `sys.executable` is another program
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
    """This process and others, each of which compiles one program at a time.  They are started at first use."""

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
        """Cancel all that has not begun; wait for the compilation of this process."""
        self._closed = True
        if self._threads is not None:
            self._threads.shutdown(wait=False, cancel_futures=True)
            for process in self._others:
                process.kill()
            self._threads.shutdown(wait=True)
            for process in self._others:
                with contextlib.suppress(OSError), process:  # closes its pipes and waits for its end
                    pass


class Compilers:
    """This process and helpers for a large program, which are started early and always ended."""

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
            with process:  # closes its pipes and waits for its end
                process.kill()

    def object_codes(self, texts: Sequence[str], quick: bool) -> list[bytes]:
        """Compile the first text here, and each other one in a process, or here if that fails."""
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
    """Object code in executable memory: addresses by name, valid as long as the result is kept."""
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
    """Never release linked code: that would call LLVM, which this forked process must not do."""
    for tracker in list(_in_memory):
        tracker.detach()


when_lost(_leave_in_memory)

stores = (ctypes.c_int64 * 2)(tuning.STREAM_FROM, 0)
"""Read by machine code: bytes from which stores are non-temporal, and whether `jit.stores` has measured it."""


def split(code: bytes, sizes: Sequence[int]) -> list[bytes]:
    """Contiguous objects of these sizes."""
    ends = list(itertools.accumulate(sizes))
    if not ends or ends[-1] != len(code):
        raise CompilerError(f"objects of {sizes} bytes expected, got {len(code)}")
    return [code[end - size : end] for size, end in zip(sizes, ends, strict=True)]


def linker(number: int) -> Any:
    """A linker for many kernels: an execution engine for each would take four times as long.

    Not one for all: a linker keeps the names of all it linked, and is deleted with its last kernel.
    """
    if number % tuning.KERNELS_PER_LINKER == 0 or not _linkers:
        llvm = binding()
        target = llvm.Target.from_default_triple().create_target_machine(codemodel="jitdefault", jit=True)
        _linkers[:] = [llvm.create_lljit_compiler(target)]
    return _linkers[0]


@Once
def kernel_imports() -> dict[str, int]:
    """Symbols that kernels import: the C library's sine and cosine, and the choice of stores."""
    library = ctypes.CDLL("msvcrt" if os.name == "nt" else None)
    if not hasattr(library, "sin"):
        library = ctypes.CDLL("libm.so.6" if sys.platform.startswith("linux") else "libm.dylib")
    found = {
        f"dualpin_{name}": ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0 for name in ("sin", "cos")
    }
    return found | {"dualpin_stores": ctypes.addressof(stores)}
