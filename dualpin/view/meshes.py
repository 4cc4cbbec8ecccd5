"""Former home of `dualpin.io.meshes`."""

from __future__ import annotations

import warnings
from typing import Any

from ..io import meshes


def __getattr__(name: str) -> Any:
    found = getattr(meshes, name)
    warnings.warn(f"dualpin.view.meshes is called dualpin.io.meshes: {name} is there", DeprecationWarning, stacklevel=2)
    return found
