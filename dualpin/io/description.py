"""yourdfpy without trimesh, which it imports for meshes, and with it SciPy and networkx: most of a second.

A description needs only `trimesh.transformations`.  That file is loaded under a name of ours, and yourdfpy's own
`import trimesh` is given a package that holds it and finds the rest in the real one when somebody asks for a mesh.
No other import of the process sees either: what stands for trimesh is known to yourdfpy's module alone.
"""

from __future__ import annotations

import builtins
import contextlib
import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from ..locking import LOCK

_TRIMESH, _PART, _OURS = "trimesh", "transformations", f"{__package__}._trimesh"


class _Later(ModuleType):
    """Names of trimesh: of no meaning while `ready` is False, as annotations need no more; then the package's."""

    ready = False

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(importlib.import_module(_TRIMESH), name) if self.ready else Any


def yourdfpy() -> Any:
    """The package, imported when first asked for."""
    with LOCK:
        if "yourdfpy" not in sys.modules and _TRIMESH not in sys.modules:
            with contextlib.suppress(Exception):  # of another release than was tested: as it comes
                sys.modules.setdefault("yourdfpy.urdf", _urdf())
    package: Any = importlib.import_module("yourdfpy")
    package.urdf = sys.modules["yourdfpy.urdf"]
    return package


def _urdf() -> ModuleType:
    """Its module, which imports through a function of its own."""
    file = Path(_folder("yourdfpy")) / "urdf.py"
    spec = importlib.util.spec_from_file_location("yourdfpy.urdf", file)
    assert spec is not None and spec.loader is not None
    module, trimesh = importlib.util.module_from_spec(spec), _without_meshes()

    def load(name: str, *more: Any, **named: Any) -> Any:
        return trimesh if name.partition(".")[0] == _TRIMESH else builtins.__import__(name, *more, **named)

    vars(module)["__builtins__"] = {**vars(builtins), "__import__": load}
    spec.loader.exec_module(module)
    trimesh.ready = True
    return module


def _without_meshes() -> _Later:
    """What stands for trimesh: its file of transformations, and the files that this one needs, under a name of ours."""
    beside = ModuleType(_OURS)
    beside.__path__ = [_folder(_TRIMESH)]
    sys.modules[_OURS] = beside
    found = _Later(_TRIMESH)
    vars(found)[_PART] = importlib.import_module(f"{_OURS}.{_PART}")
    return found


def _folder(package: str) -> str:
    spec = importlib.util.find_spec(package)
    assert spec is not None and spec.submodule_search_locations
    return spec.submodule_search_locations[0]


__all__ = ["yourdfpy"]
