"""yourdfpy without trimesh, which it imports for meshes, and with it SciPy and networkx: most of a second.

A description needs only `trimesh.transformations`.  While yourdfpy is imported, a package with trimesh's path and
nothing in it stands for trimesh; a mesh requested from yourdfpy later uses the real one.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from types import ModuleType
from typing import Any

from ..locking import LOCK

_NAME, _NEEDED = "trimesh", "trimesh.transformations"


class _Later(ModuleType):
    """Names of a package: of no meaning while `ready` is False, as annotations need no more; then the package's."""

    ready = False

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(importlib.import_module(_NAME), name) if self.ready else Any


def yourdfpy() -> Any:
    """The package, imported when first asked for."""
    with LOCK:
        if "yourdfpy" not in sys.modules and _NAME not in sys.modules:
            spec = importlib.util.find_spec(_NAME)
            if spec is not None and spec.submodule_search_locations:
                _import_beside(list(spec.submodule_search_locations))
    return importlib.import_module("yourdfpy")


def _import_beside(path: list[str]) -> None:
    stand_in = _Later(_NAME)
    stand_in.__path__ = path
    sys.modules[_NAME] = stand_in
    try:
        importlib.import_module("yourdfpy")
    except Exception:  # of another release than was tested: imported as it is
        for name in [x for x in sys.modules if x.partition(".")[0] == "yourdfpy"]:
            del sys.modules[name]
    finally:
        for name in (_NAME, _NEEDED):
            sys.modules.pop(name, None)
        stand_in.ready = True


__all__ = ["yourdfpy"]
