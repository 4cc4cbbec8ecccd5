"""C and C++ beside Python: compiled once, kept beside the environment, called by ctypes."""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np


def compiled(source: str, words: list[str], suffix: str) -> ctypes.CDLL:
    """The library made of a source, with ``-march=native``; a minute or more the first time."""
    compiler = shutil.which("g++" if suffix == ".cpp" else "gcc")
    if compiler is None:
        raise ModuleNotFoundError("no C++ compiler" if suffix == ".cpp" else "no C compiler")
    version = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout
    flags = ["-O3", "-march=native", "-fPIC", "-shared", "-w", *words]
    processor = Path("/proc/cpuinfo").read_text().split("flags", 1)[-1].split("\n", 1)[0] if os.name == "posix" else ""
    key = hashlib.sha256("\0".join([source, version, processor, *flags]).encode()).hexdigest()[:16]
    folder = Path(sys.prefix) / "built"
    folder.mkdir(exist_ok=True)
    library = folder / f"{key}.so"
    if not library.exists():
        file, half = folder / f"{key}{suffix}", folder / f"{key}.{os.getpid()}.so"
        file.write_text(source)
        subprocess.run([compiler, str(file), "-o", str(half), *flags], check=True, stdout=sys.stderr)
        half.replace(library)
    return ctypes.CDLL(str(library))


def pointer(x: np.ndarray | None) -> Any:
    return None if x is None else x.ctypes.data_as(ctypes.c_void_p)
